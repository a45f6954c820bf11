#pragma once

#include <vector>

#include "core/base/statistics.h"
#include "core/ct/detail/dicom_header.h"
#include "core/ct/detail/slice_stack.h"
#include "core/ct/dicom_read.h"
#include "core/ct/grid_geometry.h"

namespace spinaltap {

/// Slices in the order in which they fill a volume.
struct DicomStack {
  /// Of the slices; where they do not fill a grid (see `needs_resampling`), that of the first, with their mean step.
  GridGeometry geometry;
  std::vector<DicomHeader> slices;  ///< geometry.size[2] of them, along the normal
  std::vector<SlicePlace> places;   ///< of each slice, against the first
  bool needs_resampling = false;    ///< slices drift sideways, or their steps differ
  std::string note;                 ///< what was assumed of the steps; empty: nothing
};

/// Sorts slices of one size by position along their normal (columns' direction x rows' direction) and derives the grid.
/// The step comes from the positions: SliceThickness is not the step. Slices that drift sideways evenly (a tilted
/// gantry) are to be resampled; with `resample` also unequal steps, gaps of at most 6 mm, and uneven drift.
/// Throws Error on fewer than two slices, a doubled slice, what is left of the above, and values out of range.
DicomStack stack_slices(std::vector<DicomHeader> slices, bool resample = false);

/// Along the slices' normal, patient LPS, mm: slabs of a resampled stack that none of its slices shows, a step less
/// than each gap of over one and a half steps.
std::vector<Interval> made_up_slabs(const DicomStack& stack);

/// Throws Error where positions or orientation are missing, or there are fewer than two slices.
StackLayout measure_stack(const std::vector<DicomHeader>& slices);

}  // namespace spinaltap
