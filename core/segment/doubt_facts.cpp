#include "core/segment/doubt_facts.h"

#include <sstream>

#include "core/base/error.h"

namespace spinaltap {

LevelDoubts doubts_of(const LevelReport& report) {
  LevelDoubts doubts;
  doubts.doubt = report.doubt;
  for (const LevelWarning& warning : report.warnings) doubts.warnings.push_back(warning.text);
  if (report.name_source == NameSource::hint) {
    doubts.warnings.push_back("its name is a hint from the sacrum or the last ribs: check it");
  }
  return doubts;
}

void add_doubts(const LevelDoubts& doubts, std::map<std::string, std::string>& facts) {
  std::ostringstream number;
  number << doubts.doubt;
  facts["doubt"] = number.str();
  std::string lines;
  for (const std::string& warning : doubts.warnings) lines += (lines.empty() ? "" : "\n") + warning;
  if (!lines.empty()) facts["warnings"] = lines;
}

std::optional<LevelDoubts> doubts_in(const std::map<std::string, std::string>& facts) {
  const auto doubt = facts.find("doubt");
  if (doubt == facts.end()) return std::nullopt;
  LevelDoubts doubts;
  std::istringstream number(doubt->second);
  if (!(number >> doubts.doubt)) fail("expected a number as the fact \"doubt\", found \"", doubt->second, "\"");
  if (const auto warnings = facts.find("warnings"); warnings != facts.end()) {
    std::istringstream lines(warnings->second);
    for (std::string line; std::getline(lines, line);) doubts.warnings.push_back(line);
  }
  return doubts;
}

}  // namespace spinaltap
