// What cameras saw, in records: it comes back to the last bit, and changes nothing of what a record is without.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/session/record/session_record.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr FrameFormat kFormat{31, 17};

/// Other numbers in each.
RecordedFrame frame(std::uint64_t n, const FrameFormat& format = kFormat) {
  RecordedFrame made{100 * n, 0.1 * static_cast<double>(n), {}};
  View& view = made.view;
  const double turn = 0.1 * static_cast<double>(n);
  view.camera = look_at({50.0 * std::cos(turn), 50.0 * std::sin(turn), 7.0}, Vec3::Zero(), Vec3::UnitZ(), 0.6,
                        format.width, format.height);
  view.camera.fy *= 1.1;
  const std::size_t pixels = view.pixel(0, format.height);
  for (std::size_t p = 0; p < pixels; ++p) {
    view.depth_mm.push_back(static_cast<float>(100.0 * random_uniform(n, p)));
    view.mask.push_back(static_cast<std::uint8_t>(p % 4));
    for (std::uint64_t axis = 0; axis < 3; ++axis) {
      view.normals.push_back(static_cast<float>(random_uniform(n + 1000, 3 * p + axis)));
    }
  }
  return made;
}

Cycle cycle(std::uint64_t index) {
  Cycle made;
  made.index = index;
  made.time_s = 1e-3 * static_cast<double>(index);
  return made;
}

void expect_same(const RecordedFrame& a, const RecordedFrame& b, bool has_normals = true) {
  EXPECT_EQ(a.cycle, b.cycle);
  EXPECT_EQ(a.time_s, b.time_s);
  EXPECT_EQ(a.view.camera.matrix(), b.view.camera.matrix());
  EXPECT_EQ(a.view.camera.to_patient, b.view.camera.to_patient);
  EXPECT_EQ(a.view.camera.width, b.view.camera.width);
  EXPECT_EQ(a.view.camera.height, b.view.camera.height);
  EXPECT_EQ(a.view.depth_mm, b.view.depth_mm);
  EXPECT_EQ(a.view.mask, b.view.mask);
  EXPECT_EQ(a.view.normals, has_normals ? b.view.normals : std::vector<float>());
}

TEST(RecordedFrames, ComeBackToTheLastBitAllOrSome) {
  const test::TemporaryFolder folder;
  for (const bool has_normals : {true, false}) {
    const fs::path file = folder.path() / (has_normals ? "a.h5" : "b.h5");
    RecordWriter writer(file, {}, false, FrameFormat{kFormat.width, kFormat.height, has_normals});
    for (std::uint64_t n = 0; n < 40; ++n) {
      ASSERT_TRUE(writer.add_waiting(cycle(n)));
      ASSERT_TRUE(writer.add_frame(frame(n)));
    }
    writer.close({});
    const SessionRecord record = read_record(file);
    EXPECT_EQ(record.frame_count, 40U);
    EXPECT_EQ(record.cycles.size(), 40U);
    EXPECT_TRUE(record.is_whole);
    const std::vector<RecordedFrame> all = read_frames(file);
    ASSERT_EQ(all.size(), 40U);
    for (std::uint64_t n = 0; n < all.size(); ++n) expect_same(all[n], frame(n), has_normals);
    const std::vector<RecordedFrame> some = read_frames(file, 37, 2);
    ASSERT_EQ(some.size(), 2U);
    expect_same(some[1], frame(38), has_normals);
    EXPECT_EQ(read_frames(file, 39, 5).size(), 1U);
    EXPECT_TRUE(read_frames(file, 40).empty());
  }
}

TEST(RecordedFrames, ChangeNeitherHashNorCyclesNorRecordsWithoutThem) {
  const test::TemporaryFolder folder;
  const fs::path with = folder.path() / "with.h5";
  const fs::path without = folder.path() / "without.h5";
  {
    RecordWriter one(with, {}, false, kFormat);
    RecordWriter other(without, {});
    for (std::uint64_t n = 0; n < 1000; ++n) {
      one.add_waiting(cycle(n));
      other.add_waiting(cycle(n));
      if (n % 300 == 0) one.add_frame(frame(n));
    }
    EXPECT_THAT([&] { other.add_frame(frame(0)); }, ThrowsMessage<Error>(HasSubstr("takes frames")));
    one.close({});
    other.close({});
  }
  EXPECT_EQ(hash_of(read_record(with)), hash_of(read_record(without)));
  EXPECT_EQ(read_record(with).cycles, read_record(without).cycles);
  EXPECT_EQ(read_record(with).frame_count, 4U);
  EXPECT_EQ(read_record(without).frame_count, 0U);
  EXPECT_TRUE(read_frames(without).empty());
}

TEST(RecordedFrames, CanBeReadWhileTheyAreWritten) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "a.h5";
  RecordWriter writer(file, {}, false, kFormat);
  EXPECT_EQ(read_record(file).frame_count, 0U);
  for (std::uint64_t n = 0; n < 3; ++n) writer.add_frame(frame(n));
  for (int look = 0; look < 2000 && read_record(file).frame_count < 3; ++look) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  const std::vector<RecordedFrame> seen = read_frames(file);
  ASSERT_EQ(seen.size(), 3U);
  expect_same(seen[2], frame(2));
}

TEST(RecordedFrames, AreRejectedInAnotherSizeOrWithArraysThatDoNotFit) {
  const test::TemporaryFolder folder;
  RecordWriter writer(folder.path() / "a.h5", {}, false, kFormat);
  EXPECT_THAT([&] { writer.add_frame(frame(0, {17, 31})); }, ThrowsMessage<Error>(HasSubstr("found 17 x 31")));
  RecordedFrame thin = frame(0);
  thin.view.depth_mm.pop_back();
  EXPECT_THROW(writer.add_frame(thin), Error);
  RecordedFrame blind = frame(0);
  blind.view.camera.fx = 0.0;
  EXPECT_THROW(writer.add_frame(blind), Error);
  EXPECT_THROW(RecordWriter(folder.path() / "b.h5", {}, false, FrameFormat{0, 10}), Error);
  EXPECT_FALSE(fs::exists(folder.path() / "b.h5")) << "none is left that is no record";
}

}  // namespace
}  // namespace spinaltap
