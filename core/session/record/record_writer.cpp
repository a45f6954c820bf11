// RecordWriter: two threads and what goes between them. The session's thread fills ring buffers; the writing thread
// empties them into chunks, and every quarter of a second, when a chunk is full or its oldest row gets old, hands the
// file to the operating system and then says in it how much there is for sure.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/session/record/detail/event_handover.h"
#include "core/session/record/detail/frame_tables.h"
#include "core/session/record/detail/record_layout.h"
#include "core/session/record/session_record.h"

namespace spinaltap {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kLook = std::chrono::milliseconds(20);     ///< how often the writing thread looks into the buffers
constexpr auto kFlush = std::chrono::milliseconds(250);   ///< flushes are at least so far apart
constexpr auto kOldest = std::chrono::milliseconds(400);  ///< rows wait for their chunk to fill no longer

Hdf5File new_file(const std::filesystem::path& path, bool may_replace) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::symlink_status(path, error);
  if (std::filesystem::exists(status)) {
    if (!may_replace) fail("expected a new name for the record, found ", path.string(), " there already");
    if (!std::filesystem::is_regular_file(std::filesystem::status(path, error))) {
      fail("expected a file to replace by the record, found ", path.string());
    }
    // Not written over: somebody may be reading it.
    if (!std::filesystem::remove(path, error))
      fail_as(ErrorKind::disk, "cannot replace ", path.string(), ": ", error.message());
  } else if (path.has_parent_path()) {
    std::filesystem::create_directories(path.parent_path(), error);  // what goes wrong, making the file tells
  }
  return Hdf5File::create(path);
}

/// Removes a file that could not be made whole, so that none is left that is no record.
class UnfinishedFile {
 public:
  explicit UnfinishedFile(std::filesystem::path path) : path_(std::move(path)) {}
  ~UnfinishedFile() {
    std::error_code ignored;
    if (!is_made_) std::filesystem::remove(path_, ignored);
  }
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;
  void is_made() { is_made_ = true; }

 private:
  std::filesystem::path path_;
  bool is_made_ = false;
};

}  // namespace

struct RecordWriter::State {
  State(const std::filesystem::path& path, const std::map<std::string, std::string>& setup, bool may_replace,
        const std::optional<FrameFormat>& format, RecordParts parts);

  /// The writing thread's life.
  void run();
  /// Empties the buffers and writes what is due; all of it where it `ends`.
  void write(bool ends);
  void take_events();
  void write_events();
  void write_frames();
  void write_tools();
  void say_progress(bool is_whole);

  std::filesystem::path path;
  Hdf5File file;
  UnfinishedFile unfinished;
  RowTables<RecordedCycle> cycles;
  RowTables<SessionEvent> events;
  std::optional<FrameTables> frames;
  ToolTables tools;
  Hdf5Table progress;

  RingBuffer<RecordedCycle> line{kRoom};
  EventHandover handover;
  std::atomic<std::uint64_t> rejected{0};  ///< cycles that found no room
  std::atomic<std::uint64_t> cycles_sure{0};
  std::atomic<bool> has_failed{false};

  // Of the writing thread.
  std::vector<SessionEvent> event_rows;
  std::vector<std::size_t> row_of_slot;  ///< one more than the row; 0: none
  std::size_t first_changed_event = 0;
  std::size_t written_events = 0;
  std::uint64_t written_tools = 0;
  Clock::time_point oldest_wait, last_flush = Clock::now();
  bool has_unflushed = false;

  mutable std::mutex mutex;  ///< of what follows; the session's thread never takes it
  std::condition_variable wakes;
  bool ends = false;
  std::string trouble;
  std::deque<RecordedFrame> waiting_frames;
  std::vector<RecordedTool> waiting_tools;
  bool is_closed = false;
  std::thread thread;
};

