#include "core/session/operator/motion_log.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <span>

#include "core/base/error.h"

namespace spinaltap {
namespace {

constexpr std::size_t kVecBytes = 3 * sizeof(double);

// A pass goes over x poses while x / 11 are added. From three quarters of the memory on that leaves room for three
// passes of which none helps; the third leaves out whatever it can.
constexpr std::size_t kPosesAMove = 12;
constexpr std::size_t kMaxWindow = 16;
constexpr double kCoarser = 2.0, kMuchCoarser = 8.0;  // where the last pass has hardly helped

/// Three places of a tool, which between them say where all of it is: tip, base and, of a plate, a corner of its edge.
using Places = std::array<Vec3, 3>;

Places places_of(const Pose& pose, const DrillBit& bit) {
  return {pose.tip_mm, pose.tip_mm - bit.length_mm * pose.axis, pose.tip_mm + bit.radius_mm() * pose.side};
}

/// How far a tool on its way from one pose to another passes a third, squared.
double off_mm2(const Places& from, const Places& to, const Places& at) {
  double along = 0.0, whole = 0.0;
  for (std::size_t n = 0; n < from.size(); ++n) {
    const Vec3 way = to[n] - from[n];
    along += (at[n] - from[n]).dot(way);
    whole += way.squaredNorm();
  }
  const double t = whole > 0.0 ? std::clamp(along / whole, 0.0, 1.0) : 0.0;
  double most = 0.0;
  for (std::size_t n = 0; n < from.size(); ++n) {
    most = std::max(most, (from[n] + t * (to[n] - from[n]) - at[n]).squaredNorm());
  }
  return most;
}

}  // namespace

MotionLog::MotionLog(std::size_t readers, std::size_t most)
    : most_(most),
      tips_(std::make_unique_for_overwrite<double[]>(3 * most)),
      axes_(std::make_unique_for_overwrite<double[]>(3 * most)),
      axis_of_(std::make_unique_for_overwrite<std::uint32_t[]>(most)),
      marks_(std::make_unique_for_overwrite<std::uint16_t[]>(most)),
      readers_(readers, 0) {
  constexpr std::size_t kFewest = 256;
  if (most < kFewest) fail("motion: expected memory for ", kFewest, " poses or more, found ", most);
}

Pose MotionLog::pose(std::size_t index) const noexcept {
  const std::size_t axis = axis_of_[index];
  Pose pose{Eigen::Map<const Vec3>(tips_.get() + 3 * index), Eigen::Map<const Vec3>(axes_.get() + 3 * axis)};
  if (sides_) pose.side = Eigen::Map<const Vec3>(sides_.get() + 3 * index);
  return pose;
}

void MotionLog::set_pose(std::size_t index, const Pose& pose) noexcept {
  Eigen::Map<Vec3>(tips_.get() + 3 * index) = pose.tip_mm;
  set_axis(index, pose.axis.data());
  if (sides_) Eigen::Map<Vec3>(sides_.get() + 3 * index) = pose.side;
}

void MotionLog::set_axis(std::size_t index, const double* axis) noexcept {
  std::uint32_t place = 0;
  if (index > 0) {
    place = axis_of_[index - 1];
    const std::span before(axes_.get() + 3 * std::size_t{place}, 3);
    // By their bytes, since -0 equals 0 and a replay has to have the same bits.
    if (!std::ranges::equal(std::as_bytes(before), std::as_bytes(std::span(axis, 3)))) ++place;
  }
  std::memmove(axes_.get() + 3 * std::size_t{place}, axis, kVecBytes);
  axis_of_[index] = place;
}

void MotionLog::begin(const DrillBit& bit, double max_jump_mm) {
  make_room_for(bit);
  tools_.assign(1, bit);
  std::ranges::fill(readers_, 0);
  max_jump_mm_ = max_jump_mm;
  is_on_way_ = is_thinning_ = false;
  size_ = write_ = read_ = window_ = thinned_ = 0;
  tolerance_mm_ = kFinestMm;
  max_off_mm_ = window_off_mm2_ = 0.0;
}

void MotionLog::take_tool(const DrillBit& bit) {
  constexpr std::size_t kMostTools = std::numeric_limits<std::uint16_t>::max() / 2;
  if (tools_.size() == kMostTools) fail("tools: expected at most ", kMostTools, " in one hole, found more");
  make_room_for(bit);
  tools_.push_back(bit);
  is_on_way_ = false;
}

/// Only plates are turned about their axis.
void MotionLog::make_room_for(const DrillBit& bit) {
  if (sides_ || !bit.is_plate()) return;
  sides_ = std::make_unique_for_overwrite<double[]>(3 * most_);
  std::fill_n(sides_.get(), 3 * size_, 0.0);
}

void MotionLog::add(const ToolMove& move) noexcept {
  const DrillBit& bit = tools_.back();
  const std::optional<Pose> sound = valid_pose(move.pose, bit);
  if (!sound) return;
  if (!move.spindle_on) {
    is_on_way_ = false;
    return;
  }
  if (is_on_way_ && max_displacement_mm(pose(size_ - 1), *sound, bit.length_mm) > max_jump_mm_) is_on_way_ = false;
  if (size_ == most_) {
    // Ways of one pose each, thousands of them: the last gives way, and the kept way may be off by anything.
    --size_;
    max_off_mm_ = std::numeric_limits<double>::infinity();
    is_on_way_ = is_on_way_ && !begins_way(size_);
    read_ = std::min(read_, size_);
    pass_end_ = std::min(pass_end_, size_);
  }
  set_pose(size_, *sound);
  marks_[size_] = static_cast<std::uint16_t>((tools_.size() - 1) * 2 + (is_on_way_ ? 0 : 1));
  ++size_;
  is_on_way_ = true;
  if (!is_thinning_ && size_ >= most_ / 4 * 3) begin_pass();
  if (is_thinning_) thin(kPosesAMove);
}

void MotionLog::begin_pass() noexcept {
  is_thinning_ = true;
  // What was thinned is left as it is while it takes less than half of the memory.
  is_whole_pass_ = thinned_ == 0 || thinned_ > most_ / 2;
  if (is_whole_pass_ && thinned_ > 0) tolerance_mm_ *= size_ > most_ * 80 / 100 ? kMuchCoarser : kCoarser;
  write_ = read_ = is_whole_pass_ ? 0 : thinned_;
  window_ = 0;
  pass_end_ = std::max(read_, size_ - most_ / 16);
  // Ways that no tolerance helps with are no hand's.
  pass_mm_ = size_ > most_ * 88 / 100 ? std::numeric_limits<double>::infinity() : tolerance_mm_;
  pass_off_mm2_ = 0.0;
}

/// How far poses of the window are passed, squared and at most, on the way from the last that is kept to another.
double MotionLog::window_off_mm2(std::size_t to) const noexcept {
  const DrillBit& bit = tools_[tool_of(to)];
  const Places begin = places_of(pose(write_ - 1), bit), end = places_of(pose(to), bit);
  double most_mm2 = 0.0;
  for (std::size_t n = read_ - window_; n < read_ && most_mm2 <= pass_mm_ * pass_mm_; ++n) {
    most_mm2 = std::max(most_mm2, off_mm2(begin, end, places_of(pose(n), bit)));
  }
  return most_mm2;
}

void MotionLog::keep(std::size_t from) noexcept {
  const std::size_t to = write_++;
  if (from == to) return;
  std::memcpy(tips_.get() + 3 * to, tips_.get() + 3 * from, kVecBytes);
  set_axis(to, axes_.get() + 3 * std::size_t{axis_of_[from]});
  if (sides_) std::memcpy(sides_.get() + 3 * to, sides_.get() + 3 * from, kVecBytes);
  marks_[to] = marks_[from];
}

/// The last of the window is kept; the others are left out.
void MotionLog::keep_window() noexcept {
  if (window_ > 0) keep(read_ - 1);
  pass_off_mm2_ = std::max(pass_off_mm2_, window_off_mm2_);
  window_ = 0;
  window_off_mm2_ = 0.0;
}

void MotionLog::thin(std::size_t poses) noexcept {
  // Who has read up to read_ goes on with what is kept from there on.
  const auto move_readers = [&] { std::ranges::replace(readers_, read_, write_); };
  for (; poses > 0 && read_ < size_; --poses) {
    if (read_ == pass_end_) end_merging();
    if (read_ >= pass_end_) {
      move_readers();
      keep(read_++);
      continue;
    }
    const bool begins = begins_way(read_);
    double off_mm2 = 0.0;
    if (window_ > 0 && !begins && window_ < kMaxWindow) off_mm2 = window_off_mm2(read_);
    if (begins || window_ == kMaxWindow || !(off_mm2 <= pass_mm_ * pass_mm_)) {
      keep_window();
    } else {
      window_off_mm2_ = off_mm2;
    }
    move_readers();
    ++read_;
    ++window_;
    if (begins) keep_window();
  }
  if (read_ < size_) return;
  if (read_ == pass_end_) end_merging();
  move_readers();
  size_ = read_ = write_;
  is_thinning_ = false;
}

/// The last poses are moved only: a reader that looks in now and then has them as they were.
void MotionLog::end_merging() noexcept {
  keep_window();
  thinned_ = write_;
  const double off_mm = std::sqrt(pass_off_mm2_);
  max_off_mm_ = is_whole_pass_ ? max_off_mm_ + off_mm : std::max(max_off_mm_, off_mm);
}

MotionLog::Run MotionLog::read(std::size_t reader, std::size_t max_poses) {
  std::size_t& from = readers_.at(reader);
  // Who reads along reads beyond what is being looked at, and need not wait for it.
  if (is_thinning_ && from < read_) thin(size_);
  if (from == size_) return {tools_.size() - 1, {}};
  Run run{tool_of(from), {}};
  const std::size_t end = from + std::min(max_poses, size_ - from);
  run.moves.reserve(end - from + 1);
  for (; from < end && tool_of(from) == run.tool; ++from) {
    if (begins_way(from)) run.moves.push_back({pose(from), false});
    run.moves.push_back({pose(from), true});
  }
  return run;
}

std::vector<DrilledHole> MotionLog::holes() {
  if (is_thinning_) thin(size_);
  std::vector<DrilledHole> holes;
  std::size_t tool = 0;
  for (std::size_t n = 0; n < size_; ++n) {
    if (holes.empty() || tool_of(n) != tool) holes.push_back({tools_[tool = tool_of(n)], {}});
    if (begins_way(n)) holes.back().ways.emplace_back();
    holes.back().ways.back().push_back(pose(n));
  }
  if (holes.empty()) holes.push_back({tools_.back(), {}});
  return holes;
}

}  // namespace spinaltap
