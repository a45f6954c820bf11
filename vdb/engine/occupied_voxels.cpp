#include "vdb/engine/occupied_voxels.h"

#include <openvdb/tree/ValueAccessor.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/points/hu_byte.h"
#include "core/tool/path_curve.h"
#include "vdb/engine/detail/voxel_leaves.h"

namespace spinaltap {
namespace {

using openvdb::Coord;
using VoxelReader = openvdb::tree::ValueAccessor3<const detail::VoxelTree, false>;

constexpr double kNowhereMm = -std::numeric_limits<double>::infinity();

class OccupiedVoxels final : public OccupiedBone {
 public:
  OccupiedVoxels(const VoxelBone& bone, const Material& material)
      : bone_(bone),
        per_mm_(1.0 / bone.voxel_mm()),
        bones_(material, {hu_of_byte(0), hu_of_byte(255)}),
        reader_(bone.leaves().tree) {}

  const PathFrame& frame() const override { return frame_; }
  bool has_occupied() const override { return bone_.occupied_count() > 0; }
  double widest_spacing_mm() const override { return bone_.voxel_mm(); }
  double spacing_mm(const Vec3& /*p*/) const noexcept override { return bone_.voxel_mm(); }
  const PointVolume* discs_at(double /*z_mm*/) const noexcept override { return nullptr; }

  const Bone* occupied_at(const Vec3& p) const noexcept override {
    const Vec3 at = (per_mm_ * p).array() + 0.5;
    return is_near(at) ? bone_at(corner_of(at)) : nullptr;
  }

  void add_ahead_of(const Vec3& p, const Vec3& axis, double share, Mean& mean) const noexcept override {
    // So far ahead that the hindmost of the eight lies beside the place.
    const Vec3 at = per_mm_ * p + axis.cwiseAbs().sum() * axis;
    if (!is_near(at)) return;
    const Coord low = corner_of(at);
    const Vec3 part = at.array() - at.array().floor();
    for (int n = 0; n < 8; ++n) {
      const bool x = (n & 4) != 0, y = (n & 2) != 0, z = (n & 1) != 0;
      const double weight =
          (x ? part.x() : 1.0 - part.x()) * (y ? part.y() : 1.0 - part.y()) * (z ? part.z() : 1.0 - part.z());
      mean.add(bone_at(low.offsetBy(x ? 1 : 0, y ? 1 : 0, z ? 1 : 0)), share * weight);
    }
  }

  void check_within(const DrillPath& path) const override {
    constexpr double kPlacesMm = 0.25;
    for (const Vec3& end_mm : PathCurve(path).places_mm(kPlacesMm)) {
      const double beyond_mm = past_end_mm(end_mm);
      if (beyond_mm <= bone_.voxel_mm()) continue;
      fail("path ", in_quotes(path.name), ": expected it within the region of the voxels, found a place ", beyond_mm,
           " mm out of it");
    }
  }

  double past_end_mm(const Vec3& tip_mm) const noexcept override { return beyond_mm(tip_mm, Vec3::Zero()); }

  double beyond_side_mm(const BitProfile& bit, const Pose& pose, const Vec3& contact_mm) const noexcept override {
    if (bone_.region_mm().isEmpty()) return kNowhereMm;
    const double deep_mm = std::clamp((pose.tip_mm - contact_mm).dot(pose.axis), 0.0, bit.length_mm());
    const Vec3 across = (1.0 - pose.axis.array().square()).max(0.0).sqrt();  // half the box of a circle of radius 1
    double max_mm = kNowhereMm;
    const auto consider = [&](double back_mm, const Vec3& half_mm) {
      max_mm = std::max(max_mm, beyond_mm(pose.tip_mm - back_mm * pose.axis, half_mm));
    };
    // Straight outlines lie within the box of their ends' circles.
    for (const ProfilePiece& piece : bit.pieces()) {
      if (piece.begin_mm > deep_mm) break;
      const double end_mm = std::min(piece.end_mm, deep_mm);
      consider(piece.begin_mm, bit.widest_mm(piece.begin_mm, piece.begin_mm) * across);
      consider(end_mm, bit.widest_mm(end_mm, end_mm) * across);
      if (piece.ball_radius_mm > 0.0 && piece.ball_centre_mm <= deep_mm) {
        consider(piece.ball_centre_mm, Vec3::Constant(piece.ball_radius_mm));
      }
    }
    return max_mm;
  }

 private:
  static bool is_near(const Vec3& at) noexcept {
    constexpr double kFarthest = 1e8;  // voxels
    return at.cwiseAbs().maxCoeff() < kFarthest;
  }
  static Coord corner_of(const Vec3& at) noexcept {
    const Eigen::Vector3i corner = at.array().floor().cast<int>();
    return {corner.x(), corner.y(), corner.z()};
  }
  const Bone* bone_at(const Coord& voxel) const noexcept {
    std::uint8_t byte = 0;
    return reader_.probeValue(voxel, byte) ? &bones_.of(hu_of_byte(byte)) : nullptr;
  }
  /// How far a box around a place reaches out of the region.
  double beyond_mm(const Vec3& middle_mm, const Vec3& half_mm) const noexcept {
    const Box3& region_mm = bone_.region_mm();
    if (region_mm.isEmpty()) return kNowhereMm;
    const Vec3 below = region_mm.min() - (middle_mm - half_mm);
    const Vec3 above = middle_mm + half_mm - region_mm.max();
    return below.cwiseMax(above).maxCoeff();
  }

  const VoxelBone& bone_;
  double per_mm_;
  PathFrame frame_;
  Table bones_;
  VoxelReader reader_;
};

}  // namespace

std::unique_ptr<OccupiedBone> make_occupied_bone(const VoxelBone& bone, const Material& material) {
  return std::make_unique<OccupiedVoxels>(bone, material);
}

}  // namespace spinaltap
