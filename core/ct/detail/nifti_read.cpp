#include "core/ct/detail/nifti_read.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/error.h"
#include "core/ct/detail/axis_order.h"
#include "core/ct/detail/nifti_volume.h"
#include "core/ct/detail/slice_stack.h"

namespace spinaltap {
namespace {

constexpr double kSquare = 1e-3;   // cosine between axes that are at right angles but for rounding
constexpr double kMostLean = 0.7;  // cosine between the third axis and the slices: 45 degrees
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
Placement place(const NiftiVolume& nifti, const std::filesystem::path& file) {
  const Mat3& steps = nifti.index_to_patient();
  const Vec3 length_mm = steps.colwise().norm();
  const Mat3 axes = steps * length_mm.cwiseInverse().asDiagonal();
  const Vec3 cosines(axes.col(0).dot(axes.col(1)), axes.col(0).dot(axes.col(2)), axes.col(1).dot(axes.col(2)));
  if (!(std::abs(cosines[0]) < kSquare) || !(std::hypot(cosines[1], cosines[2]) < kMostLean)) {
    fail("expected axes at right angles, or a third axis that leans by less than 45 degrees, found cosines of ",
         cosines[0], ", ", cosines[1], " and ", cosines[2], " between them in ", file.string());
  }
  Placement placement;
  GridGeometry& grid = placement.grid;
  grid.size = nifti.size();
  grid.origin_mm = nifti.origin_mm();
  grid.directions.col(0) = axes.col(0);
  grid.directions.col(1) = (axes.col(1) - cosines[0] * axes.col(0)).normalized();
  grid.directions.col(2) = axes.col(0).cross(grid.directions.col(1));
  if (grid.directions.col(2).dot(axes.col(2)) < 0.0) grid.directions.col(2) *= -1.0;
  placement.step = grid.directions.transpose() * steps.col(2);
  placement.leans = !(std::abs(cosines[1]) < kSquare && std::abs(cosines[2]) < kSquare);
  grid.spacing_mm = Vec3(length_mm[0], length_mm[1], placement.leans ? placement.step.z() : length_mm[2]);
  check_geometry(grid, "NIfTI CT");
  return placement;
}

}  // namespace

CtVolume read_nifti_ct(const std::filesystem::path& file, const Progress& progress) {
  const NiftiVolume nifti(file);
  const Placement placement = place(nifti, file);
  if (*std::min_element(nifti.size().begin(), nifti.size().end()) < 2) {
    fail("expected a CT of at least two voxels along each axis, found ", nifti.size()[0], " x ", nifti.size()[1], " x ",
         nifti.size()[2], " in ", file.string());
  }
  std::vector<std::int16_t> hu;
  hu.reserve(nifti.voxel_count());
  nifti.read_values([&](std::span<const double> values) {
    progress.report("reading voxels", static_cast<double>(hu.size()) / static_cast<double>(nifti.voxel_count()));
    for (const double value : values) hu.push_back(to_hu(value));
  });
  if (!placement.leans) return ordered_as_lps(make_ct_volume(placement.grid, std::move(hu)));
  std::vector<SlicePlace> places;
  places.reserve(static_cast<std::size_t>(placement.grid.size[2]));
  for (int k = 0; k < placement.grid.size[2]; ++k) {
    places.push_back({k * placement.step.z(), k * placement.step.head<2>()});
  }
  return ordered_as_lps(resample_stack(placement.grid, places, placement.step.z(), hu, progress));
}

}  // namespace spinaltap
