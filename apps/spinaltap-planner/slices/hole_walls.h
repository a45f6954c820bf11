#pragma once

#include <array>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "apps/report/slice_frame.h"
#include "vdb/remaining/surface_block.h"

namespace spinaltap {

/// The walls of the holes that were drilled, for slices to cut.
class HoleWalls {
 public:
  void clear() { blocks_.clear(); }
  /// Blocks of the bone's surface: all of it at first, as it may have been opened with holes, then what drilling or its
  /// undoing changed.
  void update(std::span<const SurfaceUpdate> updates);
  /// Where a slice's plane cuts them: ends of straight pieces, in its pixels.
  std::vector<std::array<Eigen::Vector2d, 2>> section(const SliceFrame& frame) const;

 private:
  std::map<std::array<int, 3>, std::shared_ptr<const SurfaceBlock>> blocks_;  ///< those that hold any
};

}  // namespace spinaltap
