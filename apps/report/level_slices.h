#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "apps/report/bent_slice.h"
#include "apps/report/label_outline.h"
#include "apps/report/levels_picture.h"

namespace spinaltap {

/// Ground of pictures of levels, and what lies beyond the CT in them.
constexpr Colour kPictureGround{40, 44, 60};

/// Of the n-th level from the head: Okabe & Ito's, without those too dark for a CT; neighbouring levels have different
/// ones.
Colour level_colour(std::size_t n);

/// A slice with its outlines, and the mapping between its pixels and the patient.
struct LevelSlice {
  Image image;
  BentFrame frame;
  std::string caption;
};

/// Room around a slice for letters and the scale bar, pixels.
constexpr int kSliceBorder = 22;

/// The slice in a border that holds the letters of the patient's sides and a scale bar, so that they hide nothing.
Image framed(const LevelSlice& slice);

/// Draws the slices that a picture of levels is made of. Keeps references to the CT and the map.
class LevelSlices {
 public:
  /// Throws as levels_picture() does.
  LevelSlices(const CtVolume& ct, const LabelVolume& labels, const LevelsPicture& what);

  /// The levels, from the head down.
  const std::vector<PictureLevel>& levels() const { return levels_; }
  /// "T9", "T9 ?" where it is suspect, "LABEL 3" where the map has no name.
  std::string title(const PictureLevel& level) const;
  /// level_colour() of its place among them.
  Colour colour(const PictureLevel& level) const;

  /// The whole column, bent through the levels' centres, names beside the bodies.
  LevelSlice overview(Plane plane) const;
  /// Through a level's centre, cropped to its bone.
  LevelSlice level_slice(Plane plane, const PictureLevel& level, double pixel_mm) const;

 private:
  Image draw(const BentFrame& frame) const;
  void draw_seed(LevelSlice& slice, double max_depth_mm) const;
  void draw_names(LevelSlice& slice, const LabelPixels& pixels, Plane plane) const;
  LabelPixels pixels_of(const BentFrame& frame) const;
  double room_for_names_mm(double pixel_mm) const;

  const CtVolume& ct_;
  const LabelVolume& labels_;
  LevelsPicture what_;
  std::vector<PictureLevel> levels_;
  std::map<int, Box3> boxes_mm_;  ///< by label, of all in the map, patient LPS
};

}  // namespace spinaltap
