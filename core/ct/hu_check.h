#pragma once

#include <string>
#include <vector>

#include "core/ct/ct_volume.h"

namespace spinaltap {

/// What a CT's values say of their unit.
struct HuCheck {
  std::vector<std::string> warnings;  ///< why they may be no Hounsfield units, with the likely cause, a line each
  bool shows_tissue = false;          ///< soft tissue, and air or fat, lie where Hounsfield units have them
};

/// Judges whether values are Hounsfield units: water is 0, fat -120 to -60, soft tissue 20 to 80, air -1000, cortical
/// bone 500 to 2000. Values of one number that fill much of the picture (padding, the outside of a mask, clamped air)
/// count as no tissue, so that masked and cropped CTs, CTs with metal and those of 12 bits are left alone.
/// From a million voxels at most, evenly spaced, and pairs of neighbouring slices; the same at any number of threads.
HuCheck check_hu(const CtVolume& ct);

}  // namespace spinaltap
