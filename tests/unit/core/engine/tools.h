#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/tool/bit_profile.h"
#include "tests/unit/core/engine/askew_block.h"

namespace spinaltap::test {

struct Tool {
  std::string name;
  DrillBit bit;
};

/// One of each shape and two profiles, short and stout, so that necks, shoulders and bases pass through small volumes
/// too.
inline std::vector<Tool> every_tool() {
  // Wider again behind a neck; and a step back, as behind a thread.
  const DrillBit match_head =
      profile_bit({{0.0, 0.0}, {0.75, 0.75, true}, {1.4, 0.75}, {1.8, 0.4}, {2.5, 0.4}, {2.9, 0.6}, {4.0, 0.6}});
  const DrillBit tap = profile_bit({{0.0, 0.25}, {1.4, 0.9}, {2.4, 0.9}, {2.4, 0.55}, {4.0, 0.55}});
  return {{"drill", {1.6, 4.0, 1.5}},
          {"twist drill", twist_drill(1.4, 4.0, 118.0, 0.3)},
          {"round burr", {1.5, 4.0, 1.0, BitShape::round_burr, 0.0, 0.6}},
          {"conical burr", {1.6, 4.0, 1.2, BitShape::conical_burr, 0.4, 0.8}},
          {"tapered screw", {1.8, 4.0, 0.8, BitShape::tapered_screw, 1.0, 0.0}},
          {"match-head", match_head},
          {"tap", tap}};
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
  if (bit.shank_diameter_mm < 0.02) bit.shank_diameter_mm = 0.0;  // thinner than a profile may be
  return bit;
}

/// Of any outline: straight stretches, flat faces and arcs, some of them of flat balls, wider and narrower again.
inline DrillBit random_profile(Draw& draw) {
  std::vector<OutlinePoint> outline{{0.0, draw(0.0, 1.0) < 0.5 ? 0.0 : draw(0.1, 2.0)}};
  const std::size_t stretches = 2 + draw.bits() % (kMaxStretches - 1);
  bool was_face = true;
  while (outline.size() <= stretches) {
    const OutlinePoint from = outline.back();
    const double kind = draw(0.0, 1.0);
    const double length_mm = draw(0.2, 3.0);
    const double radius_mm = draw(0.2, 2.5);
    const bool is_last = outline.size() == stretches;
    if (kind < 0.2 && !was_face && !is_last) {
      outline.push_back({from.back_mm, radius_mm});
      was_face = true;
      continue;
    }
    const bool is_cylinder = kind > 0.8 && from.radius_mm > 0.0;
    outline.push_back({from.back_mm + length_mm, is_cylinder ? from.radius_mm : radius_mm, kind < 0.5});
    if (is_last && kind < 0.3) outline.back().radius_mm = 0.0;  // a closed end
    was_face = false;
  }
  return profile_bit(std::move(outline));
}

/// Any tool: of a shape, or a profile.
inline DrillBit random_tool(Draw& draw) { return draw(0.0, 1.0) < 0.3 ? random_profile(draw) : random_bit(draw); }

/// A profile of the same outline as a bit's that is of another shape.
inline DrillBit profile_like(const DrillBit& bit) {
  const double radius_mm = bit.radius_mm(), tip_mm = 0.5 * bit.tip_diameter_mm, shank_mm = 0.5 * bit.shank_diameter_mm;
  std::vector<OutlinePoint> outline;
  const auto add = [&](const OutlinePoint& point) {
    if (outline.empty() || !(outline.back() == point)) outline.push_back(point);
  };
  switch (bit.shape) {
    case BitShape::profile:
      return bit;
    case BitShape::drill:
      add({0.0, tip_mm});
      add({bit.tip_length_mm, radius_mm});
      if (bit.tip_length_mm < bit.length_mm) add({bit.length_mm, radius_mm});
      break;
    case BitShape::round_burr: {
      const double neck_mm = radius_mm + std::sqrt(radius_mm * radius_mm - shank_mm * shank_mm);
      add({0.0, 0.0});
      if (neck_mm < bit.length_mm) {
        add({neck_mm, shank_mm, true});
        if (shank_mm > 0.0) add({bit.length_mm, shank_mm});
      } else {
        const double beyond_mm = bit.length_mm - radius_mm;
        add({bit.length_mm, std::sqrt(radius_mm * radius_mm - beyond_mm * beyond_mm), true});
      }
      break;
    }
    case BitShape::conical_burr:
      add({0.0, tip_mm});
      add({bit.tip_length_mm, radius_mm});
      if (shank_mm > 0.0 && bit.tip_length_mm < bit.length_mm) {
        if (shank_mm < radius_mm) add({bit.tip_length_mm, shank_mm});
        add({bit.length_mm, shank_mm});
      }
      break;
    case BitShape::tapered_screw:
      add({0.0, 0.0});
      add({bit.tip_length_mm, bit.tip_length_mm < bit.length_mm ? tip_mm : radius_mm});
      if (bit.tip_length_mm < bit.length_mm) add({bit.length_mm, radius_mm});
      break;
    case BitShape::plate:
      fail("a plate has no outline");
  }
  return profile_bit(std::move(outline));
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
      const auto angle_at = [&](double back_mm) {
        return std::acos(std::clamp((piece.ball_centre_mm - back_mm) / piece.ball_radius_mm, -1.0, 1.0));
      };
      const double first = angle_at(piece.begin_mm), last = angle_at(piece.end_mm);
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
