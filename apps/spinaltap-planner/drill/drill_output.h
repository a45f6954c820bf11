#pragma once

#include <filesystem>

#include "apps/spinaltap-planner/drill/played_hole.h"
#include "core/base/progress.h"

namespace spinaltap {

/// Both run the drilling's cycles again, which takes some seconds. From any thread.

/// Writes a record as `spinaltap drill --record` does, which `replay` and `export` read; replaces a file that is there.
/// Throws Error as RecordWriter does.
void write_record(const DoneDrilling& drilling, const std::filesystem::path& path, const Progress& progress = {});

/// Writes report.html, drilled.vdb, drilled.stl, log.csv and events.csv into a folder, as `spinaltap drill` does.
/// Earlier holes are in the drilled bone, too. Throws Error where the folder cannot be written.
void write_report(const DoneDrilling& drilling, const std::filesystem::path& folder, const Progress& progress = {});

}  // namespace spinaltap
