#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/ct/grid_geometry.h"

namespace spinaltap {

/// What a voxel is to the walker.
enum class WalkerVoxel : std::uint8_t {
  kOutside,  ///< no way through
  kFree,     ///< to be decided
  kWanted,   ///< a marker of the wanted part
  kOther,    ///< a marker of anything else
};

/// The probability that a random walker starting at each voxel meets a marker of the wanted part before any other
/// (Grady 2006, "Random walks for image segmentation"). A step between face neighbours is as likely as the smaller of
/// their conductivities (above 0) times the face's area over the distance. 1 and 0 at markers; 0 outside and where no
/// marker can be reached.
///
/// Solved by Eigen's conjugate gradients (CoarseCorrection) on one thread, so that the result does not depend on the
/// number of threads. Throws Error when it does not converge.
std::vector<float> walk_randomly(std::span<const WalkerVoxel> voxels, std::span<const float> conductivity,
                                 const GridGeometry& geometry, const Progress& progress = {});

}  // namespace spinaltap
