#pragma once

#include <QColor>

#include <array>
#include <cstddef>

#include "apps/report/slice_frame.h"

namespace spinaltap {

/// The colour of a path in all panes, by its index in the plan: none that stands for a plane.
inline QColor path_colour(std::size_t index) {
  static const std::array<QColor, 4> kColours{QColor(0x56, 0xB4, 0xE9), QColor(0xF0, 0xA2, 0x02),
                                              QColor(0xD6, 0x82, 0xB4), QColor(0xB3, 0xA6, 0xFF)};
  return kColours[index % kColours.size()];
}

/// By which a plane is known in all panes: red, green and yellow, as in 3D Slicer; bright ones, since CT slices are
/// dark.
inline QColor plane_colour(Plane plane) {
  switch (plane) {
    case Plane::kAxial:
      return {0xf0, 0x64, 0x1e};
    case Plane::kCoronal:
      return {0x00, 0xb8, 0x86};
    case Plane::kSagittal:
      return {0xf0, 0xe4, 0x42};
  }
  return {};
}

// Okabe & Ito's colours for all kinds of colour vision; bright ones, since CT slices are dark. The same as in reports.
inline constexpr QRgb kScrewRgb = 0xffcc79a7;   ///< a path's screw
inline constexpr QRgb kDrillRgb = 0xffe69f00;   ///< the bit while it drills
inline constexpr QRgb kEntryRgb = 0xfff0e442;   ///< entry's handle
inline constexpr QRgb kTargetRgb = 0xffff8a3d;  ///< target's handle
inline constexpr QRgb kTextRgb = 0xfff2f2f2;
inline constexpr QRgb kEmptyRgb = 0xff15181b;  ///< of a pane without a picture
inline constexpr QRgb kHoleRgb = 0xffb6ff5c;   ///< walls of drilled holes: none of theirs, since those are all taken

}  // namespace spinaltap
