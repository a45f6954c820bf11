#include "core/tool/plate.h"

#include "core/base/error.h"
#include "core/tool/swept_bit.h"

namespace spinaltap {

void check_turns(const DrillBit& tool, std::string_view what) {
  if (!tool.is_plate()) return;
  fail("expected a tool that turns, a drill or a burr, for ", what, ", found a plate (a saw, an osteotome)");
}

Mat3 plate_rows(const Pose& pose) noexcept {
  Mat3 rows;
  rows.row(0) = pose.side;
  rows.row(1) = pose.axis.cross(pose.side);
  rows.row(2) = -pose.axis;
  return rows;
}

PlateBox::PlateBox(const DrillBit& plate) {
  check_bit(plate);
  if (!plate.is_plate()) fail("expected a plate, found a body of revolution");
  high_mm_ = Vec3(0.5 * plate.diameter_mm, 0.5 * plate.thickness_mm, plate.length_mm);
  low_mm_ = Vec3(-high_mm_.x(), -high_mm_.y(), 0.0);
}

double PlateBox::reach_mm() const { return low_mm_.cwiseAbs().cwiseMax(high_mm_.cwiseAbs()).norm(); }

PlateBox PlateBox::grown(double by_mm) const {
  PlateBox larger = *this;
  larger.low_mm_ -= Vec3::Constant(by_mm);
  larger.high_mm_ += Vec3::Constant(by_mm);
  return larger;
}

PlateBox PlateBox::lengthened(double way_mm) const {
  PlateBox longer = *this;
  longer.high_mm_.z() += way_mm;
  return longer;
}

PlateBox::Sample PlateBox::sample(const Vec3& seen) const noexcept {
  const Vec3 middle = 0.5 * (low_mm_ + high_mm_);
  const Vec3 from_middle = seen - middle;
  const Vec3 out = from_middle.cwiseAbs() - 0.5 * (high_mm_ - low_mm_);
  const auto sign = [&](Eigen::Index n) { return from_middle[n] < 0.0 ? -1.0 : 1.0; };
  const Vec3 beyond = out.cwiseMax(0.0);
  const double outside_mm = beyond.norm();
  if (outside_mm > 0.0) {
    return {outside_mm, Vec3(sign(0) * beyond.x(), sign(1) * beyond.y(), sign(2) * beyond.z()) / outside_mm};
  }
  Eigen::Index nearest = 0;
  const double inside_mm = out.maxCoeff(&nearest);
  return {inside_mm, sign(nearest) * Vec3::Unit(nearest)};
}

PlateSweep::PlateSweep(const DrillBit& plate)
    : box(plate),
      straight(box.grown(SweepProfile::kStraightSkinMm)),
      turning(box.grown(SweepProfile::kTurningSkinMm)) {}

SweptPlate::SweptPlate(const PlateSweep& sweep, const Pose& from, const Pose& to, Way way) noexcept
    : box_(way == Way::turning ? &sweep.turning : &sweep.straight),
      from_(from),
      to_(to),
      from_rows_(plate_rows(from)),
      to_rows_(plate_rows(to)) {}

bool SweptPlate::contains(const Vec3& p) const noexcept {
  const Vec3 begin = from_rows_ * (p - from_.tip_mm);
  const Vec3 end = to_rows_ * (p - to_.tip_mm);
  double first = 0.0, last = 1.0;
  for (Eigen::Index n = 0; n < 3; ++n) {
    const double low = box_->low_mm()[n], high = box_->high_mm()[n];
    const double way = end[n] - begin[n];
    if (way == 0.0) {
      if (!(begin[n] >= low && begin[n] <= high)) return false;
      continue;
    }
    const double a = (low - begin[n]) / way, b = (high - begin[n]) / way;
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  return first <= last;
}

PlateMotion::PlateMotion(const PlateSweep& sweep, const Pose& from, const Pose& to) noexcept
    : sweep_(&sweep), from_(from), to_(to) {
  const Mat3 turn = plate_rows(to).transpose() * plate_rows(from);
  const Eigen::Vector3d sines(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1));
  angle_rad_ = std::atan2(sines.norm(), turn.trace() - 1.0);
  // Near no turn the antisymmetric part tells the direction, near half a turn it does not.
  constexpr double kNearlyHalf = 3.0;
  if (angle_rad_ > kNearlyHalf) {
    const Eigen::AngleAxisd about(turn);
    about_ = about.axis();
    angle_rad_ = about.angle();
  } else if (sines.norm() > 0.0) {
    about_ = sines.normalized();
  }
  // Seen from the plate, the second derivative of a point's place over the whole way is at most angle² times how far it
  // lies from the tip, and twice the angle times the tip's way; an eighth of it is how far chord and arc part.
  const double way_mm = (to.tip_mm - from.tip_mm).norm();
  bend_mm_ = angle_rad_ * (angle_rad_ * (sweep.box.reach_mm() + way_mm) + 2.0 * way_mm) / 8.0;
  if (bend_mm_ <= 0.5 * SweepProfile::kStraightSkinMm) return;
  way_ = SweptPlate::Way::turning;
  pieces_ = static_cast<std::size_t>(
      std::clamp(std::ceil(std::sqrt(bend_mm_ / (0.5 * SweepProfile::kTurningSkinMm))), 1.0, 1e5));
}

Pose PlateMotion::pose(std::size_t piece) const noexcept {
  if (piece == 0) return from_;
  if (piece >= pieces_) return to_;
  return pose_at(static_cast<double>(piece) / static_cast<double>(pieces_));
}

Pose PlateMotion::pose_at(double share) const noexcept {
  const Mat3 turn = Eigen::AngleAxisd(share * angle_rad_, about_).toRotationMatrix();
  const Vec3 axis = (turn * from_.axis).normalized();
  const Vec3 side = turn * from_.side;
  return {from_.tip_mm + share * (to_.tip_mm - from_.tip_mm), axis, (side - side.dot(axis) * axis).normalized()};
}

}  // namespace spinaltap
