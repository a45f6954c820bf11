#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/segment/level_cut.h"

namespace spinaltap {

/// Something about a vertebra that was cut out which looks unlike a whole vertebra, alone.
struct LevelWarning {
  std::string text;                ///< in words, with the figure and what was expected
  double doubt = 0.0;              ///< 0 to 1; from kDoubtful on the vertebra should be looked at before it is used
  std::optional<Vec3> where_mm{};  ///< patient LPS, where it is at one place
};
inline constexpr double kDoubtful = 0.5;

/// What is measured of a vertebra to judge it. Areas and volumes of sound ones: docs/segmentation.md.
struct LevelFigures {
  double left_share = 0.5;        ///< of the volume, to the left of the plane through body and canal
  double left_pedicle_mm2 = 0.0;  ///< section of bone between body and arch, where it is thinnest
  double right_pedicle_mm2 = 0.0;
  double canal_closed = 0.0;     ///< share of the directions around the canal in which the vertebra lies
  double behind_canal_mm = 0.0;  ///< how far it reaches behind the canal's middle
  double left_reach_mm = 0.0;    ///< how far it reaches to the left of that plane
  double right_reach_mm = 0.0;
  double bridge_mm2 = 0.0;      ///< of the cut to other bone, what goes through bone and not through a gap
  double unsure_share = 0.0;    ///< of its bone, where the walker hardly preferred it
  double side_sharpness = 1.0;  ///< the least of both sides', see SideBone; small where a rib may have stayed on
  double metal_mm3 = 0.0;       ///< voxels over 2,500 HU in it or on it
  double cement_mm3 = 0.0;      ///< dense lump in the body's inside
};

/// `mine`: the blocks of the finished vertebra; `shared_out`: those that the walker gave it, before rims were taken
/// off.
LevelFigures measure_level(const LevelCut& cut, const std::vector<std::uint8_t>& mine,
                           const std::vector<std::uint8_t>& shared_out, const BodyInRow& row);

/// Everything that speaks against a vertebra: ends that are no endplates, a size unlike its neighbours', a part that is
/// missing or too much, a cut through bone, metal. `chain` and `row` are of the same bodies.
std::vector<LevelWarning> check_level(const LevelFigures& figures, const std::vector<BodySpan>& chain,
                                      const BodyInRow& row);

/// 1 less the product of what is left of the doubts: several small ones add up.
double total_doubt(const std::vector<LevelWarning>& warnings);

}  // namespace spinaltap
