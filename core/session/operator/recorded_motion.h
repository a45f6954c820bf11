#pragma once

#include <filesystem>
#include <vector>

#include "core/session/operator/operator.h"

namespace spinaltap {

/// How read_pose_csv() takes a file.
struct PoseCsvOptions {
  bool lets_bad_poses_pass = false;  ///< poses that are not numbers, or have no direction: for sessions to reject
};

/// Poses of a tool from a CSV file with the columns time_s, x_mm, y_mm, z_mm (the tip, patient LPS), axis_x, axis_y,
/// axis_z (from the base to the tip; brought to length 1) and, where it has them, spindle_on (0 or 1) and side_x,
/// side_y, side_z (Pose::side, brought to length 1; empty or 0, 0, 0: not said), in any order; others are passed over.
/// Times rise. Throws Error that names the file and the line.
std::vector<ToolInput> read_pose_csv(const std::filesystem::path& path, const PoseCsvOptions& options = {});

/// An operator whose poses are known beforehand: from a file, a record or a test.
class RecordedMotion final : public Operator {
 public:
  /// `heeds_stop`: ends when the session asks to stop.
  explicit RecordedMotion(std::vector<ToolInput> inputs, bool heeds_stop = true)
      : inputs_(std::move(inputs)), heeds_stop_(heeds_stop) {}

  std::optional<ToolInput> next(const ToolFeedback& feedback) override {
    if ((heeds_stop_ && feedback.stop) || index_ == inputs_.size()) return std::nullopt;
    return inputs_[index_++];
  }
  std::size_t count() const override { return inputs_.size(); }

 private:
  std::vector<ToolInput> inputs_;
  bool heeds_stop_;
  std::size_t index_ = 0;
};

}  // namespace spinaltap
