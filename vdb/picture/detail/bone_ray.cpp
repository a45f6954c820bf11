#include "vdb/picture/detail/bone_ray.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace spinaltap::detail {

DrawnBone::DrawnBone(const BoneModel& its_bone) : DrawnBone(its_bone, its_bone.grids().hole) {}

DrawnBone::DrawnBone(const BoneModel& its_bone, openvdb::FloatGrid::ConstPtr hole)
    : bone(before_drilling(its_bone)),
      bone_grid(bone.grids().sdf),
      hole_grid(std::move(hole)),
      bone_box(SurfaceCrossing::box_of(*bone_grid)) {
  if (hole_grid && hole_grid->activeVoxelCount() > 0) hole_box = SurfaceCrossing::box_of(*hole_grid);
}

BoneRay::BoneRay(const DrawnBone& bone, const std::optional<CutPlane>& cut)
    : drawn_(bone),
      to_bone_(*bone.bone_grid, bone.bone_box),
      // Never asked where there is no hole.
      hole_accessor_((bone.hole_grid ? bone.hole_grid : bone.bone_grid)->getConstAccessor()),
      hole_(hole_accessor_, bone.bone_grid->transform()),
      cut_(cut),
      step_mm_(bone.bone_grid->voxelSize()[0]) {
  if (bone.hole_box) to_hole_.emplace(*bone.hole_grid, *bone.hole_box);
  if (cut_) cut_->normal.normalize();
}

double BoneRay::next_crossing_mm(SurfaceCrossing& surface, double begin_mm) const {
  // OpenVDB's rays begin after their eye, which may lie in a voxel.
  const double after_eye_mm = std::max(begin_mm, openvdb::math::Delta<double>::value());
  const openvdb::math::Ray<double> ray(to_vdb(start_mm_), to_vdb(direction_), after_eye_mm);
  openvdb::Vec3d hit;
  if (!surface.find(ray, hit)) return kMissed;
  return (from_vdb(hit) - start_mm_).dot(direction_);
}

/// From a place on where the ray is in the bone as it was: elsewhere the hole is not seen.
void BoneRay::find_hole(double begin_mm) {
  knows_hole_ = true;
  if (to_hole_) hole_crossing_mm_ = next_crossing_mm(*to_hole_, begin_mm);
}

void BoneRay::begin(const Vec3& start_mm, const Vec3& direction, bool is_in_bone) {
  start_mm_ = start_mm;
  direction_ = direction;
  begin_mm_ = 0.0;
  end_mm_ = kMissed;
  if (cut_) {
    const double above_mm = (start_mm - cut_->point_mm).dot(cut_->normal);
    const double rise = direction.dot(cut_->normal);
    if (rise < 0.0) begin_mm_ = std::max(0.0, -above_mm / rise);
    if (rise > 0.0) end_mm_ = -above_mm / rise;
    if (rise == 0.0 && above_mm > 0.0) end_mm_ = 0.0;
  }
  is_in_bone_ = is_in_bone;
  find_bone_from_mm_ = find_hole_from_mm_ = -1.0;
  bone_crossing_mm_ = begin_mm_ > 0.0 ? begin_mm_ : next_crossing_mm(to_bone_, 0.0);
  hole_crossing_mm_ = kMissed;
  knows_hole_ = false;
  passed_mm_ = begin_mm_;
  if (bone_crossing_mm_ < kMissed && begin_mm_ == 0.0 && bone_mm(start_mm) < 0.0) find_hole(0.0);
}

BoneRay::Surface BoneRay::next_surface() {
  // A little further on, so that the same surface is not met again. What is there is looked up and not counted: the
  // hole is kept only near the bone, so that not all ways into it are met.
  const double further_mm = 0.02 * step_mm_;
  while (true) {
    if (is_in_bone_ && !knows_hole_) find_hole(passed_mm_);
    if (find_bone_from_mm_ >= 0.0) bone_crossing_mm_ = next_crossing_mm(to_bone_, find_bone_from_mm_);
    if (find_hole_from_mm_ >= 0.0) hole_crossing_mm_ = next_crossing_mm(*to_hole_, find_hole_from_mm_);
    find_bone_from_mm_ = find_hole_from_mm_ = -1.0;
    const double way_mm = std::min(bone_crossing_mm_, hole_crossing_mm_);
    const bool is_wall = way_mm < bone_crossing_mm_;
    if (!(way_mm < end_mm_)) return {};
    const bool was_in_bone = is_in_bone_;
    const double beyond_mm = way_mm + further_mm;
    if (is_wall) {
      find_hole_from_mm_ = beyond_mm;
    } else {
      find_bone_from_mm_ = beyond_mm;
    }
    passed_mm_ = beyond_mm;
    const Vec3 beyond = at(beyond_mm);
    is_in_bone_ = distance_mm(beyond) < 0.0;
    if (!is_in_bone_ && !knows_hole_ && bone_mm(beyond) < 0.0) find_hole(beyond_mm);
    const bool is_cut = begin_mm_ > 0.0 && way_mm == begin_mm_;
    if (is_in_bone_ != was_in_bone) return {way_mm, is_cut ? Kind::cut : is_wall ? Kind::wall : Kind::bone};
  }
}

double BoneRay::refined_mm(const Surface& surface) {
  constexpr double kCloseMm = 1e-6;
  constexpr int kMaxSteps = 12;
  if (surface.kind == Kind::cut) return surface.way_mm;
  const auto value_mm = [&](double way_mm) {
    return surface.kind == Kind::bone ? bone_mm(at(way_mm)) : hole_mm(at(way_mm));
  };
  // The secant through the last two places, no further than a voxel from the first.
  double before_mm = surface.way_mm;
  double before = value_mm(before_mm);
  double best_mm = before_mm;
  double best = std::abs(before);
  double now_mm = before_mm + 0.05 * step_mm_;
  for (int n = 0; n < kMaxSteps && best > kCloseMm; ++n) {
    const double now = value_mm(now_mm);
    if (std::abs(now) < best) {
      best = std::abs(now);
      best_mm = now_mm;
    }
    const double next_mm = now_mm - now * (now_mm - before_mm) / (now - before);
    if (!(std::abs(next_mm - surface.way_mm) < step_mm_)) break;
    before_mm = now_mm;
    before = now;
    now_mm = next_mm;
  }
  return best_mm;
}

double BoneRay::bone_mm(const Vec3& p_mm) {
  float distance_mm = 0.0F;
  drawn_.bone.sample({&p_mm, 1}, {&distance_mm, 1}, {});
  return static_cast<double>(distance_mm);
}

double BoneRay::distance_mm(const Vec3& p_mm) {
  double distance_mm = bone_mm(p_mm);
  if (to_hole_) distance_mm = std::max(distance_mm, -hole_mm(p_mm));
  if (cut_) distance_mm = std::max(distance_mm, (p_mm - cut_->point_mm).dot(cut_->normal));
  return distance_mm;
}

Vec3 BoneRay::normal(const Vec3& p_mm, Kind kind) {
  if (kind == Kind::cut) return cut_->normal;
  const bool is_wall = kind == Kind::wall;
  Vec3 slope;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 step = step_mm_ * Vec3::Unit(axis);
    slope[axis] = is_wall ? hole_mm(p_mm - step) - hole_mm(p_mm + step) : bone_mm(p_mm + step) - bone_mm(p_mm - step);
  }
  return slope.norm() > 0.0 ? slope.normalized() : Vec3(-direction_);
}

}  // namespace spinaltap::detail
