#pragma once

#include <span>

#include "core/anatomy/bone_shape.h"
#include "core/ct/level.h"
#include "core/grading/instrument.h"
#include "core/grading/path_findings.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// Of what stays in place: the path's screw with its head or, where it has none, the bit from the entry on. A disc
/// that it pierces on its way is no bone. Right to 0.1 mm; where the axis itself enters the other, to 0.25 mm, as far
/// as places of its surface are apart. Throws Error as check_path() does.
NeighbourContact neighbour_contact(std::span<const Neighbour> neighbours, const DrillPath& path);

/// The contact in words, a warning; for a contact of over kTouchMm.
Finding finding_of(const NeighbourContact& contact, const DrillPath& path);

}  // namespace spinaltap
