#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "apps/report/drilling_report.h"
#include "apps/spinaltap/drill_options.h"
#include "core/base/progress.h"
#include "core/base/stage_clock.h"
#include "core/base/staged_output.h"
#include "core/ct/ct_volume.h"
#include "core/files/json_file.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

/// For people, on standard output. `density`: the density calibration of the session's material.
void print_drilling(const DrillFigures& figures, const DensityCalibration& density);
Json drilling_json(const DrillFigures& figures, const DensityCalibration& density);

/// What a drilling's report says of itself, and shows.
struct DrillPage {
  std::string title;
  std::string command;                  ///< as the report shows it
  const CtVolume* ct = nullptr;         ///< for the slices; none without it
  std::vector<std::string> notes = {};  ///< on the plan and the bone
};

/// Drills, and writes report.html, drilled.vdb, drilled.stl, log.csv, events.csv and, where asked, the occupied points
/// as points.vdb or voxels as voxels.nii.gz into a folder, with what `output` holds already: all of them or none. Of
/// several bones all but the first have drilled_NAME.vdb and .stl: names_of_further(). A record grows where its option
/// says, and stays whatever happens. Prints the figures and gives them as JSON. `clock` gets the stages' times.
Json run_drill(const DrillPage& page, std::span<const Bone> bones, const DrillPath& path, const DrillOptions& options,
               const std::filesystem::path& folder, StagedOutput& output, StageClock& clock, const Progress& progress);

}  // namespace spinaltap
