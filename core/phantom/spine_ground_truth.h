#pragma once

#include <vector>

#include "core/phantom/spine.h"
#include "core/phantom/vertebra_ground_truth.h"

namespace spinaltap {

/// What is known of one level without measuring. Points and directions in patient LPS, mm.
struct LevelGroundTruth {
  Level level = Level::kNone;
  VertebraGroundTruth pedicles;
  Vec3 body_centre_mm = Vec3::Zero();
  Vec3 superior_endplate_mm = Vec3::Zero();  ///< in the middle of the plane of its rim
  Vec3 inferior_endplate_mm = Vec3::Zero();
  Vec3 superior_normal = Vec3::UnitZ();  ///< unit, upward
  Vec3 inferior_normal = Vec3::UnitZ();  ///< unit, upward
  Vec3 spinous_tip_mm = Vec3::Zero();    ///< on the surface, as are those of the transverse processes
  Vec3 left_transverse_tip_mm = Vec3::Zero();
  Vec3 right_transverse_tip_mm = Vec3::Zero();
};

/// The disc below a level.
struct DiscGroundTruth {
  Level above = Level::kNone;
  Vec3 centre_mm = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  ///< unit, upward: between its endplates' normals
  double height_mm = 0.0;       ///< between the middles of the endplates' rims
  double width_mm = 0.0, depth_mm = 0.0;
};

struct SpineGroundTruth {
  std::vector<LevelGroundTruth> levels;  ///< from above, without C1, C2 and the sacrum
  std::vector<DiscGroundTruth> discs;
};

/// Works out the ground truth of a spine made from SpineOptions; empty for any other bodies.
SpineGroundTruth spine_ground_truth(const Spine& spine);

}  // namespace spinaltap
