#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/segment/level_cut.h"
#include "core/segment/level_figures.h"

namespace spinaltap {

/// Voxels of a cut: 1 where it is so.
struct CutMasks {
  const std::vector<std::uint8_t>& finished;  ///< the vertebra
  const std::vector<std::uint8_t>& given;     ///< what the walker gave it, before rims were taken off
  const std::vector<std::uint8_t>& others;    ///< its neighbours
};
LevelFigures measure_level(const LevelCut& cut, const CutMasks& masks, const BodyInRow& row);

/// Whether the vertebra, `inside` of a box of the CT, reaches the CT's border; where it does, the figures are told.
bool find_border(const GridGeometry& ct, const VoxelBox& box, const std::vector<std::uint8_t>& inside,
                 const BodyInRow& row, LevelFigures& figures);

/// Everything that speaks against a vertebra: ends that are no endplates, a size unlike its neighbours', a part that is
/// missing or too much, a cut through bone, metal. `chain` and `row` are of the same bodies.
std::vector<LevelWarning> check_level(const LevelFigures& figures, const std::vector<BodySpan>& chain,
                                      const BodyInRow& row);

/// Voxels (mm) in which arches cannot be parted, as those of thick slices; empty where they can.
std::vector<LevelWarning> check_voxels(const Vec3& spacing_mm);

/// 1 less the product of what is left of the severities: several small ones add up.
double total_severity(const std::vector<LevelWarning>& warnings);

}  // namespace spinaltap
