#pragma once

#include <QColor>
#include <array>
#include <cstddef>

namespace spinaltap {

/// The colour of a path in all panes, by its index in the plan: none that stands for a plane.
inline QColor path_colour(std::size_t index) {
  static const std::array<QColor, 4> kColours{QColor(0x56, 0xB4, 0xE9), QColor(0xF0, 0xA2, 0x02),
                                              QColor(0xD6, 0x82, 0xB4), QColor(0xB3, 0xA6, 0xFF)};
  return kColours[index % kColours.size()];
}

}  // namespace spinaltap
