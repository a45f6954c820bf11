#pragma once

#include <filesystem>
#include <vector>

#include "core/session/operator/tool_source.h"

namespace spinaltap {

struct PoseCsvOptions {
  bool lets_bad_poses_pass = false;  ///< poses that are not numbers, or have no direction: for sessions to refuse
};

/// Poses of a tool from a CSV file with the columns time_s, x_mm, y_mm, z_mm (the tip, patient LPS), axis_x, axis_y,
/// axis_z (from the base to the tip; brought to length 1) and, where it has one, spindle_on (0 or 1), in any order;
/// others are passed over. Times rise. Throws Error that names the file and the line.
std::vector<ToolInput> read_pose_csv(const std::filesystem::path& path, const PoseCsvOptions& options = {});

/// A hand whose poses are known beforehand: from a file, a record or a test.
class PoseHand final : public ToolSource {
 public:
  /// `heeds_stop`: ends when the session asks to stop.
  explicit PoseHand(std::vector<ToolInput> inputs, bool heeds_stop = true)
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
