#pragma once

#include <filesystem>
#include <string>

#include "core/session/operator/milling.h"

namespace spinaltap {

/// Writes a milling as JSON: patient LPS, mm; see docs/milling.md.
void write_milling(const Milling& milling, const std::filesystem::path& path);

/// Reads what write_milling wrote. Throws Error that names the file and the key at fault.
Milling read_milling(const std::filesystem::path& path);

/// The same in a text; `file`: where it comes from, for messages.
std::string milling_text(const Milling& milling);
Milling milling_of_text(const std::string& text, const std::filesystem::path& file);

}  // namespace spinaltap
