#pragma once

#include <map>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/ct/level.h"

namespace spinaltap {

/// What a name stands for. Throws Error that lists the names.
template <class Value>
Value named(const std::map<std::string, Value>& values, const std::string& name, std::string_view what) {
  if (const auto found = values.find(name); found != values.end()) return found->second;
  std::string names;
  for (const auto& [known, value] : values) names += (names.empty() ? "" : ", ") + known;
  fail("expected ", what, " of: ", names, "; found \"", name, "\"");
}

/// "L3" and the like; empty: none.
inline Level level_named(const std::string& name) {
  if (name.empty()) return Level::kNone;
  if (const auto level = level_from_name(name)) return *level;
  fail("expected a vertebra such as \"L3\" or \"T11\", found \"", name, "\"");
}

}  // namespace spinaltap
