// Records of made-up cycles: what goes in comes out, whatever happens to the disk, the buffer or the reader.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <random>
#include <sstream>
#include <thread>

#include "core/base/error.h"
#include "core/base/hdf5_file.h"
#include "core/base/staged_output.h"
#include "core/session/record/detail/record_columns.h"
#include "core/session/record/detail/record_layout.h"
#include "core/session/record/session_record.h"
#include "tests/support/error_of.h"
#include "tests/support/full_disk.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;

/// Another number in each place, whatever a double may be.
Cycle any_cycle(std::uint64_t index, std::mt19937_64& random) {
  const auto number = [&random] {
    switch (random() % 8) {
      case 0:
        return std::numeric_limits<double>::infinity();
      case 1:
        return -std::numeric_limits<double>::quiet_NaN();
      case 2:
        return -0.0;
      case 3:
        return std::numeric_limits<double>::denorm_min();
      default:
        return std::ldexp(static_cast<double>(random()), -60) - 8.0;
    }
  };
  const auto vector = [&number] { return Vec3(number(), number(), number()); };
  Cycle cycle;
  cycle.index = index;
  cycle.time_s = number();
  cycle.input.pose = {vector(), vector()};
  cycle.input.spindle_on = random() % 2 == 0;
  cycle.input.dt_s = number();
  cycle.depth_mm = number();
  cycle.step.removed = static_cast<std::uint32_t>(random());
  cycle.step.removed_hu = static_cast<std::int64_t>(random());
  cycle.step.work_n_mm = number();
  cycle.force.force_n = vector();
  cycle.force.thrust_n = number();
  cycle.force.torque_n_mm = number();
  cycle.force.feed_mm_per_turn = number();
  cycle.force.tip_density_g_cm3 = number();
  cycle.clearance.outer_mm = number();
  cycle.clearance.canal_mm = number();
  cycle.state = static_cast<DrillState>(random() % 5);
  return cycle;
}

SessionEvent event_at(std::uint64_t cycle, EventKind kind, double value) {
  return {kind, cycle, 1e-3 * static_cast<double>(cycle), 0.1, {1.0, -2.0, 3.5}, value};
}

bool same(const SessionEvent& a, const SessionEvent& b) {
  return a.kind == b.kind && a.cycle == b.cycle && a.time_s == b.time_s && a.depth_mm == b.depth_mm &&
         a.place_mm == b.place_mm && a.value == b.value;
}

