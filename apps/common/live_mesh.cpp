#include "apps/common/live_mesh.h"

#include <algorithm>

namespace spinaltap {

LiveMesh::LiveMesh(const BoneModel& bone, const DrillBit& bit, double longest_jump_mm)
    : bit_(bit), longest_jump_mm_(longest_jump_mm) {
  one_thread_.execute([&] {
    bone_.emplace(bone, RemainingBoneOptions{.undo_bytes = 0});
    surface_.emplace(*bone_);
  });
}

void LiveMesh::update(const ToolInput& input) {
  updates_.clear();
  if (!input.pose.tip_mm.allFinite() || !(input.pose.axis.squaredNorm() > 0.25) || !input.pose.axis.allFinite()) return;
  if (!input.spindle_on) {
    last_.reset();
    return;
  }
  const Pose pose{input.pose.tip_mm, input.pose.axis.normalized()};
  std::vector<Pose> way{pose};
  if (last_) {
    const Vec3 tip_way_mm = pose.tip_mm - last_->tip_mm;
    const Vec3 base_way_mm = tip_way_mm - bit_.length_mm * (pose.axis - last_->axis);
    if (std::max(tip_way_mm.norm(), base_way_mm.norm()) <= longest_jump_mm_) way.insert(way.begin(), *last_);
  }
  last_ = pose;
  one_thread_.execute([&] {
    bone_->drill(bit_, way);
    updates_ = surface_->update();
  });
}

}  // namespace spinaltap
