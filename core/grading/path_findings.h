#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/anatomy/landmarks.h"
#include "core/base/geometry.h"
#include "core/ct/ct_volume.h"
#include "core/ct/level.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

class BoneShape;

/// How a path is turned, as surgeons say it. Degrees.
struct PathAngles {
  double convergence_deg = 0.0;  ///< towards the midsagittal plane, seen from above; negative: away from it
  double inclination_deg = 0.0;  ///< upward, of the transverse plane; negative: downward
};

/// Of a direction (unit, patient LPS) from the back to the front. `axes`: Landmarks::axes for the vertebra's own
/// planes, the identity for the patient's. `is_left`: of a path on the patient's left.
PathAngles path_angles(const Vec3& direction, const Mat3& axes, bool is_left);

/// Where something lies as seen from a path through a pedicle.
enum class PathSide { medial, lateral, cranial, caudal, anterior };
/// "medial", "lateral", "cranial", "caudal", "anterior".
const char* name_of(PathSide side);

/// Parts of an instrument: what is graded (`tool`), the way that it came on from behind the entry opening (`way_in`: as
/// wide as the tool, it cuts what it meets), and what lies behind it in place.
enum class InstrumentPart { tool, way_in, head, driver };
/// "screw" or "bit" for the tool, by whether the path has a screw; "way in", "head", "driver".
std::string name_of(InstrumentPart part, const DrillPath& path);

/// Where an instrument touches a vertebra that it should not touch there.
struct Finding {
  InstrumentPart part = InstrumentPart::tool;
  VertebraPart structure = VertebraPart::lamina;
  double depth_mm = 0.0;         ///< how deep bone lies in the part, or the part stands out of bone
  double at_mm = 0.0;            ///< where along the path; negative: behind the entry
  Vec3 place_mm = Vec3::Zero();  ///< patient LPS
  bool is_warning = false;       ///< else worth a word only
  std::string words;             ///< a sentence without a full stop
};

/// How the instrument behind the entry meets the vertebra.
struct InstrumentContacts {
  std::vector<Finding> findings;  ///< of way_in, head and driver: a part and a structure each, the deepest first
  /// From the head's and the driver's surface to bone; negative by how deep bone lies in them. Infinite without one.
  double head_clearance_mm = std::numeric_limits<double>::infinity();
  double driver_clearance_mm = std::numeric_limits<double>::infinity();
  double cut_behind_mm = 0.0;    ///< how deep bone lies in the way in
  double joint_depth_mm = 0.0;   ///< how deep the joint surface lies in screw or head
  bool is_beside_joint = false;  ///< screw or head lie in the articular process beside its joint surface
};

/// Touches below this are no finding: a head rests on bone, and a baked surface is known no better.
inline constexpr double kTouchMm = 0.5;
/// Heads pressing deeper than this into bone are a warning; up to there a seat is cut for them in passing.
inline constexpr double kSeatMm = 2.0;

/// Another vertebra of the patient.
struct Neighbour {
  Level level = Level::kNone;
  const BoneShape* shape = nullptr;
};

/// Where an instrument in one vertebra stands deepest in another one.
struct NeighbourContact {
  double depth_mm = 0.0;       ///< how deep the other's bone lies in it, at most its radius; 0: it does not touch it
  Level level = Level::kNone;  ///< of the other; of no meaning without a contact, as the next ones
  InstrumentPart part = InstrumentPart::tool;  ///< that does: the tool or the head
  double at_mm = 0.0;                          ///< where along the path; negative: behind the entry
  Vec3 place_mm = Vec3::Zero();
};

/// Of a bone: where it is open whether there is bone, or whose it is.
struct DoubtfulBone {
  std::optional<MadeUpSlices> made_up = {};
  std::vector<Vec3> unsure_mm = {};  ///< places of bone that may be another vertebra's or a rib's, patient LPS

  bool is_empty() const { return !made_up && unsure_mm.empty(); }
};

/// Something that a path's grade leans on and that may not be so.
struct PathDoubt {
  enum class Kind {
    made_up_slices,  ///< the tool lies in slices that were filled in
    unsure_bone      ///< beside the tool is bone that may be another's
  };
  Kind kind = Kind::made_up_slices;
  double length_mm = 0.0;        ///< of the path where it is so
  double depth_mm = 0.0;         ///< of the first such place, from the entry
  Vec3 place_mm = Vec3::Zero();  ///< there, patient LPS
  double without_mm = 0.0;       ///< of unsure bone: clearance that is left where it is another's; negative: breach
};

}  // namespace spinaltap
