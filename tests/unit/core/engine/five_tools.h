#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/tool/bit_profile.h"
#include "tests/unit/core/engine/askew_block.h"

namespace spinaltap::test {

struct Tool {
  std::string name;
  DrillBit bit;
};

/// One of each kind, short and stout, so that necks, shoulders and bases pass through small volumes too.
inline std::vector<Tool> five_tools() {
  return {{"drill", {1.6, 4.0, 1.5}},
          {"twist drill", twist_drill(1.4, 4.0, 118.0, 0.3)},
          {"round burr", {1.5, 4.0, 1.0, BitShape::round_burr, 0.0, 0.6}},
          {"conical burr", {1.6, 4.0, 1.2, BitShape::conical_burr, 0.4, 0.8}},
          {"tapered screw", {1.8, 4.0, 0.8, BitShape::tapered_screw, 1.0, 0.0}}};
}

/// Their sizes drawn at random; and tools that lack a part: burrs without a shank, bits that are all tip.
inline DrillBit random_bit(Draw& draw) {
  DrillBit bit{draw(1.0, 5.0), draw(6.0, 30.0)};
  bit.shape = static_cast<BitShape>(draw.bits() % 4);
  bit.tip_length_mm = draw(0.0, 1.0) < 0.1 ? bit.length_mm : draw(0.3, bit.length_mm);
  bit.tip_diameter_mm = draw(0.0, 1.0) < 0.3 ? 0.0 : draw(0.0, bit.diameter_mm);
  // A screw without would be a line as long as its tip.
  if (bit.shape == BitShape::tapered_screw) bit.tip_diameter_mm = draw(0.5, 1.0) * bit.diameter_mm;
  bit.shank_diameter_mm = draw(0.0, 1.0) < 0.2 ? 0.0 : draw(0.0, bit.diameter_mm);
  return bit;
}

/// A point around the bit: along it, somewhat beyond both ends, and up to two radii off its axis.
inline Vec3 point_near(const BitProfile& bit, const Pose& pose, Draw& draw) {
  const double back_mm = draw(-0.2, 1.2) * bit.length_mm();
  const Vec3 side = draw.direction().cross(pose.axis).normalized();
  return pose.tip_mm - back_mm * pose.axis + draw(0.0, 2.0) * bit.radius_mm() * side;
}

/// Places on the outline (back from the tip, off the axis; mm), at most `step_mm` apart: pieces, flat ends and steps.
inline std::vector<Eigen::Vector2d> outline(const BitProfile& bit, double step_mm) {
  std::vector<Eigen::Vector2d> places;
  const auto add_line = [&](double w0, double r0, double w1, double r1) {
    const int steps = std::max(1, static_cast<int>(std::ceil(std::hypot(w1 - w0, r1 - r0) / step_mm)));
    for (int i = 0; i <= steps; ++i) {
      const double t = static_cast<double>(i) / steps;
      places.emplace_back(w0 + t * (w1 - w0), r0 + t * (r1 - r0));
    }
  };
  double before_mm = 0.0;
  for (const ProfilePiece& piece : bit.pieces()) {
    add_line(piece.begin_mm, before_mm, piece.begin_mm, piece.begin_radius_mm);
    if (piece.ball_radius_mm > 0.0) {
      const double first = std::acos((piece.ball_centre_mm - piece.begin_mm) / piece.ball_radius_mm);
      const double last = std::acos((piece.ball_centre_mm - piece.end_mm) / piece.ball_radius_mm);
      const int steps = static_cast<int>(std::ceil((last - first) * piece.ball_radius_mm / step_mm));
      for (int i = 0; i <= steps; ++i) {
        const double angle = first + (last - first) * i / steps;
        places.emplace_back(piece.ball_centre_mm - piece.ball_radius_mm * std::cos(angle),
                            piece.ball_radius_mm * std::sin(angle));
      }
    } else {
      add_line(piece.begin_mm, piece.begin_radius_mm, piece.end_mm, piece.end_radius_mm);
    }
    before_mm = piece.end_radius_mm;
  }
  add_line(bit.pieces().back().end_mm, before_mm, bit.pieces().back().end_mm, 0.0);
  return places;
}

}  // namespace spinaltap::test
