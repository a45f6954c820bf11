#pragma once

#include <Eigen/Core>

namespace spinaltap {

/// How bone of a CT number looks where it is cut: dark red cancellous bone to white cortex; red, green and blue, 0
/// to 1.
Eigen::Array3d hu_colour(double hu);

}  // namespace spinaltap
