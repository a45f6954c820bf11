#include "vdb/sim/replay.h"

#include <algorithm>
#include <vector>

#include "core/base/error.h"
#include "core/base/text_writer.h"
#include "core/files/recorded_setup.h"
#include "core/session/real_time/timing.h"
#include "vdb/sim/build_session.h"
#include "vdb/sim/recorded_hole.h"

namespace spinaltap {
namespace {

std::string said(const SessionEvent& event) {
  TextWriter text(17);
  text << name_of(event.kind) << " at cycle " << event.cycle << ", " << event.time_s << " s, depth " << event.depth_mm
       << " mm, place " << event.place_mm.x() << ' ' << event.place_mm.y() << ' ' << event.place_mm.z() << " mm, value "
       << event.value;
  return text.str();
}

/// `is_final`: the session had ended when the event was written.
bool same_event(const SessionEvent& recorded, const SessionEvent& now, bool is_final) {
  const bool same_begin = recorded.kind == now.kind && recorded.cycle == now.cycle;
  return is_final ? same_begin && said(recorded) == said(now) : same_begin;
}

/// The events of the cycles that were compared, in order.
void compare_events(const SessionRecord& record, std::span<const SessionEvent> now, std::uint64_t end_cycle,
                    Replay& replay) {
  std::vector<SessionEvent> recorded = record.events;
  std::erase_if(recorded, [&](const SessionEvent& event) {
    // What the writer and the operator say of themselves is not the session's.
    return event.kind == EventKind::record_lost || event.kind == EventKind::gave_up || event.cycle >= end_cycle;
  });
  if (record.is_whole && recorded.size() != now.size()) {
    replay.difference =
        "events: " + std::to_string(recorded.size()) + " recorded, " + std::to_string(now.size()) + " now";
  }
  for (std::size_t n = 0; n < recorded.size() && replay.difference.empty(); ++n) {
    if (n >= now.size()) {
      replay.difference = "event " + std::to_string(n) + ": " + said(recorded[n]) + " recorded, none now";
    } else if (!same_event(recorded[n], now[n], record.is_whole)) {
      replay.difference =
          "event " + std::to_string(n) + ": " + said(recorded[n]) + " recorded, " + said(now[n]) + " now";
    } else {
      ++replay.events;
    }
  }
}

/// Moves the tool as a record has it, up to the first cycle that is not in it.
class RecordOperator final : public Operator {
 public:
  RecordOperator(const SessionRecord& record, const ToolChanger& change_tool)
      : record_(record),
        change_tool_(change_tool),
        next_tool_(record.tools.begin()),
        next_cycle_(record.cycles.empty() ? 0 : record.cycles.front().cycle) {}

  std::optional<ToolInput> next(const ToolFeedback& /*feedback*/) override {
    if (given_ == record_.cycles.size() || is_stopped_) return std::nullopt;
    const RecordedCycle& next = record_.cycles[given_];
    if (next.cycle != next_cycle_) {
      gap_ = "cycles from " + std::to_string(next_cycle_) + " to " + std::to_string(next.cycle) +
             " are not in the record; those before were compared";
      return std::nullopt;
    }
    for (; next_tool_ != record_.tools.end() && next_tool_->cycle <= next.cycle; ++next_tool_)
      change_tool_(*next_tool_);
    ++given_;
    ++next_cycle_;
    return input_of(next);
  }
  std::size_t count() const override { return record_.cycles.size(); }

  /// That was given last.
  const RecordedCycle& row() const { return record_.cycles[given_ - 1]; }
  /// After the last one.
  std::uint64_t next_cycle() const { return next_cycle_; }
  /// Why it ended before the record does; empty where it did not.
  const std::string& gap() const { return gap_; }
  void stop() { is_stopped_ = true; }

