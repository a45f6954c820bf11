#pragma once

#include <QColor>

#include "apps/report/slice_frame.h"

namespace spinaltap {

/// The colour that stands for a plane in all panes: of Okabe and Ito's palette, told apart by the colour-blind too.
inline QColor plane_colour(Plane plane) {
  switch (plane) {
    case Plane::kAxial:
      return QColor(0xD5, 0x5E, 0x00);
    case Plane::kCoronal:
      return QColor(0x00, 0x9E, 0x73);
    case Plane::kSagittal:
      return QColor(0x00, 0x72, 0xB2);
  }
  return {};
}

}  // namespace spinaltap
