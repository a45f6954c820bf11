#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "tests/support/analytic_bodies.h"
#include "vdb/engine/voxel_bone.h"
#include "vdb/sim/session.h"

namespace spinaltap::test {

// A ball of bone that sessions drill as voxels.

inline constexpr std::int16_t kEvenHu = 304;  ///< eight bits have it
inline const Ball kVoxelBall{Vec3(3.0, -4.0, 5.0), 9.0};

inline const Bone& voxel_ball() {
  static const Bone bone(bake_ball(kVoxelBall, 0.25, kEvenHu));
  return bone;
}

inline DrillPath path_through(const Vec3& direction, const DrillBit& bit = {3.1, 50.0, 3.0}) {
  const Vec3 axis = direction.normalized();
  const Vec3 entry_mm = kVoxelBall.centre_mm - kVoxelBall.radius_mm * axis;
  return {"through", entry_mm, entry_mm + 14.0 * axis, bit};
}

inline SessionSetup voxel_setup(const DrillPath& path) {
  SessionSetup setup;
  setup.path = path;
  setup.engine = EngineKind::voxel;
  setup.volume.spacing_mm = 0.1;
  setup.volume.lead_in_mm = 1.0;
  setup.has_clearances = false;
  return setup;
}

/// The section of the voxels that a hole takes, over its own: along the lattice's directions the same columns are in it
/// all the way, and their number is not quite the section's.
inline double section_of_voxels(const DrillPath& path, double voxel_mm) {
  const double from_mm = 4.505, to_mm = 9.505;
  const Vec3 middle_mm = path.entry_mm + 7.0 * path.direction();
  const Eigen::Vector3i low = ((middle_mm.array() - 4.0) / voxel_mm).floor().matrix().cast<int>();
  const int count = static_cast<int>(8.0 / voxel_mm) + 1;
  std::size_t inside = 0;
  for (int x = 0; x < count; ++x) {
    for (int y = 0; y < count; ++y) {
      for (int z = 0; z < count; ++z) {
        const Vec3 from_entry = voxel_mm * (low + Eigen::Vector3i(x, y, z)).cast<double>() - path.entry_mm;
        const double along_mm = from_entry.dot(path.direction());
        if (along_mm < from_mm || along_mm >= to_mm) continue;
        if ((from_entry - along_mm * path.direction()).norm() <= path.bit.radius_mm()) ++inside;
      }
    }
  }
  const double hole_mm3 = std::numbers::pi * path.bit.radius_mm() * path.bit.radius_mm() * (to_mm - from_mm);
  return static_cast<double>(inside) * voxel_mm * voxel_mm * voxel_mm / hole_mm3;
}

/// A ball burr that goes 3 mm into the ball and then 4 mm aside, as what a session is fed.
inline std::vector<ToolInput> slot_of(const DrillPath& path, double aside_mm) {
  const Vec3 aside = any_perpendicular(path.direction());
  std::vector<ToolInput> inputs;
  const auto go_to = [&](const Vec3& tip_mm) { inputs.push_back({{tip_mm, path.direction()}, true, 1e-3}); };
  for (int n = 0; n <= 200; ++n) go_to(path.entry_mm + (0.02 * n - 1.0) * path.direction());
  const Vec3 deepest_mm = inputs.back().pose.tip_mm;
  for (int n = 1; n <= 200; ++n) go_to(deepest_mm + n * aside_mm / 200.0 * aside);
  return inputs;
}

inline SessionSetup slot_setup(std::optional<double> margin_mm) {
  const DrillBit burr{4.0, 40.0, 1.0, BitShape::round_burr, 0.0, 2.0};
  DrillPath path = path_through({0.2, -0.9, 0.3}, burr);
  path.target_mm = path.entry_mm + 3.0 * path.direction();
  SessionSetup setup = voxel_setup(path);
  setup.bone_hash = voxel_ball().hash();
  if (margin_mm) setup.region_mm = region_around(path, setup.volume.lead_in_mm, *margin_mm);
  return setup;
}

inline std::vector<std::uint64_t> occupancy_words(const Session& session) {
  std::vector<std::uint64_t> words;
  session.voxels()->get_occupancy_words(words);
  return words;
}

}  // namespace spinaltap::test
