#pragma once

#include <filesystem>
#include <optional>

#include "core/base/progress.h"
#include "core/base/stage_clock.h"
#include "core/ct/ct_volume.h"
#include "core/ct/label_volume.h"
#include "core/files/bake_cache.h"
#include "core/rbf/fit_surface.h"
#include "core/segment/segment_spine.h"
#include "core/surface/surface_points.h"
#include "vdb/bake/bake.h"

namespace spinaltap {

struct BakedCt {
  BoneModel bone;
  std::size_t mask_voxels = 0;
  SurfaceFitReport fit;
  BakeReport bake;
  Level level = Level::kNone;               ///< where it is known
  std::optional<LevelWarnings> warnings{};  ///< what speaks against the mask
  std::string level_source{};               ///< how a label map's level is known, in words; empty where it is not
  bool mask_from_cache = false;
  bool fit_from_cache = false;
  std::vector<StageTime> times{};  ///< how long it took: "segmented" (by bake_ct() alone), "points", "fitted", "baked"
};

/// Which voxels are the wanted bone, and how they were found.
struct ChosenBone {
  BoneMask mask;
  std::optional<Segmentation> found;  ///< without a label map; its mask is moved out
  Level level = Level::kNone;         ///< kNone: not known
  int label = 0;                      ///< of the map
  std::string level_source{};         ///< how the map's level is known, in words; empty where it is not
  LevelWarnings warnings{};           ///< what speaks against the mask
};

/// The bone that a label map marks, or the vertebra that segment_vertebra() finds, with what speaks against it: a label
/// whose edge lies on no edges of bone, a bone that the CT's border cuts.
ChosenBone choose_bone(const CtVolume& ct, const std::optional<LabelChoice>& labels, const SegmentOptions& options,
                       const Progress& progress = {});

/// The voxels that a label map marks, without a look at the CT. Throws Error as read_label_volume() does.
BoneMask label_mask(const LabelChoice& choice, const GridGeometry& geometry);

/// The rest of the chain, from a mask on. The metadata records how the mask came about, its level, warnings and
/// severity, and what speaks against the CT.
BakedCt bake_mask(const CtVolume& ct, const MaskStage& mask, const BakeCtOptions& options,
                  const Progress& progress = {});

/// The chain from a CT to a baked bone: mask, surface points, radial basis function, grids. Masks and functions that
/// the cache has are taken from there; the result is the same.
BakedCt bake_ct(const CtVolume& ct, const BakeCtOptions& options = {}, const Progress& progress = {});

}  // namespace spinaltap
