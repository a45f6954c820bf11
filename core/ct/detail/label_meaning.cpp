#include "core/ct/detail/label_meaning.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <vector>

#include "core/base/error.h"
#include "core/ct/detail/label_conventions.h"
#include "core/ct/detail/label_names.h"

namespace spinaltap::detail {
namespace {

using Shapes = std::map<int, LabelShape>;

/// Why labels cannot be meant in a numbering that has all their numbers; nothing where they can.
std::optional<std::string> why_not(const LabelNumbering& numbering, const Shapes& shapes) {
  std::map<int, std::pair<int, Level>> by_rank;  // number and level
  for (const auto& [number, shape] : shapes) {
    const Level level = numbering.level_of(number);
    if (level != Level::kNone) by_rank[level_rank(level)] = {number, level};
  }
  const auto shape_of = [&](const auto& entry) -> const LabelShape& { return shapes.at(entry.second.first); };
  for (auto upper = by_rank.begin(); upper != by_rank.end(); ++upper) {
    const auto lower = std::next(upper);
    if (lower == by_rank.end()) break;
    if (!(shape_of(*lower).middle_mm.z() < shape_of(*upper).middle_mm.z())) {
      return joined(upper->second.first, " does not lie above ", lower->second.first);
    }
  }
  for (const auto& entry : by_rank) {
    const auto& [number, level] = entry.second;
    if (const auto why = why_not(shape_of(entry), level, numbering.has_bodies_only)) {
      return joined(number, " is ", *why, " for ", level_name(level));
    }
  }
  for (auto upper = by_rank.begin(); upper != by_rank.end(); ++upper) {
    const auto lower = std::next(upper);
    if (lower == by_rank.end()) break;
    const Level level = upper->second.second;
    if (level_below(level) != lower->second.second) continue;
    if (const auto why = why_not_neighbours(shape_of(*upper), shape_of(*lower), level)) {
      return joined(upper->second.first, " is ", *why, " for ", level_name(level));
    }
  }
  return std::nullopt;
}

/// A numbering that has all the numbers, and one of them at least for a vertebra.
struct Reading {
  const LabelNumbering* numbering = nullptr;
  std::optional<std::string> excluded;  ///< why it cannot be meant
};

/// Where three numbers or more are vertebrae in one reading, another in which few of them are is not meant: a map of
/// six lumbar vertebrae is none of a sacrum among organs.
void exclude_those_of_few(std::vector<Reading>& readings, const Shapes& shapes) {
  constexpr std::ptrdiff_t kMany = 3;
  const auto count_of = [&](const Reading& one) {
    return std::count_if(shapes.begin(), shapes.end(),
                         [&](const auto& entry) { return one.numbering->level_of(entry.first) != Level::kNone; });
  };
  std::ptrdiff_t most = 0;
  for (const Reading& one : readings) {
    if (!one.excluded) most = std::max(most, count_of(one));
  }
  for (Reading& one : readings) {
    if (!one.excluded && most >= kMany && 2 * count_of(one) < most) {
      one.excluded = joined(count_of(one), " of the numbers would be vertebrae, ", most, " in another");
    }
  }
}

std::vector<Reading> readings_of(const Shapes& shapes) {
  std::vector<Reading> readings;
  for (const LabelNumbering& one : label_numberings()) {
    const auto knows = [&](const auto& entry) { return one.knows(entry.first); };
    const auto is_level = [&](const auto& entry) { return one.level_of(entry.first) != Level::kNone; };
    if (!std::all_of(shapes.begin(), shapes.end(), knows)) continue;
    if (!std::any_of(shapes.begin(), shapes.end(), is_level)) continue;
    readings.push_back({&one, why_not(one, shapes)});
  }
  exclude_those_of_few(readings, shapes);
  return readings;
}

/// Whether people may have counted what they saw: numbers in a row from 1 on, or from 2 or 3 where the first are not in
/// the map. A whole spine is no count that begins anywhere.
bool may_be_count(const Shapes& shapes) {
  constexpr int kMaxFirst = 3;
  constexpr std::size_t kWholeSpine = 20;
  const int first = shapes.begin()->first;
  const int last = shapes.rbegin()->first;
  return first <= kMaxFirst && last - first + 1 == static_cast<int>(shapes.size()) && shapes.size() < kWholeSpine;
}

/// Of the readings that are left, whether each gives each number the same level.
bool agree(const std::vector<Reading>& left, const Shapes& shapes) {
  return std::all_of(shapes.begin(), shapes.end(), [&](const auto& entry) {
    return std::all_of(left.begin(), left.end(), [&](const Reading& one) {
      return one.numbering->level_of(entry.first) == left.front().numbering->level_of(entry.first);
    });
  });
}

/// The number that a question is best asked of: the wanted one, or the middle one of those that readings disagree on.
int number_to_ask(const std::vector<Reading>& readings, const Shapes& shapes, int wanted) {
  const auto levels_of = [&](int number) {
    std::set<Level> levels;
    for (const Reading& one : readings) levels.insert(one.numbering->level_of(number));
    return levels;
  };
  if (shapes.contains(wanted) && levels_of(wanted) != std::set<Level>{Level::kNone}) return wanted;
  std::vector<int> unsure;
  for (const auto& entry : shapes) {
    if (levels_of(entry.first).size() > 1) unsure.push_back(entry.first);
  }
  if (!unsure.empty()) return unsure[unsure.size() / 2];
  return std::find_if(shapes.begin(), shapes.end(),
                      [&](const auto& entry) { return levels_of(entry.first) != std::set<Level>{Level::kNone}; })
      ->first;
}

/// "13 is T6 in VerSe (but 13 is 59.7 cm3, at most 42, for T6), C3 in TotalSpineSeg".
std::string list_of(const std::vector<Reading>& readings, int number) {
  std::string text = std::to_string(number) + " is ";
  const char* between = "";
  for (const Reading& one : readings) {
    const Level level = one.numbering->level_of(number);
    text += joined(between, level == Level::kNone ? "no vertebra" : level_name(level), " in ", one.numbering->name);
    if (one.excluded) text += " (but " + *one.excluded + ")";
    between = ", ";
  }
  return text;
}

LabelMeaning by_numbers(const LabelNumbering& numbering, const Shapes& shapes,
                        const std::map<long long, std::string>& names, std::string source) {
  LabelMeaning meaning{{}, std::move(source)};
  for (const auto& entry : shapes) {
    const Level level = numbering.level_of(entry.first);
    const auto named = names.find(entry.first);
    const std::string own_name = named == names.end() ? "" : named->second;
    meaning.names[entry.first] = {level == Level::kNone ? own_name : level_name(level), level};
  }
  return meaning;
}

LabelMeaning by_what_is_left(const Shapes& shapes, const std::map<long long, std::string>& names,
                             const LabelReadOptions& options, const std::string& file) {
  LabelMeaning nothing{levels_by_names(shapes, names), {}};
  if (options.wanted != 0 && shapes.size() == 1) return nothing;
  const std::vector<Reading> readings = readings_of(shapes);
  if (readings.empty()) return nothing;
  std::vector<Reading> left;
  std::copy_if(readings.begin(), readings.end(), std::back_inserter(left),
               [](const Reading& one) { return !one.excluded; });
  const bool is_count = may_be_count(shapes);
  if (!left.empty() && !is_count && agree(left, shapes)) {
    std::string which;
    for (const Reading& one : left) which += joined(which.empty() ? "" : " or ", one.numbering->name);
    return by_numbers(*left.front().numbering, shapes, names,
                      "numbers as of " + which + ", which alone fit by order and size");
  }
  fail("expected a label map that names its vertebrae, found numbers that may mean several things: ",
       list_of(readings, number_to_ask(readings, shapes, options.wanted)),
       is_count       ? ", or they are just counted"
       : left.empty() ? ", and none of these fits"
                      : "",
       "; say which convention is meant, or none, which leaves the level open: ", file);
}

bool has_level(const std::map<int, LabelName>& names) {
  return std::any_of(names.begin(), names.end(), [](const auto& entry) { return entry.second.level != Level::kNone; });
}

}  // namespace

LabelMeaning meaning_of(const Shapes& shapes, const std::map<long long, std::string>& names,
                        const LabelReadOptions& options, const std::string& file) {
  const char* const kByNames = "names in the label map";
  switch (options.convention) {
    case LabelConvention::none:
      return {levels_by_names(shapes, {}), {}};
    case LabelConvention::any_names:
    case LabelConvention::names: {
      LabelMeaning meaning{levels_by_names(shapes, names), kByNames};
      if (has_level(meaning.names)) return meaning;
      if (options.convention == LabelConvention::any_names) return {meaning.names, {}};
      fail("expected a label map that names vertebrae, found no such name in ", file);
    }
    case LabelConvention::automatic: {
      LabelMeaning meaning{levels_by_names(shapes, names), kByNames};
      if (shapes.empty() || has_level(meaning.names)) return meaning;
      return by_what_is_left(shapes, names, options, file);
    }
    default: {
      const LabelNumbering& numbering = *numbering_of(options.convention);
      return by_numbers(numbering, shapes, names, joined("numbers as of ", numbering.name, ", as was said"));
    }
  }
}

}  // namespace spinaltap::detail