RecordWriter::State::State(const std::filesystem::path& where, const std::map<std::string, std::string>& setup,
                           bool may_replace, const std::optional<FrameFormat>& format, RecordParts parts)
    : path(where),
      file(new_file(where, may_replace)),
      unfinished(where),
      cycles(file, "/cycles", cycle_columns(parts), kCycleChunk, true),
      events(file, "/events", event_columns(), kEventChunk, false),
      frames(format ? std::optional(FrameTables::make(file, *format)) : std::nullopt),
      tools(ToolTables::make(file)),
      progress(file.make_row("/progress", Hdf5Number::u64, RecordProgress::kNumbers)) {
  file.write_text("/", "format", kRecordFormat);
  file.write_text("/", "version", kRecordVersion);
  file.make_group("/setup");
  for (const auto& [name, text] : setup) file.write_text("/setup", name, text);
  file.let_others_read();
  say_progress(false);
  unfinished.is_made();
}

void RecordWriter::State::say_progress(bool is_whole) {
  file.flush();
  const RecordProgress now{cycles.written(), written_events, rejected.load(), is_whole ? 1U : 0U, written_tools};
  progress.write(0, 1, now.numbers().data());
  if (frames) frames->say_progress();
  file.flush();
  cycles_sure = cycles.written();
  last_flush = Clock::now();
  has_unflushed = false;
}

void RecordWriter::State::take_events() {
  handover.take([this](const EventHandover::Update& update) {
    if (row_of_slot.size() <= update.slot) row_of_slot.resize(update.slot + 1, 0);
    std::size_t& row = row_of_slot[update.slot];
    if (row == 0) {
      event_rows.push_back(update.event);
      row = event_rows.size();
    } else {
      event_rows[row - 1] = update.event;
    }
    first_changed_event = std::min(first_changed_event, row - 1);
  });
}

void RecordWriter::State::write_events() {
  if (first_changed_event >= event_rows.size()) return;
  events.go_back_to(first_changed_event);
  for (std::size_t n = first_changed_event; n < event_rows.size(); ++n) events.add(event_rows[n]);
  events.write(events.waiting());
  written_events = first_changed_event = event_rows.size();
  has_unflushed = true;
}

void RecordWriter::State::write_frames() {
  while (frames) {
    RecordedFrame frame;
    {
      const std::lock_guard lock(mutex);
      if (waiting_frames.empty()) return;
      frame = std::move(waiting_frames.front());
      waiting_frames.pop_front();
    }
    frames->write(frame);
    has_unflushed = true;
  }
}

void RecordWriter::State::write_tools() {
  std::vector<RecordedTool> taken;
  {
    const std::lock_guard lock(mutex);
    taken.swap(waiting_tools);
  }
  for (const RecordedTool& tool : taken) tools.write(written_tools++, tool);
  if (!taken.empty()) has_unflushed = true;
}

void RecordWriter::State::write(bool all) {
  constexpr std::size_t kBatch = 4 * kCycleChunk;
  take_events();
  write_frames();
  std::size_t taken = 0;
  do {
    if (cycles.waiting() == 0) oldest_wait = Clock::now();
    taken = line.pop(kBatch, [this](const RecordedCycle& row) { cycles.add(row); });
    write_tools();  // those of the cycles that were taken are there by now
    const bool is_old = cycles.waiting() > 0 && Clock::now() - oldest_wait > kOldest;
    const std::uint64_t rows = all || is_old ? cycles.waiting() : cycles.whole_chunks();
    if (rows > 0) {
      cycles.write(rows);
      has_unflushed = true;
      oldest_wait = Clock::now();
    }
    const bool is_due = all || Clock::now() - last_flush > kFlush;
    if (is_due) write_events();
    if (is_due && has_unflushed) say_progress(false);
  } while (taken == kBatch);
}

void RecordWriter::State::run() {
  bool is_last = false;
  while (!is_last) {
    {
      std::unique_lock lock(mutex);
      is_last = wakes.wait_for(lock, kLook, [this] { return ends; });
    }
    try {
      write(is_last);
    } catch (const std::exception& error) {
      const std::lock_guard lock(mutex);
      trouble = error.what();
      has_failed = true;
      return;
    }
  }
}

