#pragma once

#include "core/ct/label_volume.h"
#include "core/phantom/spine.h"

namespace spinaltap {

/// The true label map of a grid: each voxel has the label of the body that holds its centre, 0 where none does. Levels
/// have VerSe's numbers and names, all ribs are kRibLabel, "rib", and all
/// other bones kOtherBoneLabel, "other bone". The same at any number of threads.
LabelVolume true_labels(const Spine& spine, const GridGeometry& geometry);

}  // namespace spinaltap
