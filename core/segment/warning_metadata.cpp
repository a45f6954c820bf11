#include "core/segment/warning_metadata.h"

#include <sstream>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/base/text_writer.h"

namespace spinaltap {

LevelWarnings warnings_of(const LevelReport& report) {
  LevelWarnings warnings;
  warnings.severity = report.severity;
  for (const LevelWarning& warning : report.warnings) warnings.warnings.push_back(warning.text);
  if (report.name_source == NameSource::hint) {
    warnings.warnings.push_back("its name is a hint from the sacrum or the last ribs: check it");
  }
  return warnings;
}

void add_warnings(const LevelWarnings& warnings, std::map<std::string, std::string>& metadata) {
  metadata["severity"] = short_text(warnings.severity);
  std::string lines;
  for (const std::string& warning : warnings.warnings) lines += (lines.empty() ? "" : "\n") + warning;
  if (!lines.empty()) metadata["warnings"] = lines;
}

std::optional<LevelWarnings> warnings_in(const std::map<std::string, std::string>& metadata) {
  const auto severity = metadata.find("severity");
  if (severity == metadata.end()) return std::nullopt;
  LevelWarnings warnings;
  const std::optional<double> number = parse_number(severity->second);
  if (!number) fail("expected a number as the metadata \"severity\", found ", in_quotes(severity->second));
  warnings.severity = *number;
  if (const auto found = metadata.find("warnings"); found != metadata.end()) {
    std::istringstream lines(found->second);
    for (std::string line; std::getline(lines, line);) warnings.warnings.push_back(line);
  }
  return warnings;
}

}  // namespace spinaltap
