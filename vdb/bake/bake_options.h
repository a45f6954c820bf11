#pragma once

#include <filesystem>
#include <optional>

#include "core/ct/grid_geometry.h"
#include "core/ct/label_volume.h"
#include "core/ct/level.h"
#include "core/segment/segment_spine.h"
#include "core/surface/surface_options.h"

namespace spinaltap {

/// How a field and a CT become grids: bake_bone().
struct BakeOptions {
  double voxel_mm = 0.25;
  double hu_margin_mm = 2.0;  ///< how far beyond the bone CT numbers are kept
};

/// A voxel label map that says which bone is meant: by its number, or by its level.
struct LabelChoice {
  std::filesystem::path file;  ///< NIfTI or NRRD
  int label = 1;               ///< 0: the only one, or 1 where there are several
  Level level = Level::kNone;  ///< other than kNone: in place of the number
  LabelConvention convention = LabelConvention::automatic;
  NiftiAffine affine = NiftiAffine::automatic;  ///< of a NIfTI file whose two transforms differ
};

/// The chain from a CT to a baked bone: which bone it is, and how it is found, fitted and baked.
struct BakeCtOptions {
  std::optional<LabelChoice> labels;  ///< without it: what segment_vertebra() finds
  SegmentOptions segment;
  SurfaceOptions surface;
  SurfaceFitOptions rbf;
  BakeOptions bake;
  std::filesystem::path cache;  ///< folder of finished stages (bake_cache.h); empty: none
};

}  // namespace spinaltap