RecordWriter::RecordWriter(const std::filesystem::path& path, const std::map<std::string, std::string>& setup,
                           bool may_replace, const std::optional<FrameFormat>& frames, RecordParts parts)
    : state_(std::make_unique<State>(path, setup, may_replace, frames, parts)) {
  state_->thread = std::thread([state = state_.get()] { state->run(); });
}

RecordWriter::~RecordWriter() {
  try {
    close({});
  } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): without a word
  }
}

bool RecordWriter::add(const Cycle& cycle) noexcept {
  if (!state_->has_failed.load(std::memory_order_relaxed) && state_->line.push(recorded(cycle))) {
    state_->handover.end_loss();
    return true;
  }
  state_->rejected.fetch_add(1, std::memory_order_relaxed);
  state_->handover.lose(cycle);
  return false;
}

bool RecordWriter::add_waiting(const Cycle& cycle) {
  const RecordedCycle row = recorded(cycle);
  while (!state_->has_failed) {
    if (state_->line.push(row)) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return add(cycle);
}

void RecordWriter::add_events(std::span<const SessionEvent> events) noexcept { state_->handover.hand_over(events); }

void RecordWriter::add_tool(RecordedTool tool) {
  if (tool.tool.size() > RecordedTool::kMaxBytes) {
    fail("record: expected a tool of at most ", RecordedTool::kMaxBytes, " bytes, found one of ", tool.tool.size());
  }
  const std::lock_guard lock(state_->mutex);
  state_->waiting_tools.push_back(std::move(tool));
}

bool RecordWriter::add_frame(RecordedFrame frame) {
  State& state = *state_;
  const View& view = frame.view;
  if (!state.frames) fail("expected a record that takes frames, found none in ", state.path.string());
  const FrameFormat& format = state.frames->format();
  const std::size_t pixels = view.pixel(0, view.camera.height);
  if (view.camera.width != format.width || view.camera.height != format.height || view.depth_mm.size() != pixels ||
      view.mask.size() != pixels || (format.has_normals && view.normals.size() != 3 * pixels)) {
    fail("expected frames of ", format.width, " x ", format.height, " pixels in ", state.path.string(), ", found ",
         view.camera.width, " x ", view.camera.height);
  }
  check_camera(view.camera);
  while (!state.has_failed) {
    {
      const std::lock_guard lock(state.mutex);
      if (state.waiting_frames.size() < kFrameRoom) {
        state.waiting_frames.push_back(std::move(frame));
        return true;
      }
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

std::uint64_t RecordWriter::lost() const noexcept {
  const std::uint64_t rejected = state_->rejected;
  return state_->has_failed ? rejected + state_->line.pushed() - state_->cycles_sure : rejected;
}

std::string RecordWriter::trouble() const {
  const std::lock_guard lock(state_->mutex);
  return state_->trouble;
}

void RecordWriter::close(std::span<const SessionEvent> events) {
  State& state = *state_;
  if (state.is_closed) return;
  state.is_closed = true;
  const auto wait_for = [&](const auto& is_done) {
    while (!state.has_failed && !is_done()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  wait_for([&] { return state.handover.hand_over(events, true); });
  wait_for([&] { return state.handover.end_loss(); });
  {
    const std::lock_guard lock(state.mutex);
    state.ends = true;
  }
  state.wakes.notify_one();
  state.thread.join();
  if (!state.has_failed) {
    try {
      state.say_progress(true);
      state.file.close();
      sync_to_disk(state.path);
      return;
    } catch (const std::exception& error) {
      const std::lock_guard lock(state.mutex);
      state.trouble = error.what();
      state.has_failed = true;
    }
  }
  fail("the record ", state.path.string(), " ends early, ", lost(), " cycles are not in it: ", trouble());
}

}  // namespace spinaltap
