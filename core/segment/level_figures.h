#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/base/geometry.h"

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

/// What whoever marked a bone thinks of it.
struct LevelWarnings {
  std::vector<std::string> warnings;  ///< one line each
  double severity = 0.0;              ///< 0: none, to 1: likely wrong
  std::vector<Vec3> unsure_mm{};      ///< bone of which it is unsure whose it is: LevelFigures::unsure_mm

  bool is_suspect() const { return severity >= kSuspect; }
  bool operator==(const LevelWarnings&) const = default;
};

}  // namespace spinaltap
