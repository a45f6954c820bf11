#pragma once

#include <gdcmTransferSyntax.h>

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "core/ct/ct_volume.h"

namespace spinaltap::test {

/// A small CT series, made with GDCM's writer, and what a reader must find in it.
struct MadeSeries {
  struct File {
    std::string name;
    std::string bytes;
  };
  std::string name;  ///< in words
  std::vector<File> files;
  CtVolume ground_truth;
  int tolerance_hu = 0;  ///< above 0 for lossy compression

  void write(const std::filesystem::path& folder) const;
};

/// How a series is to be made.
struct SeriesRecipe {
  std::string name;
  gdcm::TransferSyntax::TSType syntax = gdcm::TransferSyntax::ExplicitVRLittleEndian;
  int bits_allocated = 16;
  int bits_stored = 16;
  bool is_signed = true;
  int slope = 1;
  int intercept = 0;
  bool is_enhanced = false;   ///< one file of many frames, with functional groups
  bool shares_groups = true;  ///< orientation, spacing and rescaling stand once, not with each frame
  bool has_padding = false;   ///< the corners of each slice hold PixelPaddingValue
  Mat3 directions = Mat3::Identity();
  int tolerance_hu = 0;

  friend void PrintTo(const SeriesRecipe& recipe, std::ostream* out) { *out << recipe.name; }
};

/// Soft tissue with a bright, textured ball: 20 x 16 x 6 voxels of 0.5 x 0.75 x 2 mm, every HU a multiple of `slope`
/// above `intercept` and within what `bits_stored` bits hold.
MadeSeries make_series(const SeriesRecipe& recipe);

/// Every kind of series that the reader promises to read.
std::vector<SeriesRecipe> every_kind_of_series();

}  // namespace spinaltap::test
