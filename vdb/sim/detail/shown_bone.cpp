#include "vdb/sim/detail/shown_bone.h"

namespace spinaltap {

HoleCutter& ShownBone::drilled(const SessionSetup& setup, std::span<const ToolInput> inputs) {
  if (!cutter_) {
    cutter_.emplace(bone_.model());
    for (const DrilledHole& hole : setup.holes) cutter_->add(hole);
    cutter_->take_bit(setup.path.bit, setup.options.max_jump_mm);
  }
  cutter_->add(inputs.subspan(cut_));
  cut_ = inputs.size();
  return *cutter_;
}

void ShownBone::change(const SurfaceUpdate& update) {
  if (update.surface) {
    blocks_.insert(update.block);
  } else {
    blocks_.erase(update.block);
  }
  changes_[update.block] = update;
}

void ShownBone::show(const SessionSetup& setup, std::span<const ToolInput> inputs) {
  if (!live_) {
    // Holes that the cutter has cut, or will need, are cut once.
    const BoneModel begun = setup.holes.empty() ? bone_.model()
                            : cut_ == 0         ? drilled(setup, {}).bone()
                                                : without_holes(bone_.model(), setup.holes);
    live_ = std::make_unique<LiveMesh>(begun, RemainingBoneOptions{});
    live_->take_bit(setup.path.bit, setup.options.max_jump_mm);
    live_holes_ = {{live_->holes_to_undo()}};
    for (const std::array<int, 3>& gone : std::set(blocks_)) change({gone, nullptr});
    for (const auto& block : live_->surface().blocks()) change({block->block, block});
  }
  if (shown_ == inputs.size()) return;
  live_->update(inputs.subspan(shown_));
  shown_ = inputs.size();
  for (const SurfaceUpdate& update : live_->updates()) change(update);
  if (!live_->updates().empty()) live_holes_.back().changes_bone = true;
}

std::vector<SurfaceUpdate> ShownBone::surface_changes(const SessionSetup& setup, std::span<const ToolInput> inputs) {
  show(setup, inputs);
  std::vector<SurfaceUpdate> changes;
  changes.reserve(changes_.size());
  for (const auto& [block, update] : changes_) changes.push_back(update);
  changes_.clear();
  return changes;
}

void ShownBone::catch_up(const SessionSetup& setup, std::span<const ToolInput> inputs) {
  if (live_) show(setup, inputs);
  if (cutter_) drilled(setup, inputs);
}

void ShownBone::begin_hole(const SessionSetup& setup) {
  cut_ = shown_ = 0;
  if (cutter_) cutter_->take_bit(setup.path.bit, setup.options.max_jump_mm);
  if (!live_) return;
  live_->end_hole();
  live_->take_bit(setup.path.bit, setup.options.max_jump_mm);
  live_holes_.push_back({live_->holes_to_undo()});
}

void ShownBone::undo(const SessionSetup& setup, bool has_inputs) {
  if (live_) undo_in_mesh(setup, has_inputs);
  cutter_.reset();
  cut_ = shown_ = 0;
}

void ShownBone::undo_in_mesh(const SessionSetup& setup, bool has_inputs) {
  if (!has_inputs) live_holes_.pop_back();
  live_->end_hole();
  // A hole from before the mesh, or one that it no longer keeps: the mesh is made anew when next asked for.
  const std::size_t has = live_->holes_to_undo();
  if (live_holes_.empty() || has != live_holes_.back().before + (live_holes_.back().changes_bone ? 1 : 0)) {
    live_.reset();
    return;
  }
  if (live_holes_.back().changes_bone) {
    live_->undo_hole();
    for (const SurfaceUpdate& update : live_->updates()) change(update);
    live_holes_.back().changes_bone = false;
  }
  live_->take_bit(setup.path.bit, setup.options.max_jump_mm);
}

}  // namespace spinaltap
