#pragma once

#include <cstdint>
#include <string>

#include "core/phantom/scanner.h"
#include "core/phantom/spine_options.h"
#include "core/phantom/trunk_tissue.h"

namespace spinaltap {

/// A patient and how he is scanned.
struct TrunkOptions {
  SpineOptions spine{};
  TrunkTissueOptions tissue{};
  ScanOptions scan{};  ///< with the field of view
};

/// A random patient and scanner: part of C3 to L5 and perhaps the sacrum in view, a neck in a quarter of them, crushed
/// bodies in a quarter, metal or cement in a sixth, another number of levels in a tenth, slices of 0.5 to 5 mm (most 1
/// to 3), soft to sharp kernels, low to high dose. The same seed gives the same options; a Spine can be made of them.
TrunkOptions random_trunk_options(std::uint64_t seed);

/// What is out of the ordinary: "crushed T8 0.42/0.90; cement L1; sharpness 2.1"; for lists of results.
std::string describe(const TrunkOptions& options);

}  // namespace spinaltap