/// Waits until `is_so`, for 20 s at most.
template <class Condition>
bool comes_true(const Condition& is_so) {
  for (int n = 0; n < 2000; ++n) {
    if (is_so()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

TEST(SessionRecord, GivesBackEveryBitOfWhatWasWritten) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "a.h5";
  const std::map<std::string, std::string> setup{
      {"session", "{\"a\": \"\\u00e4\xc3\xa4\"}"}, {"empty", ""}, {"long", std::string(100'000, 'x')}};
  // Neither a whole number of chunks nor of batches.
  constexpr std::uint64_t kCycles = 10'007;
  std::vector<RecordedCycle> expected;
  std::vector<SessionEvent> events;
  {
    RecordWriter writer(file, setup);
    std::mt19937_64 random(7);
    for (std::uint64_t n = 0; n < kCycles; ++n) {
      const Cycle cycle = any_cycle(n, random);
      expected.push_back(recorded(cycle));
      ASSERT_TRUE(writer.add_waiting(cycle));
      if (n % 1000 == 5) events.push_back(event_at(n, EventKind::outer_breach, 0.25));
      writer.add_events(events);
    }
    events[1].value = 2.5;  // the breach became deeper
    writer.close(events);
    EXPECT_EQ(writer.lost(), 0U);
    EXPECT_EQ(writer.trouble(), "");
  }
  const SessionRecord record = read_record(file);
  EXPECT_TRUE(record.is_whole);
  EXPECT_EQ(record.lost, 0U);
  EXPECT_EQ(record.setup, setup);
  ASSERT_EQ(record.cycles.size(), expected.size());
  for (std::size_t n = 0; n < expected.size(); ++n) {
    ASSERT_TRUE(record.cycles[n] == expected[n]) << "cycle " << n << ": " << difference(record.cycles[n], expected[n]);
  }
  ASSERT_EQ(record.events.size(), events.size());
  for (std::size_t n = 0; n < events.size(); ++n) EXPECT_TRUE(same(record.events[n], events[n])) << "event " << n;
}

TEST(SessionRecord, OfAPlateHasSidesAndOthersHaveNone) {
  const test::TemporaryFolder folder;
  std::mt19937_64 random(3);
  std::vector<Cycle> cycles;
  for (std::uint64_t n = 0; n < 1000; ++n) {
    cycles.push_back(any_cycle(n, random));
    cycles.back().input.pose.side = Vec3(std::ldexp(static_cast<double>(random()), -64), -0.0, std::nan(""));
  }
  const auto written = [&](const char* name, RecordParts parts) {
    RecordWriter writer(folder.path() / name, {}, false, {}, parts);
    for (const Cycle& cycle : cycles) writer.add_waiting(cycle);
    writer.close({});
    return read_record(folder.path() / name);
  };
  const SessionRecord plate = written("plate.h5", {.has_sides = true}), drill = written("drill.h5", {});
  EXPECT_TRUE(plate.parts.has_sides);
  EXPECT_FALSE(drill.parts.has_sides);
  ASSERT_EQ(plate.cycles.size(), cycles.size());
  ASSERT_EQ(drill.cycles.size(), cycles.size());
  for (std::size_t n = 0; n < cycles.size(); ++n) {
    EXPECT_TRUE(plate.cycles[n] == recorded(cycles[n])) << difference(plate.cycles[n], recorded(cycles[n]));
    EXPECT_EQ(drill.cycles[n].side, Vec3::Zero());
    RecordedCycle without = plate.cycles[n];
    without.side.setZero();
    EXPECT_TRUE(drill.cycles[n] == without);
  }
  EXPECT_FALSE(Hdf5File::open(folder.path() / "drill.h5").has("/cycles/side"));
  EXPECT_TRUE(Hdf5File::open(folder.path() / "plate.h5").has("/cycles/side"));
  // A fingerprint counts what the file holds.
  SessionRecord turned = plate;
  turned.cycles[5].side.x() += 0.5;
  EXPECT_NE(hash_of(turned), hash_of(plate));
  turned.parts.has_sides = false;
  EXPECT_EQ(hash_of(turned), hash_of(drill));
  EXPECT_EQ(difference(turned.cycles[5], plate.cycles[5]).substr(0, 6), "side_x");
}

TEST(SessionRecord, HasTemperaturesWhereItsSessionWorksOutHeat) {
  const test::TemporaryFolder folder;
  std::mt19937_64 random(4);
  std::vector<Cycle> cycles;
  for (std::uint64_t n = 0; n < 1000; ++n) {
    cycles.push_back(any_cycle(n, random));
    cycles.back().heat.temperature_c = 37.0 + std::ldexp(static_cast<double>(random()), -62);
    cycles.back().heat.max_temperature_c = 38.0;
  }
  const auto written = [&](const char* name, RecordParts parts) {
    RecordWriter writer(folder.path() / name, {}, false, {}, parts);
    for (const Cycle& cycle : cycles) writer.add_waiting(cycle);
    writer.close({});
    return read_record(folder.path() / name);
  };
  SessionOptions options;
  EXPECT_FALSE(record_parts({}, options).has_heat);
  options.heat.emplace();
  EXPECT_TRUE(record_parts({}, options).has_heat);
  const SessionRecord warm = written("warm.h5", record_parts({}, options)), cold = written("cold.h5", {});
  EXPECT_TRUE(warm.parts.has_heat);
  EXPECT_FALSE(cold.parts.has_heat);
  for (std::size_t n = 0; n < cycles.size(); ++n) {
    EXPECT_TRUE(warm.cycles[n] == recorded(cycles[n])) << difference(warm.cycles[n], recorded(cycles[n]));
    EXPECT_EQ(cold.cycles[n].temperature_c, 0.0);
  }
  SessionRecord other = warm;
  other.cycles[5].max_temperature_c += 0.5;
  EXPECT_NE(hash_of(other), hash_of(warm));
  EXPECT_EQ(difference(other.cycles[5], warm.cycles[5]).substr(0, 17), "max_temperature_c");
  other.parts.has_heat = false;
  EXPECT_EQ(hash_of(other), hash_of(cold));
  std::ostringstream csv;
  write_record_csv(warm, csv);
  EXPECT_THAT(csv.str(), testing::HasSubstr("clearance_canal_mm,temperature_c,max_temperature_c\n0,"));
}

TEST(SessionRecord, TellsTheFirstQuantityThatDiffersByBits) {
  RecordedCycle a;
  RecordedCycle b;
  a.depth_mm = b.depth_mm = std::nan("");
  EXPECT_TRUE(a == b);
  EXPECT_EQ(difference(a, b), "");
  b.thrust_n = -0.0;
  EXPECT_FALSE(a == b);
  EXPECT_EQ(difference(a, b), "thrust_n 0 and -0");
  b.force_n.y() = 0.1;
  EXPECT_EQ(difference(a, b), "force_y_n 0 and 0.1");
}

TEST(RecordWriter, CanBeReadWhileItWrites) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "a.h5";
  RecordWriter writer(file, {{"session", "x"}});
  EXPECT_TRUE(read_record(file).cycles.empty());
  std::mt19937_64 random(3);
  std::vector<RecordedCycle> expected;
  std::vector<SessionEvent> events;
  std::size_t seen = 0;
  // Less than a chunk, a chunk and a half, a lot: all of it is there within a second, and whole.
  for (const int more : {20, 400, 5000}) {
    for (int n = 0; n < more; ++n) {
      const Cycle cycle = any_cycle(expected.size(), random);
      expected.push_back(recorded(cycle));
      ASSERT_TRUE(writer.add_waiting(cycle));
    }
    events.push_back(event_at(expected.size(), EventKind::contact, static_cast<double>(more)));
    events.front().value += 1.0;
    writer.add_events(events);
    const auto start = std::chrono::steady_clock::now();
    EXPECT_TRUE(comes_true([&] {
      const SessionRecord record = read_record(file);
      EXPECT_FALSE(record.is_whole);
      EXPECT_GE(record.cycles.size(), seen);
      seen = record.cycles.size();
      for (std::size_t n = 0; n < seen; ++n) EXPECT_TRUE(record.cycles[n] == expected[n]) << "cycle " << n;
      return seen == expected.size() && record.events.size() == events.size() &&
             same(record.events.front(), events.front());
    }));
    std::printf("%d cycles more were to be read after %.2f s\n", more,
                std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  writer.close(events);
  EXPECT_TRUE(read_record(file).is_whole);
}

TEST(RecordWriter, LeavesARecordThatSaysSoWhereItIsNotClosed) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "a.h5";
  std::mt19937_64 random(3);
  {
    RecordWriter writer(file, {});
    writer.add_waiting(any_cycle(0, random));
  }
  // Its destructor closes.
  EXPECT_TRUE(read_record(file).is_whole);
  EXPECT_EQ(read_record(file).cycles.size(), 1U);
}

TEST(RecordWriter, KeepsWhatWasFlushedWhenTheDiskIsFullAndTheSessionGoesOn) {
  const test::TemporaryFolder folder;
  int cut = 0;
  int rejected = 0;
  for (std::uint64_t limit = 1000; limit <= 61'000; limit += 5000) {
    const fs::path file = folder.path() / (std::to_string(limit) + ".h5");
    std::uint64_t lost = 0;
    std::uint64_t added = 0;
    std::string why;
    {
      const test::FullDisk full(limit);
      try {
        RecordWriter writer(file, {{"session", "x"}});
        std::mt19937_64 random(limit);
        EXPECT_TRUE(comes_true([&] {
          for (int n = 0; n < 500; ++n) writer.add(any_cycle(added++, random));
          return !writer.trouble().empty();
        })) << "the disk took everything";
        EXPECT_FALSE(writer.add(any_cycle(added++, random))) << "nothing more gets in";
        EXPECT_FALSE(writer.add_waiting(any_cycle(added++, random))) << "and nobody waits";
        writer.add_events({});
        EXPECT_THAT(writer.trouble(), testing::HasSubstr("File too large"));
        EXPECT_THAT(writer.trouble(), testing::HasSubstr(file.string()));
        why = test::error_of([&] { writer.close({}); });
        EXPECT_THAT(why, testing::HasSubstr("File too large"));
        lost = writer.lost();
      } catch (const Error& error) {
        why = error.what();
        EXPECT_THAT(why, testing::HasSubstr("File too large"));
        EXPECT_FALSE(fs::exists(file)) << "no file that is no record";
        ++rejected;
        continue;
      }
    }
    ++cut;
    const SessionRecord record = read_record(file);
    EXPECT_FALSE(record.is_whole);
    EXPECT_EQ(record.cycles.size() + lost, added) << "at " << limit << " bytes";
    std::mt19937_64 random(limit);
    for (std::uint64_t n = 0; n < record.cycles.size(); ++n) {
      ASSERT_TRUE(record.cycles[n] == recorded(any_cycle(n, random))) << "cycle " << n << " at " << limit << " bytes";
    }
  }
  EXPECT_GE(cut, 4);
  EXPECT_GE(rejected, 1);
}

TEST(RecordWriter, CountsWhatFindsNoRoomAndGoesOn) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "a.h5";
  constexpr std::uint64_t kMax = 40 * RecordWriter::kRoom;
  std::mt19937_64 random(5);
  const Cycle some = any_cycle(0, random);
  Cycle cycle = some;
  RecordWriter writer(file, {});
  // Faster than any disk; then a pause, in which there is room again.
  std::uint64_t lost = 0;
  std::uint64_t first_lost = 0;
  for (; cycle.index < kMax && lost < 1000; ++cycle.index) {
    if (writer.add(cycle)) continue;
    if (lost == 0) first_lost = cycle.index;
    ++lost;
  }
  ASSERT_EQ(lost, 1000U) << "the writer was as fast";
  EXPECT_EQ(writer.lost(), lost);
  ASSERT_TRUE(comes_true([&] { return writer.add(cycle); }));
  lost = writer.lost();  // more may have been lost meanwhile
  const std::uint64_t last = cycle.index;
  writer.close({});
  const SessionRecord record = read_record(file);
  EXPECT_TRUE(record.is_whole);
  EXPECT_EQ(record.lost, lost);
  EXPECT_EQ(record.cycles.back().cycle, last);
  ASSERT_GE(record.events.size(), 1U);
  EXPECT_EQ(record.events.front().kind, EventKind::record_lost);
  EXPECT_EQ(record.events.front().cycle, first_lost);
  double told = 0.0;
  for (const SessionEvent& event : record.events) told += event.value;
  EXPECT_EQ(told, static_cast<double>(lost));
}

TEST(RecordWriter, RejectsAFileThatIsThereUnlessItMayReplaceIt) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "a.h5";
  write_whole_file(file, "precious");
  EXPECT_THAT(test::error_of([&] { RecordWriter writer(file, {}); }), testing::HasSubstr("there already"));
  EXPECT_EQ(read_whole_file(file), "precious");
  EXPECT_THAT(test::error_of([&] { RecordWriter writer(folder.path(), {}, true); }),
              testing::HasSubstr("expected a file"));
  { RecordWriter writer(file, {{"session", "new"}}, true); }
  EXPECT_EQ(read_record(file).setup.at("session"), "new");
  EXPECT_THAT(test::error_of([&] { RecordWriter writer(file / "a.h5", {}); }), testing::HasSubstr("Not a directory"));
}

TEST(RecordWriter, MakesTheFoldersThatItsFileLiesIn) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "of" / "today" / "a.h5";
  { RecordWriter writer(file, {{"session", "new"}}); }
  EXPECT_EQ(read_record(file).setup.at("session"), "new");
}

TEST(ReadRecord, RejectsWhatIsNoRecord) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "a.h5";
  EXPECT_THAT(test::error_of([&] { read_record(file); }), testing::HasSubstr(file.string()));
  write_whole_file(file, "plain text");
  EXPECT_THAT(test::error_of([&] { read_record(file); }), testing::HasSubstr("expected an HDF5 file"));
  EXPECT_THAT(test::error_of([&] { read_record(folder.path()); }), testing::HasSubstr(folder.path().string()));
}

TEST(ReadRecord, RejectsAFileCutShortOrDamagedOrReadsWhatItHolds) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "a.h5";
  std::vector<RecordedCycle> expected;
  {
    RecordWriter writer(file, {{"session", "x"}});
    std::mt19937_64 random(1);
    for (std::uint64_t n = 0; n < 600; ++n) {
      const Cycle cycle = any_cycle(n, random);
      expected.push_back(recorded(cycle));
      writer.add_waiting(cycle);
    }
    const std::vector<SessionEvent> events{event_at(3, EventKind::contact, 1.0)};
    writer.close(events);
  }
  const std::string whole = read_whole_file(file);
  std::mt19937_64 random(11);
  int rejected = 0;
  const auto try_reading = [&](const std::string& bytes) {
    const fs::path damaged = folder.path() / "b.h5";
    write_whole_file(damaged, bytes);
    try {
      const SessionRecord record = read_record(damaged);
      // What is read has been checked: every number is as it was written.
      ASSERT_LE(record.cycles.size(), expected.size());
      for (std::size_t n = 0; n < record.cycles.size(); ++n) ASSERT_TRUE(record.cycles[n] == expected[n]);
    } catch (const Error& error) {
      EXPECT_THAT(std::string(error.what()), testing::HasSubstr(damaged.string()));
      ++rejected;
    }
  };
  for (int n = 0; n < 60; ++n) try_reading(whole.substr(0, random() % whole.size()));
  EXPECT_EQ(rejected, 60) << "a file that was closed is whole or none";
  rejected = 0;
  for (int n = 0; n < 200; ++n) {
    std::string bytes = whole;
    bytes[random() % bytes.size()] ^= static_cast<char>(1U << (random() % 8));
    try_reading(bytes);
  }
  std::printf("%d of 200 files with a bit flipped were rejected\n", rejected);
  EXPECT_GE(rejected, 100);
}

