#include "core/base/hu_colour.h"

#include <algorithm>

namespace spinaltap {

Eigen::Array3d hu_colour(double hu) {
  constexpr double kMarrowHu = -50.0;
  constexpr double kCortexHu = 800.0;
  const Eigen::Array3d marrow(0.62, 0.20, 0.16);
  const Eigen::Array3d cortex(1.0, 0.97, 0.90);
  const double t = std::clamp((hu - kMarrowHu) / (kCortexHu - kMarrowHu), 0.0, 1.0);
  return marrow + t * (cortex - marrow);
}

}  // namespace spinaltap
