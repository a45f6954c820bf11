#include "core/base/hu_colour.h"

#include <algorithm>

namespace spinaltap {

Eigen::Array3d hu_colour(double hu) {
  constexpr double kCancellousHu = -50.0;
  constexpr double kCortexHu = 800.0;
  const Eigen::Array3d cancellous(0.62, 0.20, 0.16);
  const Eigen::Array3d cortex(1.0, 0.97, 0.90);
  const double t = std::clamp((hu - kCancellousHu) / (kCortexHu - kCancellousHu), 0.0, 1.0);
  return cancellous + t * (cortex - cancellous);
}

}  // namespace spinaltap
