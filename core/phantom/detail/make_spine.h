#pragma once

#include <functional>
#include <vector>

#include "core/phantom/spine.h"

namespace spinaltap {

/// The bodies of a spine: vertebrae, the uppermost first, the sacrum, ribs. Each vertebra's inferior articular
/// processes end behind the facets of the one below, which cuts them back to the gap asked for.
std::vector<SpinePart> make_parts(const SpineOptions& options, const std::vector<PlacedLevel>& placed);

/// Rejects a vertebra of whose pedicles' isthmuses, exact in itself, `value_mm` takes something away.
void check_isthmuses(const Vertebra& vertebra, const std::function<double(const Vec3&)>& value_mm);

}  // namespace spinaltap
