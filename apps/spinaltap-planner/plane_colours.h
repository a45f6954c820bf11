#pragma once

#include <QColor>

#include "apps/report/slice_frame.h"

namespace spinaltap {

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

}  // namespace spinaltap
