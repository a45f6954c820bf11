#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <vector>

#include "core/base/view.h"

namespace spinaltap {

/// What all frames of a record have in common.
struct FrameFormat {
  int width = 0;  ///< pixels
  int height = 0;
  bool has_normals = true;  ///< most of a frame's bytes
};

/// What a camera saw of a drilling after a cycle.
struct RecordedFrame {
  std::uint64_t cycle = 0;  ///< Cycle::index of the last cycle before it
  double time_s = 0.0;      ///< of that cycle
  View view;                ///< without normals where the record has none
};

/// Frames `first`, `first + 1`, ... of a record, no more than `count` and no more than there are
/// (SessionRecord::frame_count). Also while it is being written, and after a kill. Throws Error as read_record() does.
std::vector<RecordedFrame> read_frames(const std::filesystem::path& path, std::uint64_t first = 0,
                                       std::uint64_t count = std::numeric_limits<std::uint64_t>::max());

}  // namespace spinaltap
