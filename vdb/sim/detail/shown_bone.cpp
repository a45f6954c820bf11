#include "vdb/sim/detail/shown_bone.h"

namespace spinaltap {
namespace {

/// At a time, which bounds what readers need besides.
constexpr std::size_t kPosesARead = 65'536;

/// Gives a reader's moves to what takes them: `take_tool` where the tool is another, then `take`.
template <class TakeTool, class Take>
void read_moves(MotionLog& motion, std::size_t reader, std::optional<std::size_t>& tool, const TakeTool& take_tool,
                const Take& take) {
  for (;;) {
    const MotionLog::Run run = motion.read(reader, kPosesARead);
    if (run.moves.empty()) return;
    if (tool != run.tool) take_tool(motion.tools()[run.tool]);
    tool = run.tool;
    take(run.moves);
  }
}

}  // namespace

HoleCutter& ShownBone::cutter(const SessionSetup& setup) {
  if (!cutter_) {
    cutter_.emplace(bone_.model());
    for (const DrilledHole& hole : setup.holes) cutter_->add(hole);
  }
  return *cutter_;
}

HoleCutter& ShownBone::drilled(const SessionSetup& setup, MotionLog& motion) {
  HoleCutter& holes = cutter(setup);
  read_moves(
      motion, cutter_reader_, cut_tool_, [&](const DrillBit& tool) { holes.take_bit(tool, setup.options.max_jump_mm); },
      [&](std::span<const ToolMove> moves) { holes.add(moves); });
  return holes;
}

void ShownBone::change(const SurfaceUpdate& update) {
  if (update.surface) {
    blocks_.insert(update.block);
  } else {
    blocks_.erase(update.block);
  }
  changes_[update.block] = update;
}

void ShownBone::show(const SessionSetup& setup, MotionLog& motion) {
  if (!live_) {
    // Holes that the cutter has cut, or will need, are cut once.
    const BoneModel begun = setup.holes.empty() ? bone_.model()
                            : !cut_tool_        ? cutter(setup).bone()
                                                : without_holes(bone_.model(), setup.holes);
    live_ = std::make_unique<LiveMesh>(begun, RemainingBoneOptions{});
    live_holes_ = {{live_->holes_to_undo()}};
    for (const std::array<int, 3>& gone : std::set(blocks_)) change({gone, nullptr});
    for (const auto& block : live_->surface().blocks()) change({block->block, block});
  }
  read_moves(
      motion, mesh_reader_, shown_tool_,
      [&](const DrillBit& tool) { live_->take_bit(tool, setup.options.max_jump_mm); },
      [&](std::span<const ToolMove> moves) {
        live_->update(moves);
        for (const SurfaceUpdate& update : live_->updates()) change(update);
        if (!live_->updates().empty()) live_holes_.back().changes_bone = true;
      });
}

std::vector<SurfaceUpdate> ShownBone::surface_changes(const SessionSetup& setup, MotionLog& motion) {
  show(setup, motion);
  std::vector<SurfaceUpdate> changes;
  changes.reserve(changes_.size());
  for (const auto& [block, update] : changes_) changes.push_back(update);
  changes_.clear();
  return changes;
}

void ShownBone::catch_up(const SessionSetup& setup, MotionLog& motion) {
  if (live_) show(setup, motion);
  if (cutter_) drilled(setup, motion);
}

void ShownBone::begin_hole() {
  cut_tool_.reset();
  shown_tool_.reset();
  if (!live_) return;
  live_->end_hole();
  live_holes_.push_back({live_->holes_to_undo()});
}

void ShownBone::undo(bool has_cycles) {
  if (live_) undo_in_mesh(has_cycles);
  cutter_.reset();
  cut_tool_.reset();
  shown_tool_.reset();
}

void ShownBone::undo_in_mesh(bool has_cycles) {
  if (!has_cycles) live_holes_.pop_back();
  live_->end_hole();
  // A hole from before the mesh, or one that it no longer keeps: the mesh is made anew when next asked for.
  const std::size_t has = live_->holes_to_undo();
  if (live_holes_.empty() || has != live_holes_.back().before + (live_holes_.back().changes_bone ? 1 : 0)) {
    live_.reset();
    return;
  }
  if (!live_holes_.back().changes_bone) return;
  live_->undo_hole();
  for (const SurfaceUpdate& update : live_->updates()) change(update);
  live_holes_.back().changes_bone = false;
}

}  // namespace spinaltap
