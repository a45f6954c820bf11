#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/ct/level.h"
#include "core/segment/level_cut.h"

namespace spinaltap {

/// The bodies of a CT's spine and what was learned on the way.
struct SpineBodies {
  BoneLevels levels;
  SpinalCanal canal;
  std::vector<BodySpan> chain;        ///< from below upward
  std::vector<VertebralBody> bodies;  ///< one for each of the chain
};

/// Finds the bodies of all vertebrae in a CT, with `near_mm` (a point in one of them, patient LPS) those of the spine
/// that it lies in. Empty lists where there is no spine. `threshold_hu`: bone is at least this dense; by default chosen
/// from the CT (choose_bone_levels()).
SpineBodies find_spine_bodies(const CtVolume& ct, std::optional<double> threshold_hu = std::nullopt,
                              const std::optional<Vec3>& near_mm = std::nullopt, const Progress& progress = {});

/// A vertebra out of a CT.
struct SegmentedLevel {
  std::size_t index = 0;             ///< in the chain of bodies, from below
  VoxelBox box;                      ///< of the CT
  std::vector<std::uint8_t> inside;  ///< voxels of the box, i fastest
  BodyCylinder body;
  double cut_area_mm2 = 0.0;
  std::size_t parts_dropped = 0;
  bool cut_above = false;  ///< the body goes on beyond the CT
  bool cut_below = false;
};

/// Parts the vertebrae of the bodies with indices first ... last (from below) from each other, from ribs and from all
/// other bone. Each voxel goes to the body that a random walker from there is likeliest to meet first, or to none.
std::vector<SegmentedLevel> segment_levels(const CtVolume& ct, const SpineBodies& spine, std::size_t first,
                                           std::size_t last, const Progress& progress = {});

}  // namespace spinaltap
