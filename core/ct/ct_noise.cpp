#include "core/ct/ct_noise.h"

#include <algorithm>
#include <cmath>

namespace spinaltap {
namespace {

constexpr std::int16_t kLowestSoftHu = -200, kHighestSoftHu = 300;

/// Of what a plane leaves in a square of a slice; nothing where it holds other than soft tissue.
std::optional<double> deviation_in(const CtVolume& ct, int first_i, int first_j, int k, int side_i, int side_j) {
  const double middle_i = 0.5 * (side_i - 1), middle_j = 0.5 * (side_j - 1);
  double sum = 0.0, squares = 0.0, along_i = 0.0, along_j = 0.0, squares_i = 0.0, squares_j = 0.0;
  for (int j = 0; j < side_j; ++j) {
    for (int i = 0; i < side_i; ++i) {
      const std::int16_t hu = ct.at(first_i + i, first_j + j, k);
      if (hu <= kLowestSoftHu || hu >= kHighestSoftHu) return std::nullopt;
      const double value = hu;
      sum += value;
      squares += value * value;
      along_i += value * (i - middle_i);
      along_j += value * (j - middle_j);
      squares_i += (i - middle_i) * (i - middle_i);
      squares_j += (j - middle_j) * (j - middle_j);
    }
  }
  constexpr double kOfPlane = 3.0;
  const double count = static_cast<double>(side_i) * side_j;
  const double left = squares - sum * sum / count - along_i * along_i / squares_i - along_j * along_j / squares_j;
  return std::sqrt(std::max(0.0, left) / (count - kOfPlane));
}

}  // namespace

std::optional<double> ct_noise_hu(const CtVolume& ct) {
  constexpr double kSideMm = 8.0;
  constexpr int kFewestVoxels = 4;
  constexpr std::size_t kMaxSquares = 20000;
  const GridGeometry& geometry = ct.geometry;
  const auto side_of = [&](Eigen::Index axis) {
    return std::max(kFewestVoxels, static_cast<int>(std::lround(kSideMm / geometry.spacing_mm[axis])));
  };
  const int side_i = side_of(0), side_j = side_of(1);
  const int across = geometry.size[0] / side_i, down = geometry.size[1] / side_j;
  if (across < 1 || down < 1) return std::nullopt;
  const std::size_t squares =
      static_cast<std::size_t>(across) * static_cast<std::size_t>(down) * static_cast<std::size_t>(geometry.size[2]);
  const std::size_t stride = squares / kMaxSquares + 1;
  std::vector<double> deviations;
  for (std::size_t n = 0; n < squares; n += stride) {
    const auto square = static_cast<int>(n % (static_cast<std::size_t>(across) * static_cast<std::size_t>(down)));
    const auto k = static_cast<int>(n / (static_cast<std::size_t>(across) * static_cast<std::size_t>(down)));
    const std::optional<double> found =
        deviation_in(ct, square % across * side_i, square / across * side_j, k, side_i, side_j);
    if (found) deviations.push_back(*found);
  }
  if (deviations.empty()) return std::nullopt;
  const auto third = deviations.begin() + static_cast<std::ptrdiff_t>(deviations.size() / 3);
  std::nth_element(deviations.begin(), third, deviations.end());
  return *third;
}

}  // namespace spinaltap
