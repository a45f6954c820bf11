#include "core/rbf/detail/lagrange_grid.h"

#include <algorithm>
#include <array>

namespace spinaltap::detail {
namespace {

using Row = std::array<double, kMaxOrder>;

/// out[.., r, ..] += sum_c m(r, c) in[.., c, ..] along one axis of an n x n x n array; `transposed` swaps r and c.
void along_axis(int n, std::size_t stride, const double* matrix, bool transposed, const double* in, double* out) {
  const auto size = static_cast<std::size_t>(n);
  const std::size_t count = size * size * size;
  for (std::size_t block = 0; block < count; block += stride * size) {
    for (std::size_t r = 0; r < size; ++r) {
      for (std::size_t c = 0; c < size; ++c) {
        const double m = transposed ? matrix[c * size + r] : matrix[r * size + c];
        const double* from = in + block + c * stride;
        double* to = out + block + r * stride;
        for (std::size_t k = 0; k < stride; ++k) to[k] += m * from[k];
      }
    }
  }
}

}  // namespace

LagrangeGrid::LagrangeGrid(int order) : order_(order), inverse_(static_cast<std::size_t>(order)) {
  for (int i = 0; i < order; ++i) {
    double product = 1.0;
    for (int k = 0; k < order; ++k) {
      if (k != i) product *= node(i) - node(k);
    }
    inverse_[static_cast<std::size_t>(i)] = 1.0 / product;
  }
  const auto size = static_cast<std::size_t>(order);
  for (int h = 0; h < 2; ++h) {
    half_[h].resize(size * size);
    for (std::size_t c = 0; c < size; ++c) {
      Row row{};
      basis(0.5 * node(static_cast<int>(c)) + (h == 0 ? -0.5 : 0.5), row.data());
      for (std::size_t p = 0; p < size; ++p) half_[h][p * size + c] = row[p];
    }
  }
}

void LagrangeGrid::basis(double t, double* out) const {
  Row right{};
  double product = 1.0;
  for (int k = order_ - 1; k >= 0; --k) {
    right[static_cast<std::size_t>(k)] = product;
    product *= t - node(k);
  }
  product = 1.0;
  for (int k = 0; k < order_; ++k) {
    const auto at = static_cast<std::size_t>(k);
    out[at] = product * right[at] * inverse_[at];
    product *= t - node(k);
  }
}

void LagrangeGrid::spread(const Vec3& place, double weight, double* nodes) const {
  Row x{};
  Row y{};
  Row z{};
  basis(place.x(), x.data());
  basis(place.y(), y.data());
  basis(place.z(), z.data());
  const auto size = static_cast<std::size_t>(order_);
  for (std::size_t k = 0; k < size; ++k) {
    for (std::size_t j = 0; j < size; ++j) {
      const double w = weight * z[k] * y[j];
      for (std::size_t i = 0; i < size; ++i) nodes[i] += w * x[i];
      nodes += size;
    }
  }
}

void LagrangeGrid::child_to_parent(int octant, const double* child, double* parent) const {
  const auto size = static_cast<std::size_t>(order_);
  std::vector<double> x(node_count(), 0.0);
  std::vector<double> xy(node_count(), 0.0);
  along_axis(order_, 1, half_[octant & 1].data(), false, child, x.data());
  along_axis(order_, size, half_[(octant >> 1) & 1].data(), false, x.data(), xy.data());
  along_axis(order_, size * size, half_[(octant >> 2) & 1].data(), false, xy.data(), parent);
}

void LagrangeGrid::parent_to_child(int octant, const double* parent, double* child) const {
  const auto size = static_cast<std::size_t>(order_);
  std::vector<double> x(node_count(), 0.0);
  std::vector<double> xy(node_count(), 0.0);
  along_axis(order_, 1, half_[octant & 1].data(), true, parent, x.data());
  along_axis(order_, size, half_[(octant >> 1) & 1].data(), true, x.data(), xy.data());
  along_axis(order_, size * size, half_[(octant >> 2) & 1].data(), true, xy.data(), child);
}

}  // namespace spinaltap::detail
