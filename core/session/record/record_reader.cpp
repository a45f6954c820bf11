#include <chrono>
#include <optional>
#include <thread>

#include "core/base/error.h"
#include "core/base/file_stream.h"
#include "core/base/staged_output.h"
#include "core/session/drill_state.h"
#include "core/session/record/detail/frame_tables.h"
#include "core/session/record/detail/record_columns.h"
#include "core/session/record/detail/record_layout.h"
#include "core/session/record/session_record.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;

// No compression does better: what claims to has no such rows.
constexpr std::uint64_t kMaxToOne = 1100;

RecordProgress read_progress(const Hdf5File& file, bool has_tools, const fs::path& path) {
  std::vector<std::uint64_t> all(has_tools ? RecordProgress::kNumbers : RecordProgress::kNumbersWithoutTools);
  file.open_table("/progress", Hdf5Number::u64, all.size()).read(0, 1, all.data());
  if (all.back() != RecordProgress::checksum(std::span(all).first(all.size() - 1))) {
    fail("cannot read ", path.string(), ": what it says of its own progress is damaged");
  }
  return {all[0], all[1], all[2], all[3], has_tools ? all[4] : 0};
}

/// The first rows of a group's tables, all of which must be there.
template <class Row>
std::vector<Row> read_rows(const Hdf5File& file, const std::string& group, std::span<const RecordColumn<Row>> columns,
                           std::uint64_t count, std::uint64_t file_bytes, const fs::path& path) {
  constexpr std::uint64_t kBatch = 65536;
  if (count > kMaxToOne * file_bytes) {
    fail("cannot read ", path.string(), ": expected ", count, " rows, found ", file_bytes, " bytes");
  }
  std::vector<Row> rows(static_cast<std::size_t>(count));
  std::vector<std::byte> batch;
  for (const RecordColumn<Row>& column : columns) {
    const Hdf5Table table = file.open_table(group + "/" + column.name, column.number, column.width);
    for (std::uint64_t first = 0; first < count; first += kBatch) {
      const std::uint64_t some = std::min(kBatch, count - first);
      batch.resize(static_cast<std::size_t>(some) * column.row_bytes);
      table.read(first, some, batch.data());
      for (std::size_t n = 0; n < some; ++n) {
        column.load(rows[static_cast<std::size_t>(first) + n], batch.data() + n * column.row_bytes);
      }
    }
  }
  return rows;
}

void check_numbers(const SessionRecord& record, const fs::path& path) {
  constexpr auto kLastStatus = static_cast<int>(DeviceStatus::lost);
  constexpr auto kLastState = static_cast<int>(DrillState::inner_cortical);
  constexpr auto kLastKind = static_cast<int>(EventKind::tool_change);
  for (const RecordedCycle& row : record.cycles) {
    if (row.state > kLastState) {
      fail("cannot read ", path.string(), ": cycle ", row.cycle, " has a state of number ", int{row.state});
    }
  }
  for (const RecordedCycle& row : record.cycles) {
    if (static_cast<int>(row.device.status) > kLastStatus) {
      fail("cannot read ", path.string(), ": cycle ", row.cycle, " has a device's status of number ",
           static_cast<int>(row.device.status));
    }
  }
  for (const SessionEvent& event : record.events) {
    if (static_cast<int>(event.kind) > kLastKind) {
      fail("cannot read ", path.string(), ": cycle ", event.cycle, " has an event of number ",
           static_cast<int>(event.kind));
    }
  }
}

struct OpenRecord {
  Hdf5File file;
  bool has_tools;
};

OpenRecord open_record(const fs::path& path) {
  Hdf5File file = Hdf5File::open(path);
  const std::map<std::string, std::string> head = file.read_texts("/");
  const auto text = [&](const char* name) {
    const auto found = head.find(name);
    return found == head.end() ? std::string() : found->second;
  };
  if (text("format") != kRecordFormat) fail("expected a record of a session, found another HDF5 file: ", path.string());
  const bool has_tools = text("version") == kRecordVersion;
  if (!has_tools && text("version") != kRecordVersionWithoutTools) {
    fail(path.string(), ": this is a version ", text("version").empty() ? "1" : text("version"), " record; version ",
         kRecordVersion, " is expected: drill again");
  }
  return {std::move(file), has_tools};
}

SessionRecord read_once(const fs::path& path) {
  const std::uint64_t bytes = regular_file_size(path);
  const auto [file, has_tools] = open_record(path);
  // Before the tables: they may grow meanwhile, and hold what this counts.
  const RecordProgress progress = read_progress(file, has_tools, path);
  SessionRecord record;
  record.setup = file.read_texts("/setup");
  record.parts = {.has_sides = file.has("/cycles/side"),
                  .has_heat = file.has("/cycles/temperature_c"),
                  .has_device = file.has("/cycles/device_status")};
  record.cycles = read_rows(file, "/cycles", cycle_columns(record.parts), progress.cycles, bytes, path);
  record.events = read_rows(file, "/events", event_columns(), progress.events, bytes, path);
  // A tool takes a row of 4 KiB, and they are few.
  constexpr std::uint64_t kMostTools = 100'000;
  if (progress.tools > kMostTools) {
    fail("cannot read ", path.string(), ": expected at most ", kMostTools, " tools, found ", progress.tools);
  }
  if (progress.tools > 0) {
    const ToolTables tools = ToolTables::open(file);
    for (std::uint64_t row = 0; row < progress.tools; ++row) record.tools.push_back(tools.read(row));
  }
  record.lost = progress.lost;
  record.is_whole = progress.is_whole != 0;
  if (const std::optional<FrameTables> frames = FrameTables::open(file, path)) record.frame_count = frames->count();
  check_numbers(record, path);
  return record;
}

std::vector<RecordedFrame> read_frames_once(const fs::path& path, std::uint64_t first, std::uint64_t count) {
  const std::uint64_t bytes = regular_file_size(path);
  const Hdf5File file = open_record(path).file;
  const std::optional<FrameTables> tables = FrameTables::open(file, path);
  const std::uint64_t there = tables ? tables->count() : 0;
  if (first >= there) return {};
  if (there * tables->frame_bytes() > kMaxToOne * bytes) {
    fail("cannot read ", path.string(), ": expected ", there, " frames, found ", bytes, " bytes");
  }
  std::vector<RecordedFrame> frames;
  for (std::uint64_t row = first; row < there && row - first < count; ++row) frames.push_back(tables->read(row, path));
  return frames;
}

/// Calls `read()`, which gives what it read.
template <class Read>
auto patiently(const fs::path& path, const Read& read) {
  // While a file is written, rows may be found half changed; then it is looked at again. A file that nobody changes is
  // rejected at once.
  constexpr int kAttempts = 5;
  for (int attempt = 1;; ++attempt) {
    std::error_code no_time;
    const fs::file_time_type before = fs::last_write_time(path, no_time);
    try {
      return read();
    } catch (const Error&) {
      std::this_thread::sleep_for(std::chrono::milliseconds(attempt < kAttempts ? 20 : 0));
      if (attempt == kAttempts || no_time || fs::last_write_time(path, no_time) == before) throw;
    }
  }
}

}  // namespace

SessionRecord read_record(const std::filesystem::path& path) {
  return patiently(path, [&] { return read_once(path); });
}

std::vector<RecordedFrame> read_frames(const std::filesystem::path& path, std::uint64_t first, std::uint64_t count) {
  return patiently(path, [&] { return read_frames_once(path, first, count); });
}

}  // namespace spinaltap
