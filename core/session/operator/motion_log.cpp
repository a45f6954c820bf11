#include "core/session/operator/motion_log.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <optional>

#include "core/base/error.h"

namespace spinaltap {
namespace {

// A pass goes over x poses while x / 11 are added. From three quarters of the memory on that leaves room for three
// passes of which none helps; the third leaves out whatever it may.
constexpr std::size_t kPosesAMove = 12;
constexpr std::size_t kMaxWindow = 16;
constexpr double kCoarser = 4.0;

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
      numbers_(std::make_unique_for_overwrite<double[]>(kNumbers * most)),
      marks_(std::make_unique_for_overwrite<std::uint16_t[]>(most)),
      readers_(readers, 0) {
  constexpr std::size_t kFewest = 256;
  if (most < kFewest) fail("motion: expected memory for ", kFewest, " poses or more, found ", most);
}

Pose MotionLog::pose(std::size_t index) const noexcept {
  const double* const numbers = numbers_.get() + kNumbers * index;
  return {Vec3(numbers[0], numbers[1], numbers[2]), Vec3(numbers[3], numbers[4], numbers[5]),
          Vec3(numbers[6], numbers[7], numbers[8])};
}

void MotionLog::set_pose(std::size_t index, const Pose& pose) noexcept {
  double* const numbers = numbers_.get() + kNumbers * index;
  for (int n = 0; n < 3; ++n) {
    numbers[n] = pose.tip_mm[n];
    numbers[3 + n] = pose.axis[n];
    numbers[6 + n] = pose.side[n];
  }
}

void MotionLog::begin(const DrillBit& bit, double max_jump_mm) {
  tools_.assign(1, bit);
  std::ranges::fill(readers_, 0);
  max_jump_mm_ = max_jump_mm;
  is_on_way_ = is_thinning_ = false;
  size_ = write_ = read_ = window_ = thinned_ = 0;
  tolerance_mm_ = max_off_mm_ = 0.0;
}

void MotionLog::take_tool(const DrillBit& bit) {
  constexpr std::size_t kMostTools = std::numeric_limits<std::uint16_t>::max() / 2;
  if (tools_.size() == kMostTools) fail("tools: expected at most ", kMostTools, " in one hole, found more");
  tools_.push_back(bit);
  is_on_way_ = false;
}

void MotionLog::add(const ToolMove& move) noexcept {
  const DrillBit& bit = tools_.back();
  const std::optional<Pose> sound = sound_pose(move.pose, bit);
  if (!sound) return;
  if (!move.spindle_on) {
    is_on_way_ = false;
    return;
  }
  if (is_on_way_ && longest_way_mm(pose(size_ - 1), *sound, bit.length_mm) > max_jump_mm_) is_on_way_ = false;
  if (size_ == most_) {
    // Ways of one pose each, thousands of them: the last gives way, and the kept way may be off by anything.
    --size_;
    max_off_mm_ = std::numeric_limits<double>::infinity();
    is_on_way_ = is_on_way_ && !begins_way(size_);
    read_ = std::min(read_, size_);
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
  const bool is_whole = tolerance_mm_ == 0.0 || thinned_ > most_ / 2;
  if (is_whole) tolerance_mm_ = std::max(kFinestMm, kCoarser * tolerance_mm_);
  write_ = read_ = is_whole ? 0 : thinned_;
  window_ = 0;
  // Ways that no tolerance helps with are no hand's.
  pass_mm_ = size_ > most_ / 100 * 85 ? std::numeric_limits<double>::infinity() : tolerance_mm_;
  max_off_mm_ = is_whole ? max_off_mm_ + pass_mm_ : std::max(max_off_mm_, pass_mm_);
}

/// Whether all poses of the window are passed on the way from the last that is kept to another.
bool MotionLog::passes_window(std::size_t to) const noexcept {
  const DrillBit& bit = tools_[tool_of(to)];
  const Places begin = places_of(pose(write_ - 1), bit), end = places_of(pose(to), bit);
  for (std::size_t n = read_ - window_; n < read_; ++n) {
    if (!(off_mm2(begin, end, places_of(pose(n), bit)) <= pass_mm_ * pass_mm_)) return false;
  }
  return true;
}

/// The last of the window is kept; the others are left out.
void MotionLog::keep_window() noexcept {
  if (window_ == 0) return;
  const std::size_t from = read_ - 1, to = write_++;
  window_ = 0;
  if (from == to) return;
  std::memcpy(numbers_.get() + kNumbers * to, numbers_.get() + kNumbers * from, kNumbers * sizeof(double));
  marks_[to] = marks_[from];
}

void MotionLog::thin(std::size_t poses) noexcept {
  // Who has read up to read_ goes on with what is kept from there on.
  const auto move_readers = [&] { std::ranges::replace(readers_, read_, write_); };
  for (; poses > 0 && read_ < size_; --poses) {
    const bool begins = begins_way(read_);
    if (window_ > 0 && (begins || window_ == kMaxWindow || !passes_window(read_))) keep_window();
    move_readers();
    ++read_;
    ++window_;
    if (begins) keep_window();
  }
  if (read_ < size_) return;
  keep_window();
  move_readers();
  size_ = read_ = thinned_ = write_;
  is_thinning_ = false;
}

MotionLog::Run MotionLog::read(std::size_t reader, std::size_t max_poses) {
  if (is_thinning_) thin(size_);
  std::size_t& from = readers_.at(reader);
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
