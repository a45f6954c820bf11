#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/session/operator/drilled_hole.h"

namespace spinaltap {

/// Where a session's tools went while they cut, in memory that is there from the start: noting a move allocates and
/// locks nothing, at any length.
///
/// What the hole is made of is kept, not what was done: poses with the spindle on, 54 bytes each, 24 less where the
/// axis is that of the pose before, and where a way begins. The voxels that are gone would be smaller still, but a
/// picture, a mesh and a file show a surface between voxels, which only the poses have. The first kExact are kept as
/// they are. Beyond, poses are left out where the tool passes them so nearly (max_off_mm()) on its way from a pose
/// before to one after; a few at each move, so that no cycle takes long. Straight and standing tools leave a few poses;
/// a hand that trembles by 0.1 mm for an hour leaves its ways to some hundredths of a millimetre. Whoever reads along,
/// each 20 s or more often, has all exactly.
class MotionLog {
 public:
  static constexpr std::size_t kMost = 393'216;         ///< poses that there is memory for: 21 MB, 31 MB of plates
  static constexpr std::size_t kExact = kMost / 4 * 3;  ///< 4.9 minutes at 1 kHz
  static constexpr double kFinestMm = 0.002;            ///< what poses are first left out by

  /// `readers`: how many follow what is added, see read(). `most`: fewer poses than kMost, for tests.
  explicit MotionLog(std::size_t readers = 0, std::size_t most = kMost);

  /// A hole begins: of this tool, which has come from nowhere.
  void begin(const DrillBit& bit, double max_jump_mm);
  /// Another tool, which has come from nowhere as well. Allocates.
  void take_tool(const DrillBit& bit);

  /// Where the tool has come to, as cutting_ways() has it: poses that are not sound are passed over.
  void add(const ToolMove& move) noexcept;

  /// A tool and where it went, in order; moves with the spindle off stand where ways end.
  struct Run {
    std::size_t tool;  ///< of tools()
    std::vector<ToolMove> moves;
  };
  /// What a reader has not read yet, at most `max_poses` of it, of one tool; no moves where it has read all.
  Run read(std::size_t reader, std::size_t max_poses);
  const std::vector<DrillBit>& tools() const { return tools_; }

  /// All of it, a hole for each tool that cut, in order; where none did, a hole without ways.
  std::vector<DrilledHole> holes();

  std::size_t pose_count() const noexcept { return size_ - (read_ - write_); }
  /// How far off its kept way the tool may have been, at its tip and its base: 0 up to kExact poses.
  double max_off_mm() const noexcept { return max_off_mm_; }

 private:
  Pose pose(std::size_t index) const noexcept;
  /// All before it are there.
  void set_pose(std::size_t index, const Pose& pose) noexcept;
  /// `axis`: may lie in `axes_`, behind those of the poses before.
  void set_axis(std::size_t index, const double* axis) noexcept;
  bool begins_way(std::size_t index) const noexcept { return (marks_[index] & 1U) != 0; }
  std::size_t tool_of(std::size_t index) const noexcept { return marks_[index] >> 1U; }
  void make_room_for(const DrillBit& bit);
  void begin_pass() noexcept;
  void thin(std::size_t poses) noexcept;
  double window_off_mm2(std::size_t to) const noexcept;
  void keep(std::size_t from) noexcept;
  void keep_window() noexcept;
  void end_merging() noexcept;

  std::size_t most_;
  std::unique_ptr<double[]> tips_;            ///< of poses
  std::unique_ptr<double[]> axes_;            ///< of poses in a row that share one once, in order
  std::unique_ptr<std::uint32_t[]> axis_of_;  ///< of poses: which of `axes_`
  std::unique_ptr<double[]> sides_;           ///< once there was a plate
  std::unique_ptr<std::uint16_t[]> marks_;    ///< tool, and whether a way begins
  std::vector<DrillBit> tools_;
  std::vector<std::size_t> readers_;  ///< the first pose that each has not read
  double max_jump_mm_ = 0.0;
  bool is_on_way_ = false;

  // [0, write_) is kept, [write_, read_) free but for the window at its end, [read_, size_) to be looked at.
  std::size_t size_ = 0, write_ = 0, read_ = 0;
  std::size_t window_ = 0;       ///< poses before read_ that may be left out
  double window_off_mm2_ = 0.0;  ///< how far they are passed by
  bool is_thinning_ = false;
  bool is_whole_pass_ = false;  ///< from the first pose on, else from thinned_
  std::size_t pass_end_ = 0;    ///< the first pose that this pass leaves as it is
  double pass_mm_ = 0.0;        ///< how far poses may be passed
  double pass_off_mm2_ = 0.0;   ///< how far they are
  std::size_t thinned_ = 0;     ///< the first pose that was not thinned yet
  double tolerance_mm_ = kFinestMm;
  double max_off_mm_ = 0.0;
};

}  // namespace spinaltap
