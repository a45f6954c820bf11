#pragma once

#include <filesystem>
#include <optional>

#include "core/base/progress.h"
#include "core/ct/ct_volume.h"
#include "core/rbf/fit_surface.h"
#include "core/surface/surface_points.h"
#include "vdb/bake.h"
#include "core/segment/segment_spine.h"

namespace spinaltap {

/// A voxel label map that says which bone is meant.
struct LabelChoice {
  std::filesystem::path file;  ///< NIfTI or NRRD
  int label = 1;
};

struct BakeCtOptions {
  std::optional<LabelChoice> labels;  ///< without it: what segment_vertebra() finds
  SegmentOptions segment;
  SurfaceOptions surface;
  SurfaceFitOptions rbf;
  BakeOptions bake;
  std::filesystem::path cache;  ///< folder of finished stages (bake_cache.h); empty: none
};

struct BakedCt {
  BoneModel bone;
  std::size_t mask_voxels = 0;
  SurfaceFitReport fit;
  BakeReport bake;
  bool mask_from_cache = false;
  bool fit_from_cache = false;
};

/// Which voxels are the wanted bone, and how they were found.
struct ChosenBone {
  BoneMask mask;
  std::optional<SegmentReport> report;  ///< without a label map
};

/// The bone that a label map marks, or the vertebra that segment_vertebra() finds.
ChosenBone choose_bone(const CtVolume& ct, const std::optional<LabelChoice>& labels, const SegmentOptions& options,
                       const Progress& progress = {});

/// The chain from a CT to a baked bone: mask, surface points, radial basis function, grids. Masks and functions that
/// the cache has are taken from there; the result is the same.
BakedCt bake_ct(const CtVolume& ct, const BakeCtOptions& options = {}, const Progress& progress = {});

}  // namespace spinaltap
