#pragma once

#include <span>
#include <string>

#include "core/tool/drill_bit.h"

namespace spinaltap {

/// How fast a tool goes in use: beyond it a number is more likely of another unit than meant.
struct ToolSpeedRange {
  double min_feed_mm_s = 0.0, max_feed_mm_s = 0.0;
  double min_rpm = 0.0, max_rpm = 0.0;
};

/// What is to be known of a shape beside its outline (BitProfile, PlateBox) and its limits (check_bit()).
struct BitShapeTraits {
  BitShape shape;
  std::string name;       ///< in files and options
  bool cuts_beside_path;  ///< else it goes along its path alone, as drills and screws do
  /// Cutting edges that pass a place in one turn, for its sound: the two lips of a drill, 8 flutes of a burr, both ends
  /// of a saw's stroke. Only the number of a drill's is sure.
  int edges;
  ToolSpeedRange speeds;
};

/// One for each shape, in their order.
std::span<const BitShapeTraits> bit_shape_traits();
const BitShapeTraits& traits_of(BitShape shape);
inline const std::string& name_of(BitShape shape) { return traits_of(shape).name; }

}  // namespace spinaltap
