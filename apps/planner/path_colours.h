#pragma once

#include <QColor>
#include <array>
#include <cstddef>

namespace spinaltap {

/// The colour of a path, by its index in the plan: those of Okabe and Ito's palette that stand for no plane.
inline QColor path_colour(std::size_t index) {
  static const std::array<QColor, 4> kColours{QColor(0x56, 0xB4, 0xE9), QColor(0xF0, 0xA2, 0x02),
                                              QColor(0xD6, 0x82, 0xB4), QColor(0xF0, 0xE4, 0x42)};
  return kColours[index % kColours.size()];
}

}  // namespace spinaltap