TEST(RecordCsv, HasUnitsInItsHeadAndOneRowACycle) {
  SessionRecord record;
  record.cycles.resize(2);
  record.cycles[1].cycle = 1;
  record.cycles[1].tip_mm = {0.1, -2.0, 1e-7};
  record.cycles[1].thrust_n = std::nan("");
  record.cycles[1].canal_mm = std::numeric_limits<double>::infinity();
  record.cycles[1].state = 2;
  std::ostringstream csv;
  write_record_csv(record, csv);
  EXPECT_EQ(csv.str(),
            "cycle,time_s,dt_s,tip_x_mm,tip_y_mm,tip_z_mm,axis_x,axis_y,axis_z,spindle_on,state,removed_points,"
            "removed_hu,work_n_mm,force_x_n,force_y_n,force_z_n,thrust_n,torque_n_mm,feed_mm_per_turn,"
            "tip_density_g_cm3,depth_mm,clearance_outer_mm,clearance_canal_mm\n"
            "0,0,0,0,0,0,0,0,1,1,initial,0,0,0,0,0,0,0,0,0,0,0,0,0\n"
            "1,0,0,0.1,-2,1e-07,0,0,1,1,cancellous,0,0,0,0,0,0,,0,0,0,0,0,\n");
  record.parts.has_sides = true;
  record.cycles.resize(1);
  record.cycles[0].side = {0.6, -0.8, 0.0};
  std::ostringstream of_plate;
  write_record_csv(record, of_plate);
  EXPECT_THAT(of_plate.str(), testing::HasSubstr("clearance_canal_mm,side_x,side_y,side_z\n0,0,"));
  EXPECT_THAT(of_plate.str(), testing::EndsWith(",0,0.6,-0.8,0\n"));
  record.events = {event_at(7, EventKind::canal_breach, 0.5)};
  std::ostringstream events;
  write_events_csv(record, events);
  EXPECT_EQ(events.str(),
            "kind,cycle,time_s,depth_mm,place_x_mm,place_y_mm,place_z_mm,value\n"
            "canal breach,7,0.007,0.1,1,-2,3.5,0.5\n");
}

