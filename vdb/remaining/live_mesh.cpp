#include "vdb/remaining/live_mesh.h"

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

void LiveMesh::update(std::span<const ToolInput> inputs) { drill(cutting_ways(inputs, bit_, longest_jump_mm_, last_)); }

void LiveMesh::update(std::span<const ToolMove> moves) { drill(cutting_ways(moves, bit_, longest_jump_mm_, last_)); }

void LiveMesh::drill(const std::vector<std::vector<Pose>>& ways) {
  for (const std::vector<Pose>& way : ways) {
    one_thread_.execute([&] { bone_->drill(bit_, way); });
  }
  mesh();
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
