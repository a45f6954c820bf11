#pragma once

#include <span>

#include "core/ct/level.h"
#include "core/plan/bone_shape.h"
#include "core/plan/instrument.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

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

/// Of what stays in place: the path's screw with its head or, where it has none, the bit from the entry on. A disc
/// that it pierces on its way is no bone. Right to 0.1 mm; where the axis itself enters the other, to 0.25 mm, as far
/// as places of its surface are apart. Throws Error as check_path() does.
NeighbourContact neighbour_contact(std::span<const Neighbour> neighbours, const DrillPath& path);

/// The contact in words, a warning; for a contact of over kTouchMm.
Finding finding_of(const NeighbourContact& contact, const DrillPath& path);

}  // namespace spinaltap
