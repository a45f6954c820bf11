#pragma once

#include "core/base/progress.h"
#include "core/ct/ct_volume.h"
#include "core/drill/drill_path.h"

namespace spinaltap {

struct CorridorOptions {
  double least_length_mm = 35.0;       ///< of bone along the path
  double body_clearance_mm = 7.0;      ///< the target lies at least this deep: in the vertebral body
  double front_clearance_mm = 6.0;     ///< of bone left ahead of the target
  double most_convergence_deg = 35.0;  ///< to either side of straight forward
  double most_inclination_deg = 15.0;  ///< up or down
};

/// The straight way from the back of a vertebra forward into its body that keeps furthest from the bone's surface.
///
/// Only the pedicles join back and body, so the widest such corridor runs through one; ways that enter beside or ahead
/// of the canal, or with more bone behind their entry, do not count. The search is exhaustive over a coarse grid of
/// targets and directions around the patient's anterior (-y). `bone` should have voxels of about 1 mm. Throws Error
/// when there is no such way, and when no canal is seen.
DrillPath widest_corridor(const BoneMask& bone, const DrillBit& bit, const CorridorOptions& options = {},
                          const Progress& progress = {});

}  // namespace spinaltap
