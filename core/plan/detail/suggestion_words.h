#pragma once

#include <span>
#include <string>

#include "core/grading/grade.h"
#include "core/plan/detail/trajectory_search.h"

namespace spinaltap::detail {

/// `decimals` digits after the point at most, without zeros at the end: "0.5", "4".
std::string short_number(double value, int decimals = 1);

/// Of the screws that are thicker the thinnest, and of these the one of the length that is nearest; null without one.
const PedicleScrew* next_thicker(std::span<const PedicleScrew> screws, const PedicleScrew& screw);

/// What a thicker screw would do on the same way: breach a wall or leave less bone than `margin_mm` there, with depth
/// and side, or what else speaks against it, `objection`: "stand in the joint"; empty: nothing does.
std::string thicker_on_way(const PedicleScrew& thicker, const PathGrade& grade, double margin_mm,
                           const std::string& objection);

/// Why no trajectory takes a screw of a diameter, or how many do: "no way of 3,214 takes one of 4 mm: ...".
std::string limits_in_words(const SearchLimits& limits, const Attempt& attempt);

}  // namespace spinaltap::detail
