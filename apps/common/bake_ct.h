#pragma once

#include <filesystem>
#include <optional>

#include "core/base/progress.h"
#include "core/ct/ct_volume.h"
#include "core/rbf/rbf_fit.h"
#include "core/segment/threshold_mask.h"
#include "core/surface/surface_points.h"
#include "vdb/bake.h"

namespace spinaltap {

/// A voxel label map that says which bone is meant.
struct LabelChoice {
  std::filesystem::path file;  ///< NIfTI
  int label = 1;
};

struct BakeCtOptions {
  std::optional<LabelChoice> labels;  ///< without it: the largest part over the threshold
  ThresholdOptions threshold;
  SurfaceOptions surface;
  RbfFitOptions rbf;
  BakeOptions bake;
};

struct BakedCt {
  BoneModel bone;
  std::size_t mask_voxels = 0;
  RbfFitReport fit;
  BakeReport bake;
};

/// The chain from a CT to a baked bone: mask, surface points, radial basis function, grids.
BakedCt bake_ct(const CtVolume& ct, const BakeCtOptions& options = {}, const Progress& progress = {});

}  // namespace spinaltap
