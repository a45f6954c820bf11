#include "core/tool/drill_path.h"

#include <cmath>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/tool/bit_profile.h"
#include "core/tool/path_curve.h"

namespace spinaltap {

ScrewThread PedicleScrew::thread_or_usual() const { return thread.value_or(usual_thread(diameter_mm)); }

void check_screw(const PedicleScrew& screw) {
  try {
    check_bit(screw.outline());
  } catch (const Error& error) {
    fail_as(ErrorKind::geometry, "screw ", in_quotes(screw.name), ": ", error.what());
  }
  if (screw.thread) {
    try {
      check_thread(*screw.thread, screw.diameter_mm);
    } catch (const Error& error) {
      fail_as(ErrorKind::geometry, "screw ", in_quotes(screw.name), ": ", error.what());
    }
  }
  const auto within = [&](double value, double lowest, double highest, const char* what) {
    if (!(value >= lowest && value <= highest)) {
      fail_as(ErrorKind::geometry, "screw ", in_quotes(screw.name), ": expected ", what, " from ", lowest, " to ",
              highest, ", found ", value);
    }
  };
  const ScrewHead& head = screw.head;
  within(head.diameter_mm, 0.0, 50.0, "a head's diameter (mm)");
  if (head.diameter_mm > 0.0) within(head.length_mm, 0.5 * head.diameter_mm, 100.0, "a head's length (mm)");
  within(head.driver_diameter_mm, 0.0, 50.0, "a driver's diameter (mm)");
  if (!(head.driver_diameter_mm > 0.0)) return;
  within(head.driver_cone_deg, 0.0, 45.0, "the half angle of a driver's cone (degrees)");
  within(head.driver_length_mm, 1.0, 500.0, "a driver's length (mm)");
}

std::optional<BodyBehind> head_of(const DrillPath& path) {
  if (!path.screw || !(path.screw->head.diameter_mm > 0.0)) return std::nullopt;
  const ScrewHead& head = path.screw->head;
  DrillBit outline{head.diameter_mm, head.length_mm, 0.5 * head.diameter_mm, BitShape::round_burr};
  outline.shank_diameter_mm = head.diameter_mm;
  return BodyBehind{outline, {path.target_mm - path.screw->length_mm * path.direction(), path.direction()}};
}

std::optional<BodyBehind> driver_of(const DrillPath& path) {
  if (!path.screw || !(path.screw->head.driver_diameter_mm > 0.0)) return std::nullopt;
  constexpr double kBluntMm = 0.01;  // a frustum begins with a tip
  const ScrewHead& head = path.screw->head;
  const double base_mm =
      head.driver_diameter_mm + 2.0 * head.driver_length_mm * std::tan(head.driver_cone_deg * kDegree);
  DrillBit outline{base_mm, head.driver_length_mm, kBluntMm, BitShape::tapered_screw};
  outline.tip_diameter_mm = head.driver_diameter_mm;
  const double behind_mm = path.screw->length_mm + (head.diameter_mm > 0.0 ? head.length_mm : 0.0);
  return BodyBehind{outline, {path.target_mm - behind_mm * path.direction(), path.direction()}};
}

double DrillPath::length_mm() const { return is_curved() ? PathCurve(*this).length_mm() : chord_mm(); }

double DrillPath::chord_mm() const { return (target_mm - entry_mm).norm(); }

Vec3 DrillPath::direction() const { return (target_mm - entry_mm).normalized(); }

namespace {

/// How far a bit stands out of the hole that its widest place alone leaves in a bend: behind its tip, which follows the
/// path, its axis goes straight on.
double stand_out_mm(const BitProfile& profile, double bend_mm) {
  constexpr int kPlaces = 16;  // of each stretch
  double max_mm = 0.0;
  for (const ProfilePiece& piece : profile.pieces()) {
    for (int n = 0; n <= kPlaces; ++n) {
      const double back_mm = piece.begin_mm + (piece.end_mm - piece.begin_mm) * n / kPlaces;
      const double radius_mm = std::sqrt(std::max(0.0, piece.radius_squared_mm2(back_mm)));
      max_mm = std::max(max_mm, radius_mm + std::hypot(back_mm, bend_mm) - bend_mm - profile.radius_mm());
    }
  }
  return max_mm;
}

void check_curve(const DrillPath& path) {
  const PathCurve curve(path);
  const std::string name = in_quotes(path.name);
  constexpr double kLongestMm = 500.0, kAcrossDeg = 90.0;
  if (!(curve.length_mm() <= kLongestMm)) {
    fail_as(ErrorKind::geometry, "path ", name, ": expected up to ", kLongestMm, " mm along its curve, found ",
            curve.length_mm(), " mm");
  }
  if (!(curve.max_tilt_deg() < kAcrossDeg)) {
    fail_as(ErrorKind::geometry, "path ", name,
            ": expected a curve that goes on from entry to target, found one that turns by ", curve.max_tilt_deg(),
            " degrees from the line between them");
  }
  if (path.screw)
    fail_as(ErrorKind::geometry, "path ", name, ": expected no screw on a curved path: screws are straight");
  if (!(curve.min_radius_mm() > path.bit.radius_mm())) {
    fail_as(ErrorKind::geometry, "path ", name, ": expected bends wider than the bit's radius of ",
            path.bit.radius_mm(), " mm, found one with a radius of ", curve.min_radius_mm(), " mm");
  }
  if (path.bit.is_plate())
    fail_as(ErrorKind::geometry, "path ", name, ": expected no plate on a curved path: plates are straight");
  const double out_mm = stand_out_mm(BitProfile(path.bit), curve.min_radius_mm());
  if (!(out_mm <= kMaxStandOutMm)) {
    fail_as(ErrorKind::geometry, "path ", name, ": expected a bit short enough for its bends, found one of ",
            path.bit.length_mm, " mm that would stand out of its hole by ", out_mm, " mm where the path's radius is ",
            curve.min_radius_mm(), " mm; ", kMaxStandOutMm,
            " mm is allowed: a steerable drill has a short head and a flexible shank");
  }
}

}  // namespace

DrillBit steerable_head() { return {3.0, 3.0, 1.5, BitShape::round_burr}; }

void check_straight(const DrillPath& path, const char* what) {
  if (!path.is_curved()) return;
  fail_as(ErrorKind::geometry, "path ", in_quotes(path.name), ": expected a straight path for ", what,
          ", found a curved one");
}

namespace {

/// What a path of no use may have been given in, by its length.
const char* unit_meant(double length_mm) {
  constexpr double kMetre = 1e3, kMicrometre = 1e-3, kShortMm = 5.0, kLongMm = 300.0;
  const auto is_usual = [&](double mm) { return mm >= kShortMm && mm <= kLongMm; };
  if (is_usual(kMetre * length_mm)) return ": are its points in m?";
  return is_usual(kMicrometre * length_mm) ? ": are its points in µm?" : "";
}

}  // namespace

void check_path(const DrillPath& path) {
  constexpr double kShortestMm = 0.1;
  constexpr double kLongestMm = 500.0;
  if (!path.entry_mm.allFinite() || !path.target_mm.allFinite()) {
    fail_as(ErrorKind::geometry, "path ", in_quotes(path.name), ": entry and target must be finite numbers");
  }
  const double length_mm = path.length_mm();
  if (!(length_mm >= kShortestMm && length_mm <= kLongestMm)) {
    fail_as(ErrorKind::geometry, "path ", in_quotes(path.name), ": expected ", kShortestMm, " to ", kLongestMm,
            " mm from entry to target, found ", length_mm, " mm", unit_meant(length_mm));
  }
  check_bit(path.bit);
  if (path.screw) check_screw(*path.screw);
  if (path.via_mm.size() > kMaxVias) {
    fail_as(ErrorKind::geometry, "path ", in_quotes(path.name), ": expected up to ", kMaxVias,
            " places between entry and target, found ", path.via_mm.size());
  }
  if (path.is_curved()) check_curve(path);
  if (!valid_pose({path.target_mm, path.direction()}, path.bit)) {
    fail_as(ErrorKind::geometry, "path ", in_quotes(path.name),
            ": expected the plate's width to lie across the path, found it along it");
  }
}

PathFrame::PathFrame(const Vec3& origin_mm, const Vec3& direction) : origin_mm_(origin_mm) {
  if (!(direction.norm() > 0.0) || !direction.allFinite() || !origin_mm.allFinite()) {
    fail_as(ErrorKind::geometry, "path frame: expected a finite origin and a direction that is not zero");
  }
  const Vec3 z = direction.normalized();
  const Vec3 x = any_perpendicular(z);
  rotation_.col(0) = x;
  rotation_.col(1) = z.cross(x);
  rotation_.col(2) = z;
}

Vec3 PathFrame::to_path(const Vec3& p_patient) const { return rotation_.transpose() * (p_patient - origin_mm_); }

Vec3 PathFrame::to_patient(const Vec3& p_path) const { return origin_mm_ + rotation_ * p_path; }

Pose PathFrame::to_path(const Pose& pose) const {
  return {to_path(pose.tip_mm), rotation_.transpose() * pose.axis, rotation_.transpose() * pose.side};
}

Pose PathFrame::to_patient(const Pose& pose) const {
  return {to_patient(pose.tip_mm), rotation_ * pose.axis, rotation_ * pose.side};
}

}  // namespace spinaltap
