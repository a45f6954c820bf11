#pragma once

#include "apps/report/label_place.h"
#include "apps/spinaltap-planner/slices/pane_scene.h"

class QPainter;

namespace spinaltap {

/// Every path of the plan: axis, the sections of bit and screw with the slice (filled), their projections (dashed),
/// ends and name; the chosen one strongest and last. The bit that drills takes the place of the chosen path's own.
/// Names keep clear of what `labels` avoids.
void paint_paths(QPainter& painter, const PaneScene& scene, LabelPlacer& labels);

}  // namespace spinaltap