// As a version of before wrote it: without tools.
TEST(RecordWriter, ReadsRecordsOfVersion2) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "old.h5";
  {
    Hdf5File file = Hdf5File::create(path);
    RowTables<RecordedCycle> cycles(file, "/cycles", cycle_columns({}), kCycleChunk, true);
    RowTables<SessionEvent> events(file, "/events", event_columns(), kEventChunk, false);
    Hdf5Table progress = file.make_row("/progress", Hdf5Number::u64, RecordProgress::kNumbersWithoutTools);
    file.write_text("/", "format", kRecordFormat);
    file.write_text("/", "version", "2");
    file.make_group("/setup");
    file.write_text("/setup", "session", "{}");
    RecordedCycle row;
    row.thrust_n = 3.25;
    cycles.add(row);
    cycles.write(1);
    std::array<std::uint64_t, RecordProgress::kNumbersWithoutTools> numbers{1, 0, 0, 1, 0};
    numbers.back() = RecordProgress::checksum(std::span(numbers).first(4));
    progress.write(0, 1, numbers.data());
    file.close();
  }
  const SessionRecord record = read_record(path);
  EXPECT_TRUE(record.is_whole);
  EXPECT_TRUE(record.tools.empty());
  ASSERT_EQ(record.cycles.size(), 1U);
  EXPECT_EQ(record.cycles[0].thrust_n, 3.25);
}

TEST(RecordWriter, KeepsToolsBesideTheirFirstCycle) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "tools.h5";
  RecordWriter writer(path, {});
  Cycle cycle;
  for (std::uint64_t n = 0; n < 2000; ++n) {
    if (n % 500 == 0) writer.add_tool({n, "tool of cycle " + std::to_string(n)});
    cycle.index = n;
    EXPECT_TRUE(writer.add_waiting(cycle));
  }
  EXPECT_THROW(writer.add_tool({2000, std::string(RecordedTool::kMaxBytes + 1, 'x')}), Error);
  writer.close({});
  const SessionRecord record = read_record(path);
  ASSERT_EQ(record.tools.size(), 4U);
  EXPECT_EQ(record.tools[3].cycle, 1500U);
  EXPECT_EQ(record.tools[3].tool, "tool of cycle 1500");
  EXPECT_EQ(record.cycles.size(), 2000U);
}

}  // namespace
}  // namespace spinaltap
