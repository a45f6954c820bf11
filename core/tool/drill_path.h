#pragma once

#include <optional>
#include <string>

#include "core/base/geometry.h"
#include "core/tool/drill_bit.h"

namespace spinaltap {

/// What sits behind a screw's thread: a polyaxial head, round below, with its tulip in line with the screw, and the
/// driver that turns it, a cone that widens backwards for the hand's room. Lengths in mm.
struct ScrewHead {
  double diameter_mm = 12.5;         ///< of the tulip; 0: the screw has no head that counts
  double length_mm = 15.0;           ///< from its underside to the tulip's end
  double driver_diameter_mm = 10.0;  ///< where it leaves the tulip; 0: none that counts
  double driver_cone_deg = 4.0;      ///< half the angle at which it widens
  double driver_length_mm = 80.0;
};

/// A screw for a pedicle. Lengths in mm.
struct PedicleScrew {
  std::string name;            ///< as its maker or its table calls it
  double diameter_mm = 6.5;    ///< over the thread
  double length_mm = 45.0;     ///< from under the head to the tip
  double tip_length_mm = 4.0;  ///< of the cone at the tip, in length_mm
  ScrewHead head = {};

  double radius_mm() const { return 0.5 * diameter_mm; }
  /// The body that the turning thread fills.
  DrillBit outline() const { return {diameter_mm, length_mm, tip_length_mm}; }
};

/// Rejects what check_bit() rejects of its outline, and heads and drivers of sizes that make no sense.
void check_screw(const PedicleScrew& screw);

/// A straight planned hole: from the entry on the bone's surface to the target inside.
struct DrillPath {
  std::string name;
  Vec3 entry_mm = Vec3::Zero();   ///< patient LPS
  Vec3 target_mm = Vec3::Zero();  ///< patient LPS
  DrillBit bit;
  std::optional<PedicleScrew> screw = {};  ///< that the hole is for; its tip comes to the target

  double length_mm() const;
  /// Unit, from entry to target.
  Vec3 direction() const;
};

/// Rejects points that are not finite, a path shorter than 0.1 mm or longer than 500 mm, and a bad bit or screw.
void check_path(const DrillPath& path);

/// A body of revolution behind a path's entry once its tool is in place: outline and pose, patient LPS.
struct BodyBehind {
  DrillBit outline;
  Pose pose;
};

/// A screw's head in place: its tip at the target, its underside `screw->length_mm` behind that. Nothing without a
/// screw, or where it has no head; likewise its driver.
std::optional<BodyBehind> head_of(const DrillPath& path);
std::optional<BodyBehind> driver_of(const DrillPath& path);

/// Path-local coordinates: the origin where the point volume starts, z along the path, mm. Small numbers near the path
/// keep their precision wherever the patient lies (the paper's section 9.4.4).
class PathFrame {
 public:
  PathFrame() = default;
  /// `origin_mm` in patient LPS; `direction` need not be a unit vector but must not be zero.
  PathFrame(const Vec3& origin_mm, const Vec3& direction);
  /// With the patient's own axes.
  explicit PathFrame(const Vec3& origin_mm) : origin_mm_(origin_mm) {}

  Vec3 to_path(const Vec3& p_patient) const;
  Vec3 to_patient(const Vec3& p_path) const;
  Pose to_path(const Pose& pose) const;
  Pose to_patient(const Pose& pose) const;

 private:
  Vec3 origin_mm_ = Vec3::Zero();
  Mat3 rotation_ = Mat3::Identity();  ///< columns: the path's x, y and z axes in patient LPS
};

}  // namespace spinaltap
