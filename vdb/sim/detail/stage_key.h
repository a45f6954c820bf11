#pragma once

#include <string>
#include <string_view>

#include "core/ct/ct_volume.h"
#include "core/rbf/fit_surface.h"
#include "core/segment/segment_spine.h"
#include "core/surface/surface_points.h"

namespace spinaltap::detail {

/// Names of results that are kept: hashes of all that they follow from. `code`: of the stage, code_fingerprint().
std::string mask_key(std::string_view code, const std::string& ct_hash, const SegmentOptions& options);
std::string fit_key(std::string_view code, const std::string& ct_hash, const BoneMask& mask,
                    const SurfaceOptions& surface, const SurfaceFitOptions& options);

}  // namespace spinaltap::detail
