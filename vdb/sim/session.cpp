#include "vdb/sim/session.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include "core/base/error.h"
#include "core/files/recorded_setup.h"
#include "core/session/choose_engine.h"
#include "vdb/picture/view.h"
#include "vdb/remaining/hole_cutter.h"
#include "vdb/remaining/live_mesh.h"
#include "vdb/sim/build_session.h"

namespace spinaltap {

struct Session::State {
  State(Bone its_bone, const SessionSetup& its_setup, const Progress& progress)
      : bone(std::move(its_bone)),
        setup(its_setup),
        built(build_session(bone, setup, progress)),
        living(built.bone.living_words()) {}

  Bone bone;
  SessionSetup setup;  ///< its holes: those that are done
  BuiltSession built;
  std::vector<ToolInput> inputs;      ///< of this hole
  std::vector<std::uint64_t> living;  ///< DrilledBone::living_words() when this hole began
  struct TakenWord {
    std::size_t place;  ///< in `living`
    std::uint64_t was;
  };
  std::vector<std::vector<TakenWord>> taken;  ///< by each hole of this session: the last of the setup's
  std::unique_ptr<RecordWriter> record;
  std::optional<HoleCutter> cutter;  ///< for views and files
  std::size_t cut = 0;               ///< of `inputs`, in the cutter
  std::optional<LiveMesh> live;
  std::size_t shown = 0;  ///< of `inputs`, in the live mesh
  struct LiveHole {
    std::size_t before = 0;  ///< holes that the live mesh could undo when this one began
    bool changes_bone = false;
  };
  std::vector<LiveHole> live_holes;                     ///< in the live mesh, this one last
  std::set<std::array<int, 3>> blocks;                  ///< of the surface, as handed over or waiting
  std::map<std::array<int, 3>, SurfaceUpdate> changes;  ///< that wait

