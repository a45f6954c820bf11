#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/segment/segment_spine.h"

namespace spinaltap {

/// What whoever marked a bone thinks of it.
struct LevelDoubts {
  std::vector<std::string> warnings;  ///< one line each
  double doubt = 0.0;                 ///< 0: none, to 1: likely wrong

  bool is_doubtful() const { return doubt >= kDoubtful; }
  bool operator==(const LevelDoubts&) const = default;
};

/// The warnings of a vertebra that was found, in words, and one where its name is but a hint.
LevelDoubts doubts_of(const LevelReport& report);

/// As the facts "doubt" and "warnings" (a line each) of a bone, and back; nothing where there are no such facts.
void add_doubts(const LevelDoubts& doubts, std::map<std::string, std::string>& facts);
std::optional<LevelDoubts> doubts_in(const std::map<std::string, std::string>& facts);

}  // namespace spinaltap
