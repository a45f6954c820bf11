#pragma once

#include <filesystem>

#include "core/session/operator/milling.h"

namespace spinaltap {

/// Writes a milling as JSON: patient LPS, mm; see docs/milling.md.
void write_milling(const Milling& milling, const std::filesystem::path& path);

/// Reads what write_milling wrote. Throws Error that names the file and the key at fault.
Milling read_milling(const std::filesystem::path& path);

}  // namespace spinaltap
