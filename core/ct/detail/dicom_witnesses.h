#pragma once

#include <string>
#include <vector>

#include "core/ct/detail/dicom_stack.h"

namespace spinaltap {

/// Headers say much twice: what a stack's positions, sizes and padding are against is a line each.
/// - SliceLocation or InstanceNumber count evenly, but not in the order of the positions: slices changed places.
/// - SliceLocation counts other steps than the positions, or slices are far thinner or thicker than their distance.
/// - PatientOrientation names other sides than ImageOrientationPatient.
/// - ReconstructionDiameter is not what PixelSpacing and the size of the picture make; a scanner's axial
///   pixels are not square.
/// - Slices drift sideways where GantryDetectorTilt does not say so, or along rows of pixels, as no gantry tilts.
/// - PixelPaddingValue is a CT number that tissue has.
/// - There are more bytes of plain pixels than the sizes take.
std::vector<std::string> contradictions_of(const DicomStack& stack);

}  // namespace spinaltap