 private:
  const SessionRecord& record_;
  const ToolChanger& change_tool_;
  std::vector<RecordedTool>::const_iterator next_tool_;
  std::uint64_t next_cycle_;
  std::size_t given_ = 0;
  std::string gap_;
  bool is_stopped_ = false;
};

}  // namespace

ToolInput input_of(const RecordedCycle& row) {
  ToolInput input;
  input.pose = {row.tip_mm, row.axis, row.side};
  input.spindle_on = row.spindle_on != 0;
  input.dt_s = row.dt_s;
  input.device = row.device;
  return input;
}

Replay replay_record(DrillSession& session, const SessionRecord& record, const Progress& progress,
                     const ToolChanger& change_tool) {
  if (!record.tools.empty() && !change_tool) fail("expected a record of one tool, found one that changes its tool");
  RecordOperator rows(record, change_tool);
  Replay replay;
  const Progress replaying([&](std::string_view, double fraction) { progress.report("replaying", fraction); });
  run_session(
      session, rows,
      [&](const Cycle& cycle) {
        const RecordedCycle& row = rows.row();
        const std::string difference = spinaltap::difference(row, recorded(cycle));
        if (difference.empty()) {
          ++replay.cycles;
        } else {
          replay.difference = "cycle " + std::to_string(row.cycle) + ": " + difference;
          rows.stop();
        }
      },
      replaying);
  if (!replay.difference.empty()) return replay;
  replay.gap = rows.gap();
  if (replay.gap.empty()) compare_events(record, session.events(), rows.next_cycle(), replay);
  return replay;
}

Replay replay(const std::filesystem::path& record, const Bone& bone, std::optional<EngineKind> engine,
              const Progress& progress) {
  return replay(read_record(record), record, bone, engine, progress);
}

Replay replay(const SessionRecord& record, const std::filesystem::path& file, const Bone& bone,
              std::optional<EngineKind> engine, const Progress& progress) {
  return replay(record, file, std::span(&bone, 1), engine, progress);
}

Replay replay(const SessionRecord& record, const std::filesystem::path& file, std::span<const Bone> bones,
              std::optional<EngineKind> engine, const Progress& progress, bool takes_other_ct) {
  SessionSetup setup = recorded_setup(record.setup, file);
  std::vector<std::string> hashes = setup.further_bone_hashes;
  hashes.insert(hashes.begin(), setup.bone_hash);
  if (bones.size() != hashes.size()) {
    fail("expected the ", hashes.size(), " bones that were drilled in ", file.string(), ", found ", bones.size());
  }
  for (std::size_t n = 0; n < bones.size(); ++n) {
    if (n == 0 && !takes_other_ct) check_same_bone("record " + file.string(), setup.bone, bones[n].identity());
    if (bones[n].hash() == hashes[n] || takes_other_ct) continue;
    fail("expected the bone that was drilled in ", file.string(), ", ",
         n == 0 && !setup.bone.is_empty() ? words_of(setup.bone) + ", " : std::string(), "of hash ", hashes[n],
         "; found one of hash ", bones[n].hash(), ", ", words_of(bones[n].identity()),
         ": baked otherwise, drilled since, or another bone");
  }
  setup.takes_other_ct = setup.takes_other_ct || takes_other_ct;
  if (engine && *engine != EngineKind::automatic) setup.engine = *engine;
  BuiltSession built = build_session(bones, setup, progress);
  const std::int64_t start_ns = wall_ns();
  Replay result = replay_record(*built.session, record, progress,
                                [&](const RecordedTool& tool) { built.set_tool(setup, recorded_tool(tool, file)); });
  result.seconds = 1e-9 * static_cast<double>(wall_ns() - start_ns);
  return result;
}

RecordedHole::RecordedHole(const BoneModel& bone, const SessionRecord& record, const SessionSetup& setup)
    : bone_(without_holes(bone, setup.holes)),
      record_(record),
      tools_{setup.path.bit},
      longest_jump_mm_(setup.options.max_jump_mm),
      cutter_(bone_) {
  for (const RecordedTool& tool : record.tools) tools_.push_back(recorded_tool(tool, "the record"));
  if (record.cycles.empty()) fail("the record holds no cycle: nothing was drilled yet");
  begin();
}

void RecordedHole::begin() {
  cutter_ = HoleCutter(bone_);
  cycles_ = tools_taken_ = 0;
  add_to(1);
}

void RecordedHole::add_to(std::size_t cycles) {
  std::vector<ToolInput> inputs;
  for (; cycles_ < cycles; ++cycles_) {
    const RecordedCycle& row = record_.cycles[cycles_];
    while (tools_taken_ < tools_.size() && (tools_taken_ == 0 || record_.tools[tools_taken_ - 1].cycle <= row.cycle)) {
      cutter_.add(inputs);
      inputs.clear();
      cutter_.take_bit(tools_[tools_taken_++], longest_jump_mm_);
    }
    inputs.push_back(input_of(row));
  }
  cutter_.add(inputs);
}

void RecordedHole::go_to(double time_s) {
  const auto later = std::upper_bound(record_.cycles.begin(), record_.cycles.end(), time_s,
                                      [](double time, const RecordedCycle& row) { return time < row.time_s; });
  const auto wanted = std::max<std::size_t>(1, static_cast<std::size_t>(later - record_.cycles.begin()));
  if (wanted < cycles_) begin();
  add_to(wanted);
}

Pose RecordedHole::pose() const {
  const RecordedCycle& row = record_.cycles[cycles_ - 1];
  return {row.tip_mm, row.axis, row.side};
}

}  // namespace spinaltap
