#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/ct/ct_volume.h"
#include "core/ct/label_volume.h"

namespace spinaltap {

/// One level in the picture.
struct PictureLevel {
  int label = 0;                      ///< in the label map
  Vec3 centre_mm = Vec3::Zero();      ///< middle of its body, patient LPS
  bool suspect = false;               ///< drawn dashed, with "?" after its name
  std::vector<std::string> warnings;  ///< as a reader shall see them, without the level's name
};

/// What a picture of a label map shows.
struct LevelsPicture {
  std::vector<PictureLevel> levels;  ///< in any order; other labels of the map are outlined in grey, without a name
  std::optional<int> chosen;         ///< label of the level to show by itself; without: each of three or fewer
  std::optional<Vec3> seed_mm;       ///< marked by a cross, patient LPS
  double pixel_mm = 0.3;             ///< of the slices; coarser where the picture would grow too large
};

/// A picture of levels in a CT, to judge them by. From the left: the column sagittal and coronal, along a surface that
/// bends with the levels' centres; then for each level that is shown by itself its axial, sagittal and coronal slices
/// through its centre, or where there are too many, an axial slice of every level. Outlines have a colour a level
/// (legible to the colour-blind), neighbours never the same. All slices lie as radiologists look at them (see Plane),
/// with letters of the patient's sides and a scale bar. Beyond the CT's border they are dark blue grey. Below: the
/// names, and a line for each level with warnings. A seed's cross lies on both overviews wherever the seed is, and on
/// slices of levels within 5 mm of it. The same input gives the same bits.
/// Throws Error when the map is empty or on another grid than the CT, no level is given, a level's label or the chosen
/// one is not in the map or given twice, or a number is not finite or out of range.
Image levels_picture(const CtVolume& ct, const LabelVolume& labels, const LevelsPicture& what);

}  // namespace spinaltap
