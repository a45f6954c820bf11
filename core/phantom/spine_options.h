#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/geometry.h"
#include "core/ct/level.h"

namespace spinaltap {

/// A body that has broken under its load: what is left of its height, in front and at the back.
struct CrushedLevel {
  Level level = Level::kNone;
  double front_share = 0.5;
  double back_share = 0.9;
};

/// What a spine phantom is made like. The defaults give a healthy adult.
struct SpineOptions {
  Level first = Level{13};   ///< uppermost level: T6; C1 and C2 are simple solids
  Level last = Level::kL5;   ///< lowest level
  int thoracic_levels = 12;  ///< 11 to 13, each with ribs: without T12, or with T13
  int lumbar_levels = 5;     ///< 4 to 6: without L5, or with L6

  double scale = 1.0;  ///< of all vertebrae, ribs and discs
  /// Heights of the discs in their middle; nothing: each level's own. A disc between endplates at an angle is higher
  /// where it must be to leave half of its height at the rims.
  std::optional<double> cervical_disc_mm{}, thoracic_disc_mm{}, lumbar_disc_mm{};
  double facet_gap_mm = 1.0;  ///< least distance between the bone of neighbours, at the facets and elsewhere

  double cervical_lordosis_deg = 25.0;                       ///< from C3 to C7
  double kyphosis_deg = 40.0;                                ///< from T1 to T12
  double lordosis_deg = 55.0;                                ///< from L1 to the sacrum
  double scoliosis_deg = 0.0;                                ///< Cobb's angle; above 0: convex to the right
  std::optional<Level> scoliosis_first{}, scoliosis_last{};  ///< end vertebrae of the curve; nothing: first and last
  double scoliosis_turn = 0.25;  ///< turn of the apex about its axis, as a share of Cobb's angle

  bool ribs = true;
  double rib_gap_mm = 0.8;  ///< least distance between a rib and a vertebra
  double rib12_mm = 100.0;  ///< length of the twelfth ribs

  bool sacrum = false;
  bool pelvis = false;     ///< hip bones and thighs beside the sacrum: bones without a level
  bool shoulders = false;  ///< scapulae, upper arms, collarbones and breastbone about T2: likewise
  bool skull = false;      ///< a braincase and a jaw over C1: bones without a level

  double osteophyte_mm = 0.0;          ///< radius of the bony spurs at the rims; 0: none
  double osteophyte_gap_mm = 1.0;      ///< between spurs that face each other across a disc; 0: they bridge it
  double osteophyte_share = 0.6;       ///< of the places at the rims that have one
  bool osteoporosis = false;           ///< thin cortex, empty cancellous bone
  double density = 1.0;                ///< of cancellous bone in the vertebrae: a factor of its CT numbers
  std::vector<Level> schmorl_nodes{};  ///< levels with a pit in the upper endplate
  std::vector<CrushedLevel> crushed{};
  std::vector<Level> cement{};     ///< levels with bone cement in the body
  std::vector<Level> screws{};     ///< levels with a metal screw in each pedicle
  double screw_diameter_mm = 5.5;  ///< thinner where a pedicle is narrower

  /// How much levels differ by chance: 1 for sizes within 10 %, pedicles within 15 %, discs within 25 %, turns within 3
  /// degrees; 0 for none. The same seed gives the same spine.
  double variation = 0.0;
  std::uint64_t seed = 1;

  Vec3 tilt_deg = Vec3::Zero();     ///< of the whole patient, about x, then y, then z
  Vec3 position_mm = Vec3::Zero();  ///< where the body of the middle level stands, patient LPS
};

/// The next level down a spine with as many levels as the options say; the sacrum below the last lumbar one.
Level level_below(Level level, const SpineOptions& options);

/// C1 and C2, which are simple solids without measures.
inline bool is_upper_neck(Level level) { return level == Level::kC1 || level == Level{2}; }

/// Throws Error, which names the value, on options without sense.
void check_spine_options(const SpineOptions& options);

/// A random patient between the levels of `range`: size within 0.85 to 1.1, tilt within 10 degrees, scoliosis, discs,
/// spurs, weak bone, pits and ribs by chance. The same seed gives the same options.
SpineOptions random_spine_options(std::uint64_t seed, const SpineOptions& range = {});

}  // namespace spinaltap
