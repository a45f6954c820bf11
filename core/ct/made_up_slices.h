#pragma once

#include <map>
#include <optional>
#include <string>

#include "core/ct/ct_volume.h"

namespace spinaltap {

/// As the metadata "made_up_slices_mm" (the normal, then each slab's ends) of a CT or of a bone, and back. Nothing is
/// added where there are none; nothing is read where there is no such metadata, or it is no such numbers.
void add_made_up(const MadeUpSlices& slices, std::map<std::string, std::string>& metadata);
std::optional<MadeUpSlices> made_up_in(const std::map<std::string, std::string>& metadata);

}  // namespace spinaltap
