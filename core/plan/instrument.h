#pragma once

#include <limits>
#include <string>
#include <vector>

#include "core/plan/vertebra_parts.h"
#include "core/plan/wall_distance.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

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

/// Measures all that lies behind the entry. `opening_mm`: so far behind the entry bone that slants belongs to the entry
/// opening (see grade.h). Clearances beyond `reach_mm` are infinite. Right to 0.05 mm.
InstrumentContacts instrument_contacts(const WallDistance& walls, const DrillPath& path, double opening_mm,
                                       double reach_mm = 25.0);

/// How much behind where a tool's axis enters bone its entry opening may go on: a plane surface at 50 degrees to the
/// axis is pierced by the tool's last place at 1.2 radii; half a millimetre more for the bone's roughness.
double opening_limit_mm(double tool_radius_mm);

}  // namespace spinaltap
