#pragma once

#include <vector>

#include "core/ct/dicom_header.h"
#include "core/ct/grid_geometry.h"

namespace spinaltap {

/// Slices in the order in which they fill a volume.
struct DicomStack {
  GridGeometry geometry;
  std::vector<DicomHeader> slices;  ///< geometry.size[2] of them, k upwards
};

/// Sorts slices of one size by position along their normal (columns' direction x rows' direction) and derives the grid.
/// The step comes from the positions: SliceThickness is not the step. Throws Error on fewer than two slices, a missing
/// or doubled slice, unequal steps or spacing, slices that drift sideways (a tilted gantry), and values out of range.
DicomStack stack_slices(std::vector<DicomHeader> slices);

}  // namespace spinaltap
