#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/ct/ct_volume.h"

namespace spinaltap {

/// Where a slice of a stack lies against the first one, mm.
struct SlicePlace {
  double along_mm = 0.0;                                  ///< along the normal
  Eigen::Vector2d sideways_mm = Eigen::Vector2d::Zero();  ///< along columns' and rows' growth
};

/// Resamples parallel slices, which may be shifted sideways and stand at unequal steps, onto an orthogonal grid with
/// the step `step_mm`. `slices`: size, first position, pixel spacing and directions of the stack; `hu`: its values.
///
/// Within a slice by cubic convolution (Keys 1981, a = -0.5), which the sideways shift calls for; between slices, where
/// their steps call for it, linearly. A slice that needs neither keeps its values bit for bit. The grid has the first
/// slice's pixels and reaches as far as any slice; beyond a slice's own border is air, -1024 HU.
/// Throws Error where the grid would hold over four times as many voxels as the slices.
CtVolume resample_stack(const GridGeometry& slices, std::span<const SlicePlace> places, double step_mm,
                        std::span<const std::int16_t> hu, const Progress& progress = {});

}  // namespace spinaltap
