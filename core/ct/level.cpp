#include "core/ct/level.h"

#include <algorithm>
#include <array>

#include "core/base/text_fields.h"

namespace spinaltap {
namespace {

/// A row of levels with one letter and numbers in a row.
struct Region {
  std::string_view letter;
  int first, last;  ///< VerSe's numbers
};
constexpr std::array<Region, 3> kRegions{{{"C", 1, 7}, {"T", 8, 19}, {"L", 20, 25}}};

std::optional<int> number_in(std::string_view digits) {
  if (digits.empty() || digits.size() > 2 || digits.front() == '0') return std::nullopt;
  int number = 0;
  for (const char c : digits) {
    if (c < '0' || c > '9') return std::nullopt;
    number = 10 * number + (c - '0');
  }
  return number;
}

}  // namespace

std::string level_name(Level level) {
  if (level == Level::kSacrum) return "sacrum";
  if (level == Level::kT13) return "T13";
  const int number = static_cast<int>(level);
  for (const Region& region : kRegions) {
    if (number >= region.first && number <= region.last) {
      return std::string(region.letter) + std::to_string(number - region.first + 1);
    }
  }
  return {};
}

std::optional<Level> level_from_name(std::string_view name) {
  std::string upper = upper_case(name);
  if (upper == "SACRUM" || upper == "S" || upper == "S1") return Level::kSacrum;
  if (upper.starts_with("TH")) upper.erase(1, 1);
  if (upper == "T13") return Level::kT13;
  for (const Region& region : kRegions) {
    if (!upper.starts_with(region.letter)) continue;
    const std::optional<int> number = number_in(std::string_view(upper).substr(1));
    if (number && *number <= region.last - region.first + 1) return static_cast<Level>(region.first + *number - 1);
  }
  return std::nullopt;
}

std::optional<Level> level_from_number(long long number) {
  if (number < 1 || number > static_cast<int>(Level::kT13)) return std::nullopt;
  const auto level = static_cast<Level>(number);
  if (level_name(level).empty()) return std::nullopt;
  return level;
}

Level level_below(Level level) {
  switch (level) {
    case Level::kNone:
    case Level::kSacrum:
      return Level::kNone;
    case Level::kL5:
    case Level::kL6:
      return Level::kSacrum;
    case Level::kT13:
      return Level::kL1;
    default:
      return static_cast<Level>(static_cast<int>(level) + 1);
  }
}

Level level_above(Level level) {
  switch (level) {
    case Level::kNone:
    case Level::kC1:
      return Level::kNone;
    case Level::kSacrum:
    case Level::kL6:
      return Level::kL5;
    case Level::kT13:
      return Level::kT12;
    default:
      return static_cast<Level>(static_cast<int>(level) - 1);
  }
}

int level_rank(Level level) {
  constexpr int kStep = 2;  // leaves room for T13
  if (level == Level::kT13) return kStep * static_cast<int>(Level::kT12) + 1;
  return kStep * static_cast<int>(level);
}

}  // namespace spinaltap
