#include "core/session/record/detail/frame_tables.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/base/hash.h"

namespace spinaltap {
namespace {

using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using RowMajor4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

constexpr const char* kProgress = "/frames/progress";

std::uint64_t checksum(const std::array<std::uint64_t, FrameProgress::kNumbers>& all) {
  WordHash64 hash;
  hash.add(all.data(), (FrameProgress::kNumbers - 1) * sizeof(all[0]));
  return hash.value();
}

}  // namespace

std::array<std::uint64_t, FrameProgress::kNumbers> FrameProgress::numbers() const {
  std::array<std::uint64_t, kNumbers> all{frames, static_cast<std::uint64_t>(format.width),
                                          static_cast<std::uint64_t>(format.height), format.has_normals ? 1U : 0U, 0};
  all.back() = checksum(all);
  return all;
}

FrameProgress FrameProgress::of(const std::array<std::uint64_t, kNumbers>& numbers, const std::filesystem::path& path) {
  if (numbers.back() != checksum(numbers)) {
    fail("cannot read ", path.string(), ": what it says of its frames is damaged");
  }
  return {numbers[0], {static_cast<int>(numbers[1]), static_cast<int>(numbers[2]), numbers[3] != 0}};
}

/// Calls `table(which, name, number, row)` for each.
template <class Table>
void FrameTables::for_each_table(const Table& table) {
  const auto width = static_cast<std::uint64_t>(format().width);
  const auto height = static_cast<std::uint64_t>(format().height);
  table(cycle_, "/frames/cycle", Hdf5Number::u64, Hdf5Row(1));
  table(time_, "/frames/time_s", Hdf5Number::f64, Hdf5Row(1));
  table(matrix_, "/frames/camera_matrix", Hdf5Number::f64, Hdf5Row::array({3, 3}));
  table(pose_, "/frames/camera_to_patient", Hdf5Number::f64, Hdf5Row::array({4, 4}));
  table(depth_, "/frames/depth_mm", Hdf5Number::f32, Hdf5Row::array({height, width}));
  if (format().has_normals) {
    table(normals_, "/frames/normals", Hdf5Number::f32, Hdf5Row::array({height, width, 3}));
  }
  table(mask_, "/frames/mask", Hdf5Number::u8, Hdf5Row::array({height, width}));
}

FrameTables FrameTables::make(Hdf5File& file, const FrameFormat& format) {
  Camera camera;
  camera.width = format.width;
  camera.height = format.height;
  check_camera(camera);
  FrameTables tables(FrameProgress{0, format});
  file.make_group("/frames");
  tables.for_each_table([&](Hdf5Table& table, const char* name, Hdf5Number number, const Hdf5Row& row) {
    const bool is_array = row.shape().size() > 1;
    constexpr std::uint64_t kSmallChunk = 64;
    table = file.make_table(name, number, row, is_array ? 1 : kSmallChunk, is_array);
  });
  tables.progress_row_ = file.make_row(kProgress, Hdf5Number::u64, FrameProgress::kNumbers);
  tables.say_progress();
  return tables;
}

std::optional<FrameTables> FrameTables::open(const Hdf5File& file, const std::filesystem::path& path) {
  if (!file.has("/frames")) return std::nullopt;
  std::array<std::uint64_t, FrameProgress::kNumbers> numbers{};
  file.open_table(kProgress, Hdf5Number::u64, FrameProgress::kNumbers).read(0, 1, numbers.data());
  FrameTables tables(FrameProgress::of(numbers, path));
  tables.for_each_table([&](Hdf5Table& table, const char* name, Hdf5Number number, const Hdf5Row& row) {
    table = file.open_table(name, number, row);
    if (table.rows() < tables.count()) {
      fail("cannot read ", path.string(), ": expected ", tables.count(), " frames in ", name, ", found ", table.rows());
    }
  });
  return tables;
}

std::uint64_t FrameTables::frame_bytes() const {
  const std::uint64_t pixels = static_cast<std::uint64_t>(format().width) * static_cast<std::uint64_t>(format().height);
  return pixels * (sizeof(float) + 1 + (format().has_normals ? 3 * sizeof(float) : 0));
}

void FrameTables::write(const RecordedFrame& frame) {
  const std::uint64_t row = progress_.frames;
  const RowMajor3 matrix = frame.view.camera.matrix();
  const RowMajor4 pose = frame.view.camera.to_patient;
  cycle_.write(row, 1, &frame.cycle);
  time_.write(row, 1, &frame.time_s);
  matrix_.write(row, 1, matrix.data());
  pose_.write(row, 1, pose.data());
  depth_.write(row, 1, frame.view.depth_mm.data());
  if (format().has_normals) normals_.write(row, 1, frame.view.normals.data());
  mask_.write(row, 1, frame.view.mask.data());
  ++progress_.frames;
}

void FrameTables::say_progress() { progress_row_.write(0, 1, progress_.numbers().data()); }

RecordedFrame FrameTables::read(std::uint64_t row, const std::filesystem::path& path) const {
  RecordedFrame frame;
  RowMajor3 matrix;
  RowMajor4 pose;
  cycle_.read(row, 1, &frame.cycle);
  time_.read(row, 1, &frame.time_s);
  matrix_.read(row, 1, matrix.data());
  pose_.read(row, 1, pose.data());
  View& view = frame.view;
  view.camera = {format().width, format().height, matrix(0, 0), matrix(1, 1), matrix(0, 2), matrix(1, 2), pose};
  check_camera(view.camera);
  const std::size_t pixels = view.pixel(0, format().height);
  view.depth_mm.resize(pixels);
  depth_.read(row, 1, view.depth_mm.data());
  if (format().has_normals) {
    view.normals.resize(3 * pixels);
    normals_.read(row, 1, view.normals.data());
  }
  view.mask.resize(pixels);
  mask_.read(row, 1, view.mask.data());
  const auto last = static_cast<std::uint8_t>(Seen::bit);
  if (std::any_of(view.mask.begin(), view.mask.end(), [](std::uint8_t seen) { return seen > last; })) {
    fail("cannot read ", path.string(), ": frame ", row, " has a mask of something unknown");
  }
  return frame;
}

}  // namespace spinaltap
