#include "core/tool/bit_ray.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"

namespace spinaltap {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// A number that goes a + b t along a ray.
struct Line {
  double at_start = 0.0;
  double slope = 0.0;
};

/// Where low <= line <= high.
RayStretch between(const Line& line, double low, double high) {
  if (line.slope == 0.0) {
    const bool is_within = line.at_start >= low && line.at_start <= high;
    return is_within ? RayStretch{-kInfinite, kInfinite} : RayStretch{kInfinite, -kInfinite};
  }
  const double to_low = (low - line.at_start) / line.slope;
  const double to_high = (high - line.at_start) / line.slope;
  return {std::min(to_low, to_high), std::max(to_low, to_high)};
}

/// Bodies of revolution stay where they are.
Pose pose_of(const DrillBit& bit, const Pose& pose) {
  if (!bit.is_plate()) return pose;
  const std::optional<Pose> sound = valid_pose(pose, bit);
  if (!sound) fail("plate: expected a place that is finite, an axis of length 1, and a side across it");
  return *sound;
}

}  // namespace

BitBody::BitBody(const DrillBit& bit, const Pose& pose) : body_(tool_body(bit)), pose_(pose_of(bit, pose)) {}

void BitBody::append_stretches(const Vec3& start_mm, const Vec3& direction, std::vector<RayStretch>& stretches) const {
  std::visit([&](const auto& body) { append_stretches_of(body, start_mm, direction, stretches); }, body_);
}

void BitBody::append_stretches_of(const PlateBox& plate, const Vec3& start_mm, const Vec3& direction,
                                  std::vector<RayStretch>& stretches) const {
  const Mat3 rows = plate_rows(pose_);
  const Vec3 start = rows * (start_mm - pose_.tip_mm);
  const Vec3 way = rows * direction;
  RayStretch in{-kInfinite, kInfinite};
  for (Eigen::Index n = 0; n < 3; ++n) {
    const RayStretch slab = between({start[n], way[n]}, plate.low_mm()[n], plate.high_mm()[n]);
    in = {std::max(in.begin_mm, slab.begin_mm), std::min(in.end_mm, slab.end_mm)};
  }
  if (in.begin_mm < in.end_mm) stretches.push_back(in);
}

void BitBody::append_stretches_of(const BitProfile& profile, const Vec3& start_mm, const Vec3& direction,
                                  std::vector<RayStretch>& stretches) const {
  const Vec3 from_tip_mm = start_mm - pose_.tip_mm;
  const Line back{-from_tip_mm.dot(pose_.axis), -direction.dot(pose_.axis)};
  // Off the axis: |off + t across|².
  const Vec3 across = direction + back.slope * pose_.axis;
  const Vec3 off_mm = from_tip_mm + back.at_start * pose_.axis;
  const double across2 = across.squaredNorm();
  const double along = off_mm.dot(across);
  const double off2_mm2 = off_mm.squaredNorm();
  // The line passes the axis at some distance, wherever.
  const double widest2_mm2 = profile.radius_mm() * profile.radius_mm();
  if ((off2_mm2 - widest2_mm2) * across2 > along * along) return;
  for (const ProfilePiece& piece : profile.pieces()) {
    RayStretch in = between(back, piece.begin_mm, piece.end_mm);
    if (!(in.begin_mm < in.end_mm)) continue;
    // a t² + 2 b t + c <= 0: within the piece's outline. The piece is convex, so that this is one stretch of `in`.
    const double a = across2 - piece.square[2] * back.slope * back.slope;
    const double b = along - back.slope * (0.5 * piece.square[1] + piece.square[2] * back.at_start);
    const double c = off2_mm2 - piece.radius_squared_mm2(back.at_start);
    const double discriminant = b * b - a * c;
    if (a == 0.0) {
      if (b == 0.0 && c > 0.0) continue;
      if (b > 0.0) in.end_mm = std::min(in.end_mm, -0.5 * c / b);
      if (b < 0.0) in.begin_mm = std::max(in.begin_mm, -0.5 * c / b);
    } else if (discriminant > 0.0) {
      // Both roots without cancellation.
      const double q = -(b + std::copysign(std::sqrt(discriminant), b));
      const double one = q / a;
      const double other = q != 0.0 ? c / q : 0.0;
      const double low = std::min(one, other);
      const double high = std::max(one, other);
      if (a > 0.0) {
        in.begin_mm = std::max(in.begin_mm, low);
        in.end_mm = std::min(in.end_mm, high);
      } else {
        // Steeper than the cone: before `low` or after `high`, of which one is the cone's other half, beyond its apex
        // and so beyond the piece.
        const RayStretch before{in.begin_mm, std::min(in.end_mm, low)};
        const RayStretch after{std::max(in.begin_mm, high), in.end_mm};
        in = before.end_mm - before.begin_mm > after.end_mm - after.begin_mm ? before : after;
      }
    } else if (a > 0.0) {
      continue;
    }
    if (in.begin_mm < in.end_mm) stretches.push_back(in);
  }
}

double BitBody::distance_mm(const Vec3& p_mm) const {
  if (const auto* const plate = std::get_if<PlateBox>(&body_)) {
    return plate->sample(plate_rows(pose_) * (p_mm - pose_.tip_mm)).distance_mm;
  }
  return bit_distance_mm(std::get<BitProfile>(body_), pose_, p_mm);
}

Vec3 BitBody::normal(const Vec3& p_mm) const {
  if (const auto* const plate = std::get_if<PlateBox>(&body_)) {
    const Mat3 rows = plate_rows(pose_);
    return rows.transpose() * plate->sample(rows * (p_mm - pose_.tip_mm)).gradient;
  }
  constexpr double kStepMm = 1e-4;
  Vec3 slope;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 step = kStepMm * Vec3::Unit(axis);
    slope[axis] = distance_mm(p_mm + step) - distance_mm(p_mm - step);
  }
  return slope.norm() > 0.0 ? slope.normalized() : pose_.axis;
}

void join_stretches(std::vector<RayStretch>& stretches) {
  constexpr double kJoinedMm = 1e-7;  // pieces of a bit end where the next begins, to within rounding
  std::sort(stretches.begin(), stretches.end(), [](const RayStretch& a, const RayStretch& b) {
    return a.begin_mm != b.begin_mm ? a.begin_mm < b.begin_mm : a.end_mm < b.end_mm;
  });
  std::size_t joined = 0;
  for (const RayStretch& stretch : stretches) {
    if (joined > 0 && stretch.begin_mm <= stretches[joined - 1].end_mm + kJoinedMm) {
      stretches[joined - 1].end_mm = std::max(stretches[joined - 1].end_mm, stretch.end_mm);
    } else {
      stretches[joined++] = stretch;
    }
  }
  stretches.resize(joined);
}

}  // namespace spinaltap
