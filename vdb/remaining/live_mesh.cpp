#include "vdb/remaining/live_mesh.h"

#include <algorithm>

namespace spinaltap {

LiveMesh::LiveMesh(const BoneModel& bone, const RemainingBoneOptions& options) {
  one_thread_.execute([&] {
    bone_.emplace(bone, options);
    surface_.emplace(*bone_);
  });
}

LiveMesh::LiveMesh(const BoneModel& bone, const DrillBit& bit, double max_jump_mm) : LiveMesh(bone) {
  take_bit(bit, max_jump_mm);
}

void LiveMesh::take_bit(const DrillBit& bit, double max_jump_mm) {
  bit_ = bit;
  longest_jump_mm_ = max_jump_mm;
  last_.reset();
}

void LiveMesh::update(std::span<const ToolInput> inputs) {
  std::vector<Pose> way;
  if (last_) way.push_back(*last_);
  for (const ToolInput& input : inputs) {
    const std::optional<Pose> sound = sound_pose(input.pose);
    if (!sound) continue;
    const Pose& pose = *sound;
    if (!way.empty()) {
      const Vec3 tip_way_mm = pose.tip_mm - way.back().tip_mm;
      const Vec3 base_way_mm = tip_way_mm - bit_.length_mm * (pose.axis - way.back().axis);
      const bool is_jump = std::max(tip_way_mm.norm(), base_way_mm.norm()) > longest_jump_mm_;
      if (is_jump || !input.spindle_on) drill(way);
    }
    if (input.spindle_on) way.push_back(pose);
  }
  last_ = way.empty() ? std::nullopt : std::optional(way.back());
  drill(way);
  mesh();
}

void LiveMesh::drill(std::vector<Pose>& way) {
  if (way.empty()) return;
  one_thread_.execute([&] { bone_->drill(bit_, way); });
  way.clear();
}

void LiveMesh::mesh() {
  one_thread_.execute([&] { updates_ = surface_->update(); });
}

bool LiveMesh::undo_hole() {
  const bool is_undone = bone_->undo();
  last_.reset();
  mesh();
  return is_undone;
}

bool LiveMesh::redo_hole() {
  const bool is_redone = bone_->redo();
  last_.reset();
  mesh();
  return is_redone;
}

void LiveMesh::reset() {
  bone_->reset();
  last_.reset();
  mesh();
}

}  // namespace spinaltap
