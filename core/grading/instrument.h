#pragma once

#include <limits>
#include <string>
#include <vector>

#include "core/anatomy/vertebra_parts.h"
#include "core/anatomy/wall_distance.h"
#include "core/grading/path_findings.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// Measures all that lies behind the entry. `opening_mm`: so far behind the entry bone that slants belongs to the entry
/// opening (see grade.h). Clearances beyond `reach_mm` are infinite. Right to 0.05 mm.
InstrumentContacts instrument_contacts(const WallDistance& walls, const DrillPath& path, double opening_mm,
                                       double reach_mm = 25.0);

/// How much behind where a tool's axis enters bone its entry opening may go on: a plane surface at 50 degrees to the
/// axis is pierced by the tool's last place at 1.2 radii; half a millimetre more for the bone's roughness.
double opening_limit_mm(double tool_radius_mm);

}  // namespace spinaltap
