#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/ct/ct_volume.h"
#include "tests/support/hand_made_dicom.h"

namespace spinaltap::test {

/// A sound CT series, slice by slice from its first, and what a reader must find in it.
struct SoundSeries {
  std::string name;
  std::vector<HandMadeDicom> files;
  CtVolume ground_truth;
};

/// Trunks, small, in the ways that scanners store them: signed; unsigned of 12 bits with padding; tilted in its plane,
/// with few attributes, implicit.
std::vector<SoundSeries> sound_series();

/// What was made of a series' header.
struct Corruption {
  std::string attribute;  ///< "RescaleSlope"
  std::string kind;       ///< "dropped", "emptied", "swapped", "shifted", "copied", "mixed", "garbled"
  std::string scope;      ///< "one file", "all files", "some files"
  std::string change;     ///< what stood there and what stands there, of the first file that was changed
};

/// Spoils one attribute of one file, some or all, as the seed has it; a change that changes no byte is not made.
Corruption corrupt(SoundSeries& series, std::uint64_t seed);

}  // namespace spinaltap::test
