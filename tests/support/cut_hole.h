#pragma once

#include "vdb/remaining/hole_cutter.h"

namespace spinaltap::test {

/// The bone without what a bit took on its way from one pose straight to another.
inline BoneModel without_hole(const BoneModel& bone, const DrillBit& bit, const Pose& start, const Pose& end) {
  const DrilledHole hole{bit, {{start, end}}};
  return without_holes(bone, {&hole, 1});
}

}  // namespace spinaltap::test
