#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/ct/bone_identity.h"
#include "core/tool/drill_bit.h"

namespace spinaltap {

/// The thread of a bone screw, of one outer diameter along its shaft; its core may be a cone. Lengths in mm.
struct ScrewThread {
  double core_diameter_mm = 4.2;      ///< between the threads: the minor diameter, of a cone the one below the head
  double tip_core_diameter_mm = 0.0;  ///< of a conical core where the tip begins; 0: a cylinder
  double pitch_mm = 2.75;             ///< from thread to thread along the axis
  int starts = 1;                     ///< threads side by side: a turn advances the screw by so many pitches
  double crest_mm = 0.2;              ///< width of the thread's outer edge
  double flank_deg = 15.0;            ///< between a flank and the plane across the axis, both flanks alike

  /// How far a turn advances the screw, mm.
  double lead_mm() const;
  /// From core to outer diameter below the head, mm, of a screw of that diameter.
  double depth_mm(double diameter_mm) const;

  bool operator==(const ScrewThread&) const = default;
};

/// The usual thread of a pedicle screw of a diameter: core and pitch are the means of twelve screws of 6 to 7.5 mm in
/// clinical use (Weidling et al. 2022, table 2): 0.65 of the diameter, and 0.43 of it but at most 3 mm.
ScrewThread usual_thread(double diameter_mm);

/// Throws Error on sizes that make no sense for a screw of that diameter. The message begins with the size at fault.
void check_thread(const ScrewThread& thread, double diameter_mm);

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
  std::optional<ScrewThread> thread = {};  ///< none known: see thread_or_usual()

  /// Its own, else usual_thread() of its diameter.
  ScrewThread thread_or_usual() const;
  double radius_mm() const { return 0.5 * diameter_mm; }
  /// The body that the turning thread fills.
  DrillBit outline() const { return {diameter_mm, length_mm, tip_length_mm}; }
};

/// Rejects what check_bit() rejects of its outline, and heads, drivers and threads of sizes that make no sense.
void check_screw(const PedicleScrew& screw);

/// A planned hole: from the entry on the bone's surface to the target inside, straight or, through places between, as a
/// steerable drill goes. PathCurve (core/tool/path_curve.h) is the way itself.
struct DrillPath {
  std::string name;
  Vec3 entry_mm = Vec3::Zero();   ///< patient LPS
  Vec3 target_mm = Vec3::Zero();  ///< patient LPS
  DrillBit bit;
  std::optional<PedicleScrew> screw = {};  ///< that the hole is for; its tip comes to the target
  /// Places that a curved path passes between entry and target, in order, patient LPS; none: a straight path.
  std::vector<Vec3> via_mm = {};
  BoneIdentity bone = {};  ///< that it is planned for; empty: not known

  bool is_curved() const { return !via_mm.empty(); }
  /// Along the path: of a curved one its arc length, which takes some 20 µs to find.
  double length_mm() const;
  /// Unit, from entry to target: of a curved path its chord's, along which the tip nowhere goes.
  Vec3 direction() const;
  /// From entry to target.
  double chord_mm() const;
};

/// Places between entry and target that a path may have.
inline constexpr std::size_t kMaxVias = 32;

/// Rejects points that are not finite, a path shorter than 0.1 mm or longer than 500 mm, and a bad bit or screw. Of
/// curved paths: more than kMaxVias places, neighbours nearer than 0.1 mm, a curve that turns by 90 degrees or more
/// from its chord or is bent tighter than the bit's radius, a bit that is too long for the bend, standing out of the
/// hole behind by more than kMaxStandOutMm, and a screw.
void check_path(const DrillPath& path);

/// How far, at most, a bit in a bend may widen the hole that a short one would leave, mm: its axis is straight.
inline constexpr double kMaxStandOutMm = 0.1;

/// The bit of a curved path where none is said: the head of a steerable drill, a ball of 3 mm.
DrillBit steerable_head();

/// For what is made for straight paths only. Throws Error that names the path and `what`, as in "a rod", where it is
/// curved.
void check_straight(const DrillPath& path, const char* what);

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

  /// Places and poses of the patient (LPS, mm) as path-local ones, mm, and back.
  Vec3 to_path(const Vec3& p_patient) const;
  Vec3 to_patient(const Vec3& p_path) const;
  Pose to_path(const Pose& pose) const;
  Pose to_patient(const Pose& pose) const;
  /// Columns: the path's x, y and z axes in patient LPS.
  const Mat3& axes() const { return rotation_; }

 private:
  Vec3 origin_mm_ = Vec3::Zero();
  Mat3 rotation_ = Mat3::Identity();  ///< columns: the path's x, y and z axes in patient LPS
};

}  // namespace spinaltap
