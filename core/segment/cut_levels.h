#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/segment/level_warnings.h"
#include "core/segment/spine_bodies.h"

namespace spinaltap {

/// A vertebra out of a CT.
struct CutVertebra {
  std::size_t index = 0;             ///< in the chain of bodies, from below
  VoxelBox box;                      ///< of the CT
  std::vector<std::uint8_t> inside;  ///< voxels of the box, i fastest
  double cut_area_mm2 = 0.0;
  std::size_t parts_dropped = 0;
  LevelFigures figures;
  VoxelBox ribs_box;               ///< of the CT
  std::vector<std::uint8_t> ribs;  ///< voxels of that box where ribs are
  double left_rib_mm3 = 0.0;       ///< of ribs' necks beside the body, where only this level's can be
  double right_rib_mm3 = 0.0;
};

/// Parts the vertebrae of the bodies with indices first ... last (from below) from each other, from ribs and from all
/// other bone, and gives them to `visit`, the lowest first. Each voxel goes to the body that a random walker from there
/// is likeliest to meet first, or to none.
void cut_levels(const CtVolume& ct, const SpineBodies& spine, std::size_t first, std::size_t last,
                const std::vector<MarkedVoxels>& marks, const std::function<void(CutVertebra&&)>& visit,
                const Progress& progress = {});

}  // namespace spinaltap
