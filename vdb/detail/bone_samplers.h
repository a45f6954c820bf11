#pragma once

#include "vdb/detail/grid_sampler.h"

namespace spinaltap::detail {

struct BoneGrids;

/// The samplers of a BoneModel's grids.
struct BoneSamplers {
  GridSampler distance;  ///< with signs
  GridSampler hu;
};

/// Lists the leaves and tiles of both grids. Throws Error where the box around a grid's content is absurdly large for
/// what lies in it, and where a grid is in perspective.
BoneSamplers make_samplers(const BoneGrids& grids);

}  // namespace spinaltap::detail
