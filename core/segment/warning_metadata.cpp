#include "core/segment/warning_metadata.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <sstream>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/base/text_writer.h"
#include "core/segment/level_names.h"

namespace spinaltap {
namespace {

constexpr const char* kInputWarnings = "input_warnings";
constexpr const char* kUnsure = "unsure_mm";

/// Few enough places for a bone's metadata.
std::string cells_text(std::span<const Vec3> places_mm) {
  constexpr double kCellMm = 2.0;
  std::set<std::array<long, 3>> taken;
  TextWriter text;
  for (const Vec3& p_mm : places_mm) {
    const Vec3 cell = (p_mm / kCellMm).array().floor();
    if (!taken.insert({std::lround(cell.x()), std::lround(cell.y()), std::lround(cell.z())}).second) continue;
    text << (taken.size() == 1 ? "" : " ") << fixed_text(p_mm.x(), 1) << ' ' << fixed_text(p_mm.y(), 1) << ' '
         << fixed_text(p_mm.z(), 1);
  }
  return text.str();
}

std::string joined_lines(std::span<const std::string> lines) {
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : "\n") + line;
  return text;
}

std::vector<std::string> lines_in(const std::map<std::string, std::string>& metadata, const char* key) {
  std::vector<std::string> lines;
  const auto found = metadata.find(key);
  if (found == metadata.end()) return lines;
  std::istringstream text(found->second);
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

}  // namespace

LevelWarnings warnings_of(const LevelReport& report) {
  LevelWarnings warnings;
  warnings.severity = report.severity;
  warnings.unsure_mm = report.figures.unsure_mm;
  for (const LevelWarning& warning : report.warnings) warnings.warnings.push_back(warning.text);
  if (report.name_source == NameSource::hint) {
    warnings.warnings.push_back("its name is a hint from the sacrum, the ribs and the bodies' sizes: check it (" +
                                in_words(report.name_probabilities) + ")");
  }
  return warnings;
}

void add_warnings(const LevelWarnings& warnings, std::map<std::string, std::string>& metadata) {
  metadata["severity"] = short_text(warnings.severity);
  if (!warnings.warnings.empty()) metadata["warnings"] = joined_lines(warnings.warnings);
  if (!warnings.unsure_mm.empty()) metadata[kUnsure] = cells_text(warnings.unsure_mm);
}

std::optional<LevelWarnings> warnings_in(const std::map<std::string, std::string>& metadata) {
  const auto severity = metadata.find("severity");
  if (severity == metadata.end()) return std::nullopt;
  LevelWarnings warnings;
  const std::optional<double> number = parse_number(severity->second);
  if (!number) fail("expected a number as the metadata \"severity\", found ", in_quotes(severity->second));
  warnings.severity = *number;
  warnings.warnings = lines_in(metadata, "warnings");
  if (const auto unsure = metadata.find(kUnsure); unsure != metadata.end()) {
    const std::optional<std::vector<double>> numbers = parse_numbers(unsure->second);
    if (!numbers || numbers->size() % 3 != 0) {
      fail("expected places as the metadata ", in_quotes(kUnsure), ", found ", in_quotes(unsure->second));
    }
    for (std::size_t n = 0; n < numbers->size(); n += 3) {
      warnings.unsure_mm.emplace_back((*numbers)[n], (*numbers)[n + 1], (*numbers)[n + 2]);
    }
  }
  return warnings;
}

void add_input_warnings(std::span<const std::string> lines, std::map<std::string, std::string>& metadata) {
  std::vector<std::string> all = lines_in(metadata, kInputWarnings);
  for (const std::string& line : lines) {
    if (line.find('\n') != std::string::npos) fail("expected input warnings of one line, found ", in_quotes(line));
    if (std::find(all.begin(), all.end(), line) == all.end()) all.push_back(line);
  }
  if (!all.empty()) metadata[kInputWarnings] = joined_lines(all);
}

std::vector<std::string> input_warnings_in(const std::map<std::string, std::string>& metadata) {
  return lines_in(metadata, kInputWarnings);
}

void add_hu_change(const HuChange& change, std::map<std::string, std::string>& metadata) {
  if (change.is_none()) return;
  metadata["hu_scale"] = short_text(change.scale);
  metadata["hu_offset"] = short_text(change.offset);
}

std::string hu_change_in(const std::map<std::string, std::string>& metadata) {
  const auto scale = metadata.find("hu_scale"), offset = metadata.find("hu_offset");
  if (scale == metadata.end() || offset == metadata.end()) return {};
  const bool is_minus = offset->second.starts_with('-');
  return "x " + scale->second + (is_minus ? " - " + offset->second.substr(1) : " + " + offset->second) + ", as told";
}

}  // namespace spinaltap
