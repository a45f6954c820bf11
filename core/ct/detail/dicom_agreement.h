#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/ct/detail/dicom_header.h"

namespace spinaltap {

/// What slices of one stack say otherwise than most of them, where most agree: slope, intercept, sign, bits and
/// padding. One line each. Series in which each slice has a rescaling of its own are left alone.
std::vector<std::string> disagreements_of(std::span<const DicomHeader> slices);

/// Whether a slice has this RescaleType.
bool has_rescale_type(std::span<const DicomHeader> slices, const char* type);

}  // namespace spinaltap
