#pragma once

#include <QColor>

namespace spinaltap {

// Okabe & Ito's colours for all kinds of colour vision; bright ones, since CT slices are dark. The same as in reports.
inline constexpr QRgb kScrewRgb = 0xffcc79a7;   ///< a path's screw
inline constexpr QRgb kDrillRgb = 0xffe69f00;   ///< the bit while it drills
inline constexpr QRgb kEntryRgb = 0xfff0e442;   ///< entry's handle
inline constexpr QRgb kTargetRgb = 0xffff8a3d;  ///< target's handle
inline constexpr QRgb kTextRgb = 0xfff2f2f2;
inline constexpr QRgb kEmptyRgb = 0xff15181b;  ///< of a pane without a picture
inline constexpr QRgb kHoleRgb = 0xffb6ff5c;   ///< walls of drilled holes: none of theirs, since those are all taken

}  // namespace spinaltap
