#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/error.h"
#include "core/ct/detail/slice_stack.h"
#include "core/ct/detail/volume_file.h"

namespace spinaltap::detail {
namespace {

/// For each of i, j and k, which of the old axes it becomes, and whether that turns round.
struct AxisOrder {
  std::array<int, 3> from{0, 1, 2};
  std::array<bool, 3> turned{false, false, false};
};

AxisOrder order_of(const Mat3& directions) {
  AxisOrder order;
  std::array<int, 3> tried{0, 1, 2};
  double max = -1.0;
  do {
    double sum = 0.0;
    for (int axis = 0; axis < 3; ++axis) sum += std::abs(directions(axis, tried[static_cast<std::size_t>(axis)]));
    if (sum > max + 1e-9) {
      max = sum;
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
    Eigen::Index min = 0;
    ordered.diagonal().minCoeff(&min);
    bool& turned = order.turned[static_cast<std::size_t>(min)];
    turned = !turned;
  }
  return order;
}

/// The same voxels with i, j and k as near as they come to the patient's left, posterior and superior (LPS), and a
/// right-handed grid. Nothing is interpolated: axes change places or turn round.
CtVolume ordered_as_lps(const GridGeometry& from_geometry, const std::vector<std::int16_t>& values) {
  if (values.size() != from_geometry.voxel_count()) {
    fail("CT: expected ", from_geometry.voxel_count(), " voxels, found ", values.size());
  }
  const AxisOrder order = order_of(from_geometry.directions);
  GridGeometry geometry = from_geometry;
  Vec3 first_index = Vec3::Zero();
  std::array<std::ptrdiff_t, 3> step{};
  std::ptrdiff_t start = 0;
  const std::array<std::ptrdiff_t, 3> strides{
      1, from_geometry.size[0], static_cast<std::ptrdiff_t>(from_geometry.size[0]) * from_geometry.size[1]};
  for (std::size_t n = 0; n < 3; ++n) {
    const auto from = static_cast<std::size_t>(order.from[n]);
    const int last = from_geometry.size[from] - 1;
    const double sign = order.turned[n] ? -1.0 : 1.0;
    geometry.size[n] = from_geometry.size[from];
    geometry.spacing_mm[static_cast<Eigen::Index>(n)] = from_geometry.spacing_mm[order.from[n]];
    geometry.directions.col(static_cast<Eigen::Index>(n)) = sign * from_geometry.directions.col(order.from[n]);
    if (order.turned[n]) first_index[order.from[n]] = last;
    step[n] = (order.turned[n] ? -1 : 1) * strides[from];
    if (order.turned[n]) start += last * strides[from];
  }
  geometry.origin_mm = from_geometry.to_patient(first_index);
  std::vector<std::int16_t> hu(values.size());
  std::size_t out = 0;
  for (std::ptrdiff_t k = 0; k < geometry.size[2]; ++k) {
    for (std::ptrdiff_t j = 0; j < geometry.size[1]; ++j) {
      const std::ptrdiff_t row = start + k * step[2] + j * step[1];
      for (std::ptrdiff_t i = 0; i < geometry.size[0]; ++i)
        hu[out++] = values[static_cast<std::size_t>(row + i * step[0])];
    }
  }
  return make_ct_volume(geometry, std::move(hu));
}

constexpr double kSquare = 1e-3;       // cosine between axes that are at right angles but for rounding
constexpr double kMaxSliceLean = 0.7;  // cosine between the third axis and the slices: 45 degrees
constexpr std::int16_t kNotMeasuredHu = -1024;

std::int16_t to_hu(double value) {
  if (std::isnan(value)) return kNotMeasuredHu;
  constexpr double kMin = std::numeric_limits<std::int16_t>::min();
  constexpr double kMax = std::numeric_limits<std::int16_t>::max();
  return static_cast<std::int16_t>(std::lround(std::clamp(value, kMin, kMax)));
}

struct Placement {
  GridGeometry grid;
  Vec3 step;  ///< from slice to slice, mm along the grid's directions
  bool leans = false;
};

/// The grid of the slices; its third direction is their normal.
Placement place(const VolumeFile& volume, const std::filesystem::path& file) {
  const Mat3& steps = volume.index_to_patient;
  const Vec3 length_mm = steps.colwise().norm();
  const Mat3 axes = steps * length_mm.cwiseInverse().asDiagonal();
  const Vec3 cosines(axes.col(0).dot(axes.col(1)), axes.col(0).dot(axes.col(2)), axes.col(1).dot(axes.col(2)));
  if (!(std::abs(cosines[0]) < kSquare) || !(std::hypot(cosines[1], cosines[2]) < kMaxSliceLean)) {
    fail("expected axes at right angles, or a third axis that leans by less than 45 degrees, found cosines of ",
         cosines[0], ", ", cosines[1], " and ", cosines[2], " between them in ", file.string());
  }
  Placement placement;
  GridGeometry& grid = placement.grid;
  grid.size = volume.size;
  grid.origin_mm = volume.origin_mm;
  grid.directions.col(0) = axes.col(0);
  grid.directions.col(1) = (axes.col(1) - cosines[0] * axes.col(0)).normalized();
  grid.directions.col(2) = axes.col(0).cross(grid.directions.col(1));
  if (grid.directions.col(2).dot(axes.col(2)) < 0.0) grid.directions.col(2) *= -1.0;
  placement.step = grid.directions.transpose() * steps.col(2);
  placement.leans = !(std::abs(cosines[1]) < kSquare && std::abs(cosines[2]) < kSquare);
  grid.spacing_mm = Vec3(length_mm[0], length_mm[1], placement.leans ? placement.step.z() : length_mm[2]);
  check_geometry(grid, (volume.format + " CT").c_str());
  return placement;
}

}  // namespace

CtVolume ct_of_volume(const VolumeFile& volume, const std::filesystem::path& file, const Progress& progress) {
  const Placement placement = place(volume, file);
  if (*std::min_element(volume.size.begin(), volume.size.end()) < 2) {
    fail("expected a CT of at least two voxels along each axis, found ", volume.size[0], " x ", volume.size[1], " x ",
         volume.size[2], " in ", file.string());
  }
  std::vector<std::int16_t> hu;
  hu.reserve(volume.voxel_count());
  volume.read_values([&](std::span<const double> values) {
    progress.report("reading voxels", static_cast<double>(hu.size()) / static_cast<double>(volume.voxel_count()));
    for (const double value : values) hu.push_back(to_hu(value));
  });
  if (!placement.leans) return ordered_as_lps(placement.grid, hu);
  std::vector<SlicePlace> places;
  places.reserve(static_cast<std::size_t>(placement.grid.size[2]));
  for (int k = 0; k < placement.grid.size[2]; ++k) {
    places.push_back({k * placement.step.z(), k * placement.step.head<2>()});
  }
  const CtVolume upright = resample_stack(placement.grid, places, placement.step.z(), hu, progress);
  return ordered_as_lps(upright.geometry, upright.hu);
}

}  // namespace spinaltap::detail
