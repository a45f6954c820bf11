#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/view.h"
#include "core/session/cycle.h"
#include "core/session/operator/operator.h"

namespace spinaltap {

struct SessionOptions;

/// What a record keeps of a cycle: all that went in and all that came out. docs/record-file.md has the file's layout.
struct RecordedCycle {
  std::uint64_t cycle = 0;  ///< Cycle::index: a gap is where cycles were lost
  double time_s = 0.0;
  double dt_s = 0.0;
  Vec3 tip_mm = Vec3::Zero();  ///< patient LPS, as the operator gave it
  Vec3 axis = Vec3::UnitZ();
  std::uint8_t spindle_on = 1;
  std::uint8_t state = 0;     ///< DrillState
  std::uint32_t removed = 0;  ///< points
  std::int64_t removed_hu = 0;
  double work_n_mm = 0.0;
  Vec3 force_n = Vec3::Zero();
  double thrust_n = 0.0;
  double torque_n_mm = 0.0;
  double feed_mm_per_turn = 0.0;
  double tip_density_g_cm3 = 0.0;
  double depth_mm = 0.0;
  double outer_mm = 0.0;  ///< clearances
  double canal_mm = 0.0;
  Vec3 side = Vec3::Zero();    ///< of a plate, as the operator gave it; other tools' records leave it out
  double temperature_c = 0.0;  ///< as CycleHeat has them; 0, and left out, of a session that works out no heat
  double max_temperature_c = 0.0;
  DeviceSide device;  ///< none, and left out, of a session without one
};
/// What a record keeps of a cycle.
RecordedCycle recorded(const Cycle& cycle);
/// Bit for bit, so that a number that is none equals itself.
bool operator==(const RecordedCycle& a, const RecordedCycle& b);
/// The first quantity in which they differ, with both values: "thrust_n 3.25 and 3.5"; empty where they are equal.
std::string difference(const RecordedCycle& a, const RecordedCycle& b);

/// What the cycles of some records have and those of others do not.
struct RecordParts {
  bool has_sides = false;   ///< of a plate, and of what a device holds: RecordedCycle::side
  bool has_heat = false;    ///< RecordedCycle::temperature_c and max_temperature_c
  bool has_device = false;  ///< RecordedCycle::device
};
/// Of a session with this tool and these options.
RecordParts record_parts(const DrillBit& tool, const SessionOptions& options);

/// A tool that a session changed to.
struct RecordedTool {
  std::uint64_t cycle = 0;  ///< the first with it
  std::string tool;         ///< as record_tool() says it: at most kMaxBytes
  static constexpr std::size_t kMaxBytes = 4096;
};

/// What all frames of a record have in common.
struct FrameFormat {
  int width = 0;  ///< pixels
  int height = 0;
  bool has_normals = true;  ///< most of a frame's bytes
};

/// What a camera saw of a drilling after a cycle.
struct RecordedFrame {
  std::uint64_t cycle = 0;  ///< Cycle::index of the last cycle before it
  double time_s = 0.0;      ///< of that cycle
  View view;                ///< without normals where the record has none
};

/// Writes a session into an HDF5 file while it runs: from a thread of its own, compressed in chunks, flushed more than
/// once a second, so that others may read along and a killed run leaves all but the last second.
class RecordWriter {
 public:
  /// Cycles that wait for the writing thread, at most: 3 s at 20 kHz, a minute at 1 kHz.
  static constexpr std::size_t kRoom = 65536;

  /// Makes the file and starts the thread. `setup`: what it takes to run the session again (names and texts; the
  /// program's business), stored as attributes. Throws Error where the file cannot be made, and where there is one
  /// already, unless it `may_replace` it. `frames`: it also takes frames, all of this format.
  RecordWriter(const std::filesystem::path& path, const std::map<std::string, std::string>& setup,
               bool may_replace = false, const std::optional<FrameFormat>& frames = {}, RecordParts parts = {});
  /// Closes as close() does, without a word.
  ~RecordWriter();
  RecordWriter(const RecordWriter&) = delete;
  RecordWriter& operator=(const RecordWriter&) = delete;

  /// Operators a cycle to the writing thread: no lock, no allocation, no waiting. False where it was lost: the buffer
  /// is full (the disk is slower than the session for seconds on end) or the disk rejected.
  bool add(const Cycle& cycle) noexcept;
  /// As add(), but waits for room: for sessions that are not in real time.
  bool add_waiting(const Cycle& cycle);
  /// Hands over what is new or has changed in the session's events so far: after add(), from the same thread and under
  /// the same promises. Cycles that were lost become events of their own, EventKind::record_lost.
  void add_events(std::span<const SessionEvent> events) noexcept;

  /// Hands over a tool, before its first cycle is added. Allocates and locks: not for a thread in real time. Throws
  /// Error on a text that is too long.
  void add_tool(RecordedTool tool);

  /// Hands over what a camera saw. Allocates, and waits while kFrameRoom frames are still to be written: not for a
  /// thread in real time. False where the disk rejected. Throws Error where the record takes no frames, or of another
  /// size.
  bool add_frame(RecordedFrame frame);
  static constexpr std::size_t kFrameRoom = 8;

  /// Cycles that add() was given and that are not, or will not be, in the file.
  std::uint64_t lost() const noexcept;
  /// What the disk said when it rejected; empty while all is well. From any thread.
  std::string trouble() const;
  /// Writes what is left and the events, marks the record as whole, closes. Throws Error where that fails, or writing
  /// failed before; what was flushed until then stays readable. Not while another thread adds.
  void close(std::span<const SessionEvent> events);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A record read back.
struct SessionRecord {
  std::map<std::string, std::string> setup;
  std::vector<RecordedCycle> cycles;
  /// In the order in which they began. Of a record that was cut short: those known at its last flush.
  std::vector<SessionEvent> events;
  std::vector<RecordedTool> tools;  ///< after the setup's, in order
  bool is_whole = false;            ///< closed in order
  RecordParts parts;
  std::uint64_t lost = 0;         ///< cycles that did not get into it
  std::uint64_t frame_count = 0;  ///< of what cameras saw: read_frames()
};

/// A fingerprint of all cycles, events and changes of tools, to the last bit: of the same drilling the same, whoever
/// recorded it. Frames follow from them, and do not count. 16 hexadecimal digits.
std::string hash_of(const SessionRecord& record);

/// Also while it is being written, and after a kill. Throws Error on a file that is no record, a newer layout, or
/// damage.
SessionRecord read_record(const std::filesystem::path& path);

/// Frames `first`, `first + 1`, ... of a record, no more than `count` and no more than there are
/// (SessionRecord::frame_count). Also while it is being written, and after a kill. Throws Error as read_record() does.
std::vector<RecordedFrame> read_frames(const std::filesystem::path& path, std::uint64_t first = 0,
                                       std::uint64_t count = std::numeric_limits<std::uint64_t>::max());

/// All cycles as CSV, one row each; units are in the names of the columns. Numbers come back from it to the last bit; a
/// field of what is not a number is empty.
void write_record_csv(const SessionRecord& record, std::ostream& csv);
/// The events likewise.
void write_events_csv(const SessionRecord& record, std::ostream& csv);

}  // namespace spinaltap