  void change(const SurfaceUpdate& update) {
    if (update.surface) {
      blocks.insert(update.block);
    } else {
      blocks.erase(update.block);
    }
    changes[update.block] = update;
  }
  /// The bone without all that was drilled, up to the last cycle; each input is cut out once.
  HoleCutter& drilled() {
    if (!cutter) {
      cutter.emplace(bone.model());
      for (const DrilledHole& hole : setup.holes) cutter->add(hole);
      cutter->take_bit(setup.path.bit, setup.options.max_jump_mm);
    }
    cutter->add(std::span(inputs).subspan(cut));
    cut = inputs.size();
    return *cutter;
  }
  /// Where the bit is; nothing before the first sound pose.
  std::optional<Pose> bit_pose() const {
    for (auto input = inputs.rbegin(); input != inputs.rend(); ++input) {
      if (std::optional<Pose> pose = sound_pose(input->pose)) return pose;
    }
    return std::nullopt;
  }
  /// Brings the live mesh up to the last cycle.
  void show() {
    if (!live) {
      live.emplace(without_holes(bone.model(), setup.holes), RemainingBoneOptions{});
      live->take_bit(setup.path.bit, setup.options.max_jump_mm);
      live_holes = {{live->holes_to_undo()}};
      for (const std::array<int, 3>& gone : std::set(blocks)) change({gone, nullptr});
      for (const auto& block : live->surface().blocks()) change({block->block, block});
    }
    if (shown == inputs.size()) return;
    live->update(std::span(inputs).subspan(shown));
    shown = inputs.size();
    for (const SurfaceUpdate& update : live->updates()) change(update);
    if (!live->updates().empty()) live_holes.back().changes_bone = true;
  }
  /// Takes the last hole out of the live mesh.
  void unshow() {
    if (!live) return;
    if (inputs.empty()) live_holes.pop_back();
    live->end_hole();
    // A hole from before the mesh, or one that it no longer keeps: the mesh is made anew when next asked for.
    const std::size_t has = live->holes_to_undo();
    if (live_holes.empty() || has != live_holes.back().before + (live_holes.back().changes_bone ? 1 : 0)) {
      live.reset();
      return;
    }
    if (live_holes.back().changes_bone) {
      live->undo_hole();
      for (const SurfaceUpdate& update : live->updates()) change(update);
      live_holes.back().changes_bone = false;
    }
    live->take_bit(setup.path.bit, setup.options.max_jump_mm);
  }
  /// Begins again at cycle 0, in the bone that `put_back` leaves. Where that is none, nothing has changed.
  void begin_again(const std::function<void(DrilledBone&)>& put_back) {
    const std::vector<std::uint64_t> now = built.bone.living_words();
    try {
      put_back(built.bone);
      built.session = built.bone.begin_session(setup, built.clearances.get());
    } catch (...) {
      built.bone.set_living_words(now);
      throw;
    }
    forget_cycles();
  }
  void end_hole() {
    DrilledHole hole = hole_of(inputs, setup);
    // As it is drilled where a record of the next hole is replayed.
    begin_again([&](DrilledBone& drilled_bone) {
      drilled_bone.set_living_words(living);
      drilled_bone.drill(hole, setup);
    });
    std::vector<std::uint64_t> left = built.bone.living_words();
    std::vector<TakenWord>& words = taken.emplace_back();
    for (std::size_t n = 0; n < left.size(); ++n) {
      if (left[n] != living[n]) words.push_back({n, living[n]});
    }
    living = std::move(left);
    setup.holes.push_back(std::move(hole));
  }
  /// What this hole was drilled so far, or the last one that is done.
  void take_back() {
    if (!inputs.empty()) {
      begin_again([&](DrilledBone& drilled_bone) { drilled_bone.set_living_words(living); });
      return;
    }
    if (taken.empty()) {
      SessionSetup before = setup;
      before.holes.pop_back();
      BuiltSession fresh = build_session(bone, before, {}, nullptr, built.clearances.get());
      built.session.reset();  // it holds on to the bone
      built = std::move(fresh);
      living = built.bone.living_words();
      forget_cycles();
    } else {
      for (const TakenWord& word : taken.back()) living[word.place] = word.was;
      taken.pop_back();
      begin_again([&](DrilledBone& drilled_bone) { drilled_bone.set_living_words(living); });
    }
    setup.holes.pop_back();
  }
  void forget_cycles() {
    inputs.clear();
    shown = 0;
    cut = 0;
  }
  void note(const Cycle& cycle) {
    inputs.push_back(cutting_input(cycle, setup.options));
    if (!record) return;
    record->add_waiting(cycle);
    record->add_events(built.session->events());
  }
};

namespace {

SessionSetup complete(const Bone& bone, const DrillPath& path, SessionSetup setup) {
  setup.bone_hash = bone.hash();
  setup.path = path;
  setup.engine = chosen_engine(setup);
  return setup;
}

}  // namespace

Session::Session(Bone bone, const DrillPath& path, const SessionSetup& setup, const Progress& progress) {
  const SessionSetup whole = complete(bone, path, setup);
  state_ = std::make_unique<State>(std::move(bone), whole, progress);
}
Session::~Session() = default;
Session::Session(Session&&) noexcept = default;
Session& Session::operator=(Session&&) noexcept = default;

const Cycle& Session::step_input(const ToolInput& input) {
  const Cycle& cycle = state_->built.session->step(input);
  state_->note(cycle);
  return cycle;
}

std::vector<RecordedCycle> Session::run(std::span<const ToolInput> inputs, const Progress& progress) {
  constexpr std::size_t kCyclesAReport = 1024;
  std::vector<RecordedCycle> rows;
  rows.reserve(inputs.size());
  for (const ToolInput& input : inputs) {
    if (rows.size() % kCyclesAReport == 0) {
      progress.report("drilling", static_cast<double>(rows.size()) / static_cast<double>(inputs.size()));
    }
    rows.push_back(recorded(step_input(input)));
  }
  return rows;
}

void Session::run(Operator& tool, const CycleObserver& observe, const Progress& progress) {
  run_session(
      *state_->built.session, tool,
      [&](const Cycle& cycle) {
        state_->note(cycle);
        if (observe) observe(cycle);
      },
      progress);
}

const Cycle& Session::last() const { return state_->built.session->last(); }
std::span<const SessionEvent> Session::events() const { return state_->built.session->events(); }
bool Session::is_stopped() const { return state_->built.session->is_stopped(); }

void Session::record(const std::filesystem::path& file, const std::optional<FrameFormat>& frames) {
  if (!state_->inputs.empty())
    fail("expected a record from the first cycle on, found ", state_->inputs.size(), " done");
  state_->record = std::make_unique<RecordWriter>(file, record_setup(state_->setup), false, frames);
}

void Session::end_record() {
  if (!state_->record) return;
  const std::unique_ptr<RecordWriter> record = std::move(state_->record);
  record->close(state_->built.session->events());
}

void Session::end_hole() {
  end_record();
  State& state = *state_;
  if (state.inputs.empty()) return;
  if (state.live) state.show();
  if (state.cutter) state.drilled();
  state.end_hole();
  if (state.cutter) state.cutter->take_bit(state.setup.path.bit, state.setup.options.max_jump_mm);
  if (!state.live) return;
  state.live->end_hole();
  state.live->take_bit(state.setup.path.bit, state.setup.options.max_jump_mm);
  state.live_holes.push_back({state.live->holes_to_undo()});
}

bool Session::undo() {
  State& state = *state_;
  if (state.record) fail("expected no record while drilling is taken back; end it first");
  if (state.inputs.empty() && state.setup.holes.empty()) return false;
  state.unshow();
  state.cutter.reset();
  state.take_back();
  return true;
}

View Session::view(const Camera& camera) {
  State& state = *state_;
  std::optional<RenderedBit> bit;
  if (const std::optional<Pose> pose = state.bit_pose()) bit = RenderedBit{state.setup.path.bit, *pose};
  return view_bone(state.drilled().hole(), camera, bit);
}

View Session::record_view(const Camera& camera) {
  if (!state_->record) fail("expected a record to put a view into; begin one first");
  if (state_->inputs.empty()) fail("expected a view after the first cycle, found none done");
  View seen = view(camera);
  state_->record->add_frame({last().index, last().time_s, seen});
  return seen;
}

std::vector<SurfaceUpdate> Session::surface_changes() {
  state_->show();
  std::vector<SurfaceUpdate> changes;
  changes.reserve(state_->changes.size());
  for (const auto& [block, update] : state_->changes) changes.push_back(update);
  state_->changes.clear();
  return changes;
}

Bone Session::drilled() { return Bone(state_->drilled().bone()); }

const Bone& Session::bone() const { return state_->bone; }
const VoxelBone* Session::voxels() const { return state_->built.bone.voxels.get(); }
const DrillPath& Session::path() const { return state_->setup.path; }
const SessionSetup& Session::setup() const { return state_->setup; }

}  // namespace spinaltap
