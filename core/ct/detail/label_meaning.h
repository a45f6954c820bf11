#pragma once

#include <map>
#include <string>

#include "core/ct/detail/label_shapes.h"
#include "core/ct/label_volume.h"

namespace spinaltap::detail {

/// What a map's labels are, and how that is known.
struct LabelMeaning {
  std::map<int, LabelName> names;
  std::string source;  ///< in words; empty where no label is known to be a vertebra
};

/// Names in the file decide; else the convention that was said; else, of all known numberings, those that the labels'
/// order along the spine, their sizes and their distances do not exclude, where all that are left agree on every level
/// and the numbers are no mere count (1, 2, 3 from wherever the map begins). Throws Error otherwise, with what the
/// number would be in each numbering. `shapes` has the labels that there are, `names` what the file calls them.
LabelMeaning meaning_of(const std::map<int, LabelShape>& shapes, const std::map<long long, std::string>& names,
                        const LabelReadOptions& options, const std::string& file);

}  // namespace spinaltap::detail
