#include "vdb/sim/session.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>

#include "core/base/error.h"
#include "core/base/text_writer.h"
#include "core/files/recorded_setup.h"
#include "core/session/choose_engine.h"
#include "core/session/cutting_motion.h"
#include "core/session/operator/motion_log.h"
#include "vdb/picture/view.h"
#include "vdb/sim/build_session.h"
#include "vdb/sim/detail/shown_bone.h"

namespace spinaltap {

struct Session::State {
  State(std::vector<Bone> its_bones, const SessionSetup& its_setup, const Progress& progress,
        const ClearanceField* clearances = nullptr)
      : bones(std::move(its_bones)),
        setup(its_setup),
        built(build_session(bones, setup, progress, nullptr, clearances)),
        motion(ShownBone::kReaders * bones.size()),
        tool(setup.path.bit),
        occupied(built.bone.occupancy_words()) {
    for (const Bone& bone : bones) shown.emplace_back(bone, ShownBone::kReaders * shown.size());
    begin_motion();
  }

  std::vector<Bone> bones;
  std::vector<ShownBone> shown;  ///< one each
  SessionSetup setup;            ///< its holes: those that are done
  BuiltSession built;
  MotionLog motion;                     ///< of this hole
  std::size_t cycles = 0;               ///< likewise
  DrillBit tool;                        ///< in use; the hole's first is setup.path.bit
  std::optional<Pose> at;               ///< the tool is, in this hole; nothing before the first sound pose
  std::vector<std::uint64_t> occupied;  ///< DrilledBone::occupancy_words() when this hole began
  struct TakenWord {
    std::size_t place;  ///< in `occupied`
    std::uint64_t was;
  };
  /// By each hole of this session: the last of the setup's.
  struct Taken {
    std::vector<TakenWord> words;
    std::size_t holes;  ///< of the setup: one for each tool
  };
  std::vector<Taken> taken;
  std::unique_ptr<RecordWriter> record;
  bool record_waits = true;
  std::uint64_t record_lost = 0;  ///< of the last record that ended

