#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "core/ct/detail/label_shapes.h"
#include "core/ct/label_volume.h"

namespace spinaltap::detail {

/// The vertebra that a label's name means: "T11", "vertebrae_T11", "Th11", "L3 vertebra", "sacrum". Nothing for names
/// of parts and neighbours, such as "T11 disc" or "rib T11".
std::optional<Level> level_in_name(std::string_view name);

/// What the names mean, for the labels in `present`. Where both the sacrum and S1 are named, S1 is a part of it.
std::map<int, LabelName> levels_by_names(const std::map<int, LabelShape>& present,
                                         const std::map<long long, std::string>& names);

}  // namespace spinaltap::detail
