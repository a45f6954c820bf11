#include "core/plan/detail/suggestion_words.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/base/text_writer.h"

namespace spinaltap::detail {

std::string short_number(double value, int decimals) {
  std::string digits = fixed_text(value, decimals);
  if (digits.find('.') == std::string::npos) return digits;
  while (digits.back() == '0') digits.pop_back();
  if (digits.back() == '.') digits.pop_back();
  return digits;
}

const PedicleScrew* next_thicker(std::span<const PedicleScrew> screws, const PedicleScrew& screw) {
  const PedicleScrew* next = nullptr;
  const auto far_mm = [&](const PedicleScrew& one) { return std::abs(one.length_mm - screw.length_mm); };
  for (const PedicleScrew& other : screws) {
    if (other.diameter_mm <= screw.diameter_mm) continue;
    if (next == nullptr || other.diameter_mm < next->diameter_mm ||
        (other.diameter_mm == next->diameter_mm && far_mm(other) < far_mm(*next))) {
      next = &other;
    }
  }
  return next;
}

std::string thicker_on_way(const PedicleScrew& thicker, const PathGrade& grade, double margin_mm,
                           const std::string& objection) {
  const bool is_canal = grade.canal.clearance_mm < grade.outer.clearance_mm;
  const Approach& nearer = is_canal ? grade.canal : grade.outer;
  const std::string would = "a screw of " + short_number(thicker.diameter_mm) + " x " +
                            short_number(thicker.length_mm, 0) + " mm on this way would ";
  const std::string wall = is_canal ? "the canal" : "the outer surface";
  const std::string where =
      std::string(", ") + name_of(nearer.side) + " at " + short_number(nearer.depth_mm) + " mm of depth";
  if (nearer.clearance_mm < 0.0) {
    return would + "breach " + wall + " by " + short_number(-nearer.clearance_mm, 2) + " mm" + where;
  }
  if (nearer.clearance_mm < margin_mm) {
    return would + "leave " + short_number(nearer.clearance_mm, 2) + " mm of bone at " + wall + where + ", and " +
           short_number(margin_mm, 2) + " mm are looked for";
  }
  if (!objection.empty()) return would + objection;
  return would + "do too, and leave " + short_number(nearer.clearance_mm, 2) + " mm of bone around it";
}

std::string limits_in_words(const SearchLimits& limits, const Attempt& attempt) {
  const auto count = [&](ScrewLimit limit) { return limits.trajectories[static_cast<std::size_t>(limit)]; };
  const std::string screw = " one of " + short_number(limits.diameter_mm) + " mm";
  const std::string all = std::to_string(limits.tried);
  if (const std::size_t takes = count(ScrewLimit::none); takes > 0) {
    return std::to_string(takes) + " ways of " + all + " take" + screw + ", and none is worth as much";
  }
  std::vector<std::pair<std::size_t, std::string>> causes{
      {count(ScrewLimit::pedicle), "would keep less than " + short_number(attempt.margin_mm, 2) +
                                       " mm of bone around it in the pedicle or leave it too early"},
      {count(ScrewLimit::share),
       "would fill more than " + short_number(100.0 * attempt.widest_share, 0) + " % of the pedicle's width"},
      {count(ScrewLimit::bearing), "would stand out of bone between its entry opening and the pedicle"},
      {count(ScrewLimit::length), "have no room in the body for one that is long enough"},
      {count(ScrewLimit::entry), "would enter on the joint or where the surface is too steep"},
      {count(ScrewLimit::way_in), "have bone in a straight tool's way behind the entry"}};
  std::stable_sort(causes.begin(), causes.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::string words = "no way of " + all + " takes" + screw + ":";
  for (const auto& [ways, why] : causes) {
    if (ways > 0) words += (words.back() == ':' ? " " : ", ") + std::to_string(ways) + " " + why;
  }
  return words;
}

}  // namespace spinaltap::detail
