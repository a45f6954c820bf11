#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/segment/level_cut.h"

namespace spinaltap {

/// Something about a vertebra that was cut out which looks unlike a whole vertebra, alone.
struct LevelWarning {
  std::string text;                ///< in words, with the figure and what was expected
  double severity = 0.0;           ///< 0 to 1; from kSuspect on the vertebra should be looked at before it is used
  std::optional<Vec3> where_mm{};  ///< patient LPS, where it is at one place
};
inline constexpr double kSuspect = 0.5;

/// Where a vertebra meets another bone: a neighbour's body above or below its own, other bone beside its body, joints,
/// ribs.
enum class Contact {
  body_above,
  body_below,
  beside,
  upper_left,
  upper_right,
  lower_left,
  lower_right,
  left_rib,
  right_rib
};
inline constexpr std::size_t kContacts = 9;

/// Of the cut there, what goes through bone and not through a gap that the CT shows.
struct Bridge {
  double mm2 = 0.0;
  Vec3 where_mm = Vec3::Zero();  ///< its middle, patient LPS
};

/// What is measured of a vertebra to judge it. Areas and volumes of sound ones: docs/segmentation.md.
struct LevelFigures {
  double left_share = 0.5;        ///< of the volume, to the left of the plane through body and canal
  double left_pedicle_mm2 = 0.0;  ///< section of bone between body and arch, where it is thinnest
  double right_pedicle_mm2 = 0.0;
  double canal_closed = 0.0;     ///< share of the directions around the canal in which the vertebra lies
  double behind_canal_mm = 0.0;  ///< how far it reaches behind the canal's middle
  double left_reach_mm = 0.0;    ///< how far it reaches to the left of that plane
  double right_reach_mm = 0.0;
  std::array<Bridge, kContacts> bridges{};  ///< by Contact
  double lopsided_mm3 = 0.0;                ///< the largest piece that has no like on the other side
  Vec3 lopsided_at_mm = Vec3::Zero();       ///< its middle, patient LPS
  double unsure_share = 0.0;                ///< of its bone, where the walker hardly preferred it
  std::vector<Vec3> unsure_mm{};            ///< the voxels of the work that it counts, patient LPS
  double side_sharpness = 1.0;  ///< the least of both sides', see SideBone; small where a rib may have stayed on
  bool is_cut_behind = false;   ///< it reaches the CT's border behind the canal
  bool is_cut_left = false;     ///< and to the left of its body
  bool is_cut_right = false;
  double metal_mm3 = 0.0;   ///< voxels over 2,500 HU in it or on it
  double cement_mm3 = 0.0;  ///< dense lump in the body's inside
};

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
