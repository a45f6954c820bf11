#pragma once

#include <vector>

#include "apps/report/slice_frame.h"
#include "core/base/image.h"
#include "core/ct/ct_volume.h"

namespace spinaltap {

struct ContactSheetOptions {
  int max_slices = 20;    ///< evenly chosen from first to last
  int columns = 5;        ///< of slices
  int tile_pixels = 256;  ///< the longer side of a slice in the picture
  HuWindow window{};      ///< a bone window
};

/// The slices of a contact sheet, from first to last: all where there are few, else evenly chosen.
std::vector<int> contact_sheet_slices(int slices, int max);

/// One picture of a CT's slices (k constant), as its grid has them: columns to the right, rows downwards, both at one
/// scale. On each: its number (k, from 0) and place along the normal (mm), letters of the directions at its borders (L
/// left, R right, A anterior, P posterior, S superior, I inferior), and a bar of a round length in mm. Holds nothing
/// that identifies a patient. Throws Error on options out of range.
Image contact_sheet(const CtVolume& ct, const ContactSheetOptions& options = {});

}  // namespace spinaltap
