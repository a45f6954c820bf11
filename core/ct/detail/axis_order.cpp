#include "core/ct/detail/axis_order.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace spinaltap {
namespace {

/// For each of i, j and k, which of the old axes it becomes, and whether that turns round.
struct AxisOrder {
  std::array<int, 3> from{0, 1, 2};
  std::array<bool, 3> turned{false, false, false};
};

AxisOrder order_of(const Mat3& directions) {
  AxisOrder order;
  std::array<int, 3> tried{0, 1, 2};
  double most = -1.0;
  do {
    double sum = 0.0;
    for (int axis = 0; axis < 3; ++axis) sum += std::abs(directions(axis, tried[static_cast<std::size_t>(axis)]));
    if (sum > most + 1e-9) {
      most = sum;
      order.from = tried;
    }
  } while (std::next_permutation(tried.begin(), tried.end()));
  Mat3 ordered;
  for (int axis = 0; axis < 3; ++axis) {
    const auto n = static_cast<std::size_t>(axis);
    order.turned[n] = directions(axis, order.from[n]) < 0.0;
    ordered.col(axis) = directions.col(order.from[n]) * (order.turned[n] ? -1.0 : 1.0);
  }
  if (ordered.determinant() < 0.0) {
    Eigen::Index least = 0;
    ordered.diagonal().minCoeff(&least);
    bool& turned = order.turned[static_cast<std::size_t>(least)];
    turned = !turned;
  }
  return order;
}

}  // namespace

CtVolume ordered_as_lps(const CtVolume& ct) {
  const AxisOrder order = order_of(ct.geometry.directions);
  GridGeometry geometry = ct.geometry;
  Vec3 first_index = Vec3::Zero();
  std::array<std::ptrdiff_t, 3> step{};
  std::ptrdiff_t start = 0;
  const std::array<std::ptrdiff_t, 3> strides{1, ct.geometry.size[0],
                                              static_cast<std::ptrdiff_t>(ct.geometry.size[0]) * ct.geometry.size[1]};
  for (std::size_t n = 0; n < 3; ++n) {
    const auto from = static_cast<std::size_t>(order.from[n]);
    const int last = ct.geometry.size[from] - 1;
    const double sign = order.turned[n] ? -1.0 : 1.0;
    geometry.size[n] = ct.geometry.size[from];
    geometry.spacing_mm[static_cast<Eigen::Index>(n)] = ct.geometry.spacing_mm[order.from[n]];
    geometry.directions.col(static_cast<Eigen::Index>(n)) = sign * ct.geometry.directions.col(order.from[n]);
    if (order.turned[n]) first_index[order.from[n]] = last;
    step[n] = (order.turned[n] ? -1 : 1) * strides[from];
    if (order.turned[n]) start += last * strides[from];
  }
  geometry.origin_mm = ct.geometry.to_patient(first_index);
  std::vector<std::int16_t> hu(ct.hu.size());
  std::size_t out = 0;
  for (std::ptrdiff_t k = 0; k < geometry.size[2]; ++k) {
    for (std::ptrdiff_t j = 0; j < geometry.size[1]; ++j) {
      const std::ptrdiff_t row = start + k * step[2] + j * step[1];
      for (std::ptrdiff_t i = 0; i < geometry.size[0]; ++i)
        hu[out++] = ct.hu[static_cast<std::size_t>(row + i * step[0])];
    }
  }
  return make_ct_volume(geometry, std::move(hu));
}

}  // namespace spinaltap
