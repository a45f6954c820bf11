#pragma once

#include <span>
#include <string>

#include "core/base/progress.h"
#include "core/ct/ct_volume.h"
#include "core/ct/level.h"
#include "core/segment/warning_metadata.h"
#include "core/surface/label_edges.h"

namespace spinaltap {

/// What a label's edge says of it: mirrored, moved against its CT, or of another one; nothing where it lies on bone's
/// edges, or has too few places to say. `step_mm`: the CT's largest voxel step.
LevelWarnings warnings_of_edges(const LabelEdges& edges, double step_mm, Level level);

/// Those, and what was said of the place of the map's voxels.
LevelWarnings warnings_of_label(const CtVolume& ct, const BoneMask& mask, Level level,
                                std::span<const std::string> of_place, const Progress& progress);

/// Adds that the CT's border cuts the bone, where it does.
void warn_of_border(const BoneMask& mask, LevelWarnings& warnings);

}  // namespace spinaltap
