#include "apps/planner/slices/pane_colours.h"

#include "core/base/error.h"

namespace spinaltap {

QColor plane_colour(Plane plane) {
  switch (plane) {
    case Plane::kAxial:
      return {0xf0, 0x64, 0x1e};
    case Plane::kCoronal:
      return {0x00, 0xb8, 0x86};
    case Plane::kSagittal:
      return {0xf0, 0xe4, 0x42};
  }
  fail("unknown plane");
}

}  // namespace spinaltap
