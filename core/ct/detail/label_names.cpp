// Numbers: VerSe's of the data's description (Sekuboyina 2021) and of SPINEPS, which puts 100 and 200 on a vertebra's
// for its disc and endplate; TotalSegmentator's of its tables of classes.

#include "core/ct/detail/label_names.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "core/base/error.h"
#include "core/base/text_fields.h"

namespace spinaltap::detail {
namespace {

/// Words beside a level's that leave it the whole vertebra.
constexpr std::array<std::string_view, 9> kPlainWords{"vertebra", "vertebrae", "vert",     "spine",       "bone",
                                                      "level",    "segment",   "vertebre", "segmentation"};

std::vector<std::string> words_of_name(std::string_view text) {
  std::vector<std::string> words;
  bool in_word = false;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_part = std::isalnum(byte) != 0 || byte >= 0x80;
    if (is_part && !in_word) words.emplace_back();
    if (is_part) words.back() += lower_case({&c, 1});
    in_word = is_part;
  }
  return words;
}

/// Levels that numbers stand for in a row, upwards from L5.
Level level_up_from_l5(long long steps) {
  if (steps < 0 || steps >= static_cast<int>(Level::kL5)) return Level::kNone;
  return static_cast<Level>(static_cast<int>(Level::kL5) - static_cast<int>(steps));
}

constexpr long long kSpinepsDiscs = 100;
constexpr long long kSpinepsEndplates = 200;
constexpr int kCoccyx = 27;

bool is_of_verse(int number) {
  for (const long long part : {0LL, kSpinepsDiscs, kSpinepsEndplates}) {
    const long long vertebra = number - part;
    if (vertebra == kCoccyx || level_from_number(vertebra)) return true;
  }
  return false;
}

constexpr int kClassesOfTotal = 117;
constexpr int kClassesOfTotalV1 = 104;

bool is_of(LabelConvention convention, int number) {
  if (convention == LabelConvention::verse) return is_of_verse(number);
  return number <= (convention == LabelConvention::totalsegmentator ? kClassesOfTotal : kClassesOfTotalV1);
}

}  // namespace

std::optional<Level> level_in_name(std::string_view name) {
  std::optional<Level> found;
  for (const std::string& word : words_of_name(name)) {
    if (std::find(kPlainWords.begin(), kPlainWords.end(), word) != kPlainWords.end()) continue;
    const std::optional<Level> level = level_from_name(word);
    if (!level || found) return std::nullopt;
    found = level;
  }
  return found;
}

Level level_of_number(LabelConvention convention, long long number) {
  constexpr long long kL5OfTotal = 27;
  constexpr long long kSacrumOfTotal = 25;
  constexpr long long kL5OfTotalV1 = 18;
  switch (convention) {
    case LabelConvention::verse:
      return level_from_number(number).value_or(Level::kNone);
    case LabelConvention::totalsegmentator:
      // 26 is S1, which TotalSegmentator marks apart from the rest of the sacrum.
      return number == kSacrumOfTotal ? Level::kSacrum : level_up_from_l5(number - kL5OfTotal);
    case LabelConvention::totalsegmentator_v1:
      return level_up_from_l5(number - kL5OfTotalV1);
    default:
      return Level::kNone;
  }
}

std::map<int, LabelName> levels_by_names(const std::set<int>& present, const std::map<long long, std::string>& names) {
  std::map<int, LabelName> levels;
  std::optional<int> sacrum;
  std::optional<int> first_sacral;
  for (const int number : present) {
    const auto named = names.find(number);
    const std::string name = named == names.end() ? "" : named->second;
    const std::optional<Level> level = level_in_name(name);
    if (level) {
      levels[number] = {level_name(*level), *level};
    } else {
      levels[number] = {name, Level::kNone};
    }
    if (level != Level::kSacrum) continue;
    const std::vector<std::string> words = words_of_name(name);
    const bool is_s1 = std::find(words.begin(), words.end(), "s1") != words.end();
    (is_s1 ? first_sacral : sacrum) = number;
  }
  if (sacrum && first_sacral) levels[*first_sacral] = {"S1", Level::kNone};
  return levels;
}

std::map<int, LabelName> levels_by_numbers(LabelConvention convention, const std::set<int>& present,
                                           const std::map<long long, std::string>& names) {
  std::map<int, LabelName> levels;
  for (const int number : present) {
    const Level level = level_of_number(convention, number);
    const auto named = names.find(number);
    const std::string own_name = named == names.end() ? "" : named->second;
    levels[number] = {level == Level::kNone ? own_name : level_name(level), level};
  }
  return levels;
}

std::vector<LabelConvention> possible_conventions(const std::map<int, double>& height_mm) {
  constexpr std::size_t kMany = 3;  // vertebrae in order by chance: one map of six
  std::map<LabelConvention, std::size_t> vertebrae;
  std::size_t max = 0;
  for (const LabelConvention convention :
       {LabelConvention::verse, LabelConvention::totalsegmentator, LabelConvention::totalsegmentator_v1}) {
    std::map<int, double> by_rank;
    bool fits = true;
    for (const auto& [number, z_mm] : height_mm) {
      fits = fits && is_of(convention, number);
      const Level level = level_of_number(convention, number);
      if (level != Level::kNone) by_rank[level_rank(level)] = z_mm;
    }
    const auto out_of_order =
        std::adjacent_find(by_rank.begin(), by_rank.end(),
                           [](const auto& upper, const auto& lower) { return !(lower.second < upper.second); });
    if (!fits || by_rank.empty() || out_of_order != by_rank.end()) continue;
    vertebrae[convention] = by_rank.size();
    max = std::max(max, by_rank.size());
  }
  std::vector<LabelConvention> possible;
  for (const auto& [convention, count] : vertebrae) {
    if (count > 1 || max < kMany) possible.push_back(convention);
  }
  return possible;
}

std::optional<LabelConvention> sure_convention(const std::map<int, double>& height_mm) {
  const std::vector<LabelConvention> possible = possible_conventions(height_mm);
  if (possible.size() != 1) return std::nullopt;
  const LabelConvention convention = possible.front();
  int vertebrae = 0;
  for (const auto& entry : height_mm) {
    if (level_of_number(convention, entry.first) != Level::kNone) ++vertebrae;
  }
  const int last = height_mm.rbegin()->first;
  if (convention == LabelConvention::totalsegmentator && vertebrae > 1 && last > kClassesOfTotalV1) return convention;
  // Numbers counted through from 1 may be a person's; those of a whole spine from C1 to L5 are not.
  const bool is_count = last == static_cast<int>(height_mm.size());
  const bool is_whole = vertebrae >= static_cast<int>(Level::kL5);
  if (convention == LabelConvention::verse && vertebrae > 1 && (!is_count || is_whole)) return convention;
  return std::nullopt;
}

std::string convention_name(LabelConvention convention) {
  switch (convention) {
    case LabelConvention::automatic:
      return "automatic";
    case LabelConvention::names:
    case LabelConvention::any_names:
      return "names";
    case LabelConvention::verse:
      return "VerSe";
    case LabelConvention::totalsegmentator:
      return "TotalSegmentator 2";
    case LabelConvention::totalsegmentator_v1:
      return "TotalSegmentator 1";
  }
  return {};
}

}  // namespace spinaltap::detail