  void begin_motion() {
    motion.begin(tool, setup.options.max_jump_mm);
    cycles = 0;
    at.reset();
  }
  DrillPath path_with(const DrillBit& bit) const {
    SessionSetup with = setup;
    with.path.bit = bit;
    return setup.options.has_path ? with.path : line_without_path(bones, with);
  }
  /// Those of a hole that begins with another tool than the last one did, as a record of it is replayed: the entry
  /// opening follows from the tool, and how far aside distances are known from a plate. Null: the same.
  std::unique_ptr<ClearanceField> clearances_from(const DrillBit& before) const {
    const DrillBit& now = setup.path.bit;
    if (!built.clearances || !setup.options.has_path || now == before) return nullptr;
    if (!now.is_plate() && !before.is_plate()) {
      return std::make_unique<ClearanceField>(built.clearances->with_entry_of(setup.path));
    }
    std::vector<const WallDistance*> walls;
    for (const Bone& bone : bones) walls.push_back(&bone.walls());
    return std::make_unique<ClearanceField>(walls, setup.path, Progress());
  }
  /// Begins again at cycle 0, in the bone that `put_back` leaves. Where that is none, nothing has changed.
  void begin_again(const std::function<void(DrilledBone&)>& put_back) {
    const std::vector<std::uint64_t> now = built.bone.occupancy_words();
    const DrillPath before = setup.path;
    try {
      put_back(built.bone);
      setup.path = path_with(tool);
      std::unique_ptr<ClearanceField> clearances = clearances_from(before.bit);
      built.session = built.bone.begin_session(setup, clearances ? clearances.get() : built.clearances.get());
      if (clearances) built.clearances = std::move(clearances);
    } catch (...) {
      setup.path = before;
      built.bone.set_occupancy_words(now);
      throw;
    }
    begin_motion();
  }
  void end_hole() {
    std::vector<DrilledHole> holes = motion.holes();
    // As they are drilled where a record of the next hole is replayed.
    begin_again([&](DrilledBone& drilled_bone) {
      drilled_bone.set_occupancy_words(occupied);
      for (const DrilledHole& hole : holes) drilled_bone.drill(hole, setup);
    });
    std::vector<std::uint64_t> left = built.bone.occupancy_words();
    Taken& by_this = taken.emplace_back(Taken{{}, holes.size()});
    for (std::size_t n = 0; n < left.size(); ++n) {
      if (left[n] != occupied[n]) by_this.words.push_back({n, occupied[n]});
    }
    occupied = std::move(left);
    std::ranges::move(holes, std::back_inserter(setup.holes));
  }
  /// What this hole was drilled so far, or the last one that is done.
  void take_back() {
    if (cycles > 0) {
      begin_again([&](DrilledBone& drilled_bone) { drilled_bone.set_occupancy_words(occupied); });
      return;
    }
    if (taken.empty()) {
      SessionSetup before = setup;
      before.holes.pop_back();
      before.path = path_with(tool);
      BuiltSession fresh = build_session(bones, before, {}, nullptr, built.clearances.get());
      built.session.reset();  // it holds on to the bone
      built = std::move(fresh);
      setup = std::move(before);
      occupied = built.bone.occupancy_words();
      begin_motion();
    } else {
      for (const TakenWord& word : taken.back().words) occupied[word.place] = word.was;
      setup.holes.resize(setup.holes.size() - taken.back().holes);
      taken.pop_back();
      begin_again([&](DrilledBone& drilled_bone) { drilled_bone.set_occupancy_words(occupied); });
    }
  }
  void set_tool(const DrillBit& bit) {
    if (record && bit.is_plate() && !record_parts(setup.path.bit, setup.options).has_sides) {
      fail("expected no plate in a record that was begun with a tool that turns: it has no room for a plate's sides");
    }
    if (cycles == 0 && !record) {
      // The hole begins with this tool.
      const DrillBit before = std::exchange(tool, bit);
      try {
        check_bit(bit);
        begin_again([](DrilledBone&) {});
      } catch (...) {
        tool = before;
        throw;
      }
      return;
    }
    built.set_tool(setup, bit);
    motion.take_tool(bit);
    tool = bit;
    if (!record) return;
    record->add_tool({cycles == 0 ? 0 : built.session->last().index + 1, record_tool(bit)});
    record->add_events(built.session->events());
  }
  void note(const Cycle& cycle) {
    const ToolMove move = cutting_move(cycle, setup.options);
    ++cycles;
    if (const std::optional<Pose> pose = valid_pose(move.pose, tool)) at = pose;
    motion.add(move);
    if (!record) return;
    if (record_waits) {
      record->add_waiting(cycle);
    } else {
      record->add(cycle);
    }
    record->add_events(built.session->events());
  }
};

namespace {

/// What `other`, of the same camera, sees nearer than `view` does.
void take_nearer(const View& other, View& view) {
  for (std::size_t n = 0; n < view.mask.size(); ++n) {
    const bool is_nearer = other.mask[n] != 0 && (view.mask[n] == 0 || other.depth_mm[n] < view.depth_mm[n]);
    if (!is_nearer) continue;
    view.mask[n] = other.mask[n];
    view.depth_mm[n] = other.depth_mm[n];
    std::copy_n(other.normals.begin() + static_cast<std::ptrdiff_t>(3 * n), 3,
                view.normals.begin() + static_cast<std::ptrdiff_t>(3 * n));
  }
}

SessionSetup complete(std::span<const Bone> bones, const DrillPath& path, SessionSetup setup) {
  name_bones(setup, bones);
  setup.path = path;
  setup.engine = chosen_engine(setup);
  if (setup.options.has_device && setup.engine != EngineKind::voxel) {
    fail("a device: expected the engine voxel, found ", name_of(setup.engine),
         ", whose points fill a cylinder along the path, which a hand leaves");
  }
  return setup;
}

/// Whether one session may take over the other's distances to walls: of the same bones, along the same path; those of a
/// plate are of its own size.
bool shares_walls(const SessionSetup& one, const SessionSetup& other) {
  const DrillPath &a = one.path, &b = other.path;
  const bool has_plate = a.bit.is_plate() || b.bit.is_plate();
  return one.bone_hash == other.bone_hash && one.further_bone_hashes == other.further_bone_hashes &&
         one.options.has_path && other.options.has_path && a.entry_mm == b.entry_mm && a.target_mm == b.target_mm &&
         a.via_mm == b.via_mm && (!has_plate || a.bit == b.bit);
}

SessionSetup without_path(std::span<const Bone> bones, SessionSetup setup) {
  if (bones.empty()) fail("expected a bone to drill, found none");
  setup.options.has_path = setup.options.follows_path = false;
  return complete(bones, line_without_path(bones, setup), setup);
}

}  // namespace

Session::Session(Bone bone, const DrillPath& path, const SessionSetup& setup, const Progress& progress,
                 const Session* alike) {
  std::vector bones{std::move(bone)};
  const SessionSetup whole = complete(bones, path, setup);
  const bool has_same = alike != nullptr && shares_walls(whole, alike->setup());
  state_ = std::make_unique<State>(std::move(bones), whole, progress,
                                   has_same ? alike->state_->built.clearances.get() : nullptr);
}
Session::Session(std::vector<Bone> bones, const DrillPath& path, const SessionSetup& setup, const Progress& progress) {
  const SessionSetup whole = complete(bones, path, setup);
  state_ = std::make_unique<State>(std::move(bones), whole, progress);
}
Session::Session(std::vector<Bone> bones, const SessionSetup& setup, const Progress& progress) {
  const SessionSetup whole = without_path(bones, setup);
  state_ = std::make_unique<State>(std::move(bones), whole, progress);
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

CycleObserver Session::noting(const CycleObserver& observe) {
  return [this, &observe](const Cycle& cycle) {
    state_->note(cycle);
    if (observe) observe(cycle);
  };
}

void Session::run(Operator& tool, const CycleObserver& observe, const Progress& progress) {
  run_session(*state_->built.session, tool, noting(observe), progress);
}

RealTimeReport Session::run_real_time(Operator& tool, const RealTimeOptions& pace, const CycleObserver& observe,
                                      const DisplayTask& display, const ForceTask& output, const Progress& progress) {
  return spinaltap::run_real_time(*state_->built.session, tool, pace, noting(observe), display, output, progress);
}

void Session::set_tool(const DrillBit& bit) { state_->set_tool(bit); }
const DrillBit& Session::tool() const { return state_->tool; }

const Cycle& Session::last() const { return state_->built.session->last(); }
ToolFeedback Session::feedback() const { return state_->built.session->feedback(); }
std::span<const SessionEvent> Session::events() const { return state_->built.session->events(); }
bool Session::is_stopped() const { return state_->built.session->is_stopped(); }

void Session::record(const std::filesystem::path& file, const RecordOptions& options) {
  if (state_->cycles > 0) fail("expected a record from the first cycle on, found ", state_->cycles, " done");
  std::map<std::string, std::string> words = record_setup(state_->setup);
  words.insert(options.words.begin(), options.words.end());
  state_->record = std::make_unique<RecordWriter>(file, words, options.may_replace, options.frames,
                                                  record_parts(state_->setup.path.bit, state_->setup.options));
  state_->record_waits = options.waits;
}

void Session::end_record() {
  if (!state_->record) return;
  const std::unique_ptr<RecordWriter> record = std::move(state_->record);
  try {
    record->close(state_->built.session->events());
  } catch (...) {
    state_->record_lost = record->lost();
    throw;
  }
  state_->record_lost = record->lost();
}

std::uint64_t Session::record_lost() const { return state_->record ? state_->record->lost() : state_->record_lost; }

void Session::end_hole() {
  end_record();
  State& state = *state_;
  if (state.cycles == 0) return;
  for (ShownBone& bone : state.shown) bone.catch_up(state.setup, state.motion);
  state.end_hole();
  for (ShownBone& bone : state.shown) bone.begin_hole();
}

bool Session::undo() {
  State& state = *state_;
  if (state.record) fail("expected no record while drilling is taken back; end it first");
  if (state.cycles == 0 && state.setup.holes.empty()) return false;
  for (ShownBone& bone : state.shown) bone.undo(state.cycles > 0);
  state.take_back();
  return true;
}

double Session::motion_off_mm() const { return state_->motion.max_off_mm(); }

View Session::view(const Camera& camera) {
  State& state = *state_;
  std::optional<RenderedBit> bit;
  if (state.at) bit = RenderedBit{state.tool, *state.at};
  std::optional<View> seen;
  for (ShownBone& bone : state.shown) {
    View one = view_bone(bone.drilled(state.setup, state.motion).hole(), camera, bit);
    if (!seen) {
      seen = std::move(one);
    } else {
      take_nearer(one, *seen);
    }
  }
  return *seen;
}

View Session::record_view(const Camera& camera) {
  if (!state_->record) fail("expected a record to put a view into; begin one first");
  if (state_->cycles == 0) fail("expected a view after the first cycle, found none done");
  View seen = view(camera);
  state_->record->add_frame({last().index, last().time_s, seen});
  return seen;
}

std::vector<SurfaceUpdate> Session::surface_changes(std::size_t bone) {
  State& state = *state_;
  if (bone >= state.shown.size()) fail("expected a bone below ", state.shown.size(), ", found ", bone);
  return state.shown[bone].surface_changes(state.setup, state.motion);
}

Bone Session::drilled() { return Bone(state_->shown.front().drilled(state_->setup, state_->motion).bone()); }

std::vector<Bone> Session::drilled_bones() {
  std::vector<Bone> drilled;
  for (ShownBone& bone : state_->shown) drilled.emplace_back(bone.drilled(state_->setup, state_->motion).bone());
  return drilled;
}

const Bone& Session::bone() const { return state_->bones.front(); }
std::span<const Bone> Session::bones() const { return state_->bones; }
const VoxelBone* Session::voxels() const { return state_->built.bone.voxels.get(); }
const DrillPath& Session::path() const { return state_->setup.path; }
std::string Session::chosen() const {
  const SessionSetup& setup = state_->setup;
  const double spacing_mm = setup.volume.spacing_mm;
  if (setup.engine != EngineKind::voxel) {
    return joined("points ", spacing_mm, " mm apart within ", setup.volume.radius_mm, " mm of the path, engine ",
                  name_of(setup.engine));
  }
  const std::string_view why = why_voxels(setup);
  return joined("voxels of ", spacing_mm, " mm of ", setup.region_mm ? "a region" : "the whole bone",
                why.empty() ? ", as asked" : ", for ", why);
}
const SessionSetup& Session::setup() const { return state_->setup; }

}  // namespace spinaltap
