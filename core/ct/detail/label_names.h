#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "core/ct/label_volume.h"

namespace spinaltap::detail {

/// The vertebra that a label's name means: "T11", "vertebrae_T11", "Th11", "L3 vertebra", "sacrum". Nothing for names
/// of parts and neighbours, such as "T11 disc" or "rib T11".
std::optional<Level> level_in_name(std::string_view name);

/// The vertebra that a number stands for in a convention of numbers; kNone for what is no whole vertebra.
Level level_of_number(LabelConvention convention, long long number);

/// What the names mean, for the labels in `present`. Where both the sacrum and S1 are named, S1 is a part of it.
std::map<int, LabelName> levels_by_names(const std::set<int>& present, const std::map<long long, std::string>& names);

/// What the numbers mean in a convention; `names` are kept for those that are no vertebrae.
std::map<int, LabelName> levels_by_numbers(LabelConvention convention, const std::set<int>& present,
                                           const std::map<long long, std::string>& names);

/// The conventions of numbers that a map can be in. `height_mm`: where along the patient each label's middle lies, z of
/// LPS. VerSe counts from the head down, TotalSegmentator from the sacrum up, so that two vertebrae tell them apart;
/// where three lie in a convention's order, another that knows one of the numbers only is not meant.
std::vector<LabelConvention> possible_conventions(const std::map<int, double>& height_mm);

/// The one convention that numbers without names can be in, if that is sure: VerSe's with two vertebrae or more in
/// order, unless they could be counted through from 1; TotalSegmentator 2's where a number is beyond version 1's.
std::optional<LabelConvention> sure_convention(const std::map<int, double>& height_mm);

/// "VerSe", "TotalSegmentator 2", "TotalSegmentator 1".
std::string convention_name(LabelConvention convention);

}  // namespace spinaltap::detail
