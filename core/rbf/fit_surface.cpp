#include "core/rbf/fit_surface.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/error.h"
#include "core/base/point_grid.h"
#include "core/rbf/fit_rbf.h"
#include "core/surface/off_surface.h"

namespace spinaltap {

SurfaceFit fit_surface(const SurfacePoints& surface, const SurfaceFitOptions& options, const Progress& progress) {
  constexpr std::size_t kFewestPoints = 20;
  constexpr double kWidestSpacingMm = 100.0;
  const std::size_t count = surface.positions_mm.size();
  if (count < kFewestPoints || surface.normals.size() != count) {
    fail("RBF: expected ", kFewestPoints, " surface points with normals or more, found ", count);
  }
  const auto finite = [](const Vec3& v) { return v.allFinite(); };
  if (!std::all_of(surface.positions_mm.begin(), surface.positions_mm.end(), finite) ||
      !std::all_of(surface.normals.begin(), surface.normals.end(), finite)) {
    fail("RBF: a surface point or its normal is not a number");
  }
  if (!(options.off_surface_mm > 0.0)) {
    fail("RBF: expected an off-surface distance above 0 mm, found ", options.off_surface_mm);
  }
  if (!(options.spacing_mm >= 0.0 && options.spacing_mm <= kWidestSpacingMm)) {
    fail("RBF: expected a spacing of 0 to ", kWidestSpacingMm, " mm, found ", options.spacing_mm);
  }
  std::vector<std::size_t> taken(count);
  std::iota(taken.begin(), taken.end(), std::size_t{0});
  if (options.spacing_mm > 0.0) taken = spread_subset(surface.positions_mm, surface.normals, options.spacing_mm);
  RbfValues data;
  for (const std::size_t i : taken) data.points_mm.push_back(surface.positions_mm[i]);
  data.values_mm.assign(taken.size(), 0.0);
  const PointGrid grid(surface.positions_mm, options.off_surface_mm);
  for (const double side : {1.0, -1.0}) {
    for (const std::size_t i : taken) {
      const Vec3 way = side * surface.normals[i];
      const double length_mm = off_surface_length_mm(grid, surface.positions_mm[i], way, options.off_surface_mm);
      if (!(length_mm > 0.0)) continue;
      data.points_mm.push_back(surface.positions_mm[i] + length_mm * way);
      data.values_mm.push_back(side * length_mm);
    }
  }
  if (data.points_mm.size() == taken.size()) {
    fail("RBF: expected unit normals that point out of the surface, found no room along any of them");
  }
  RbfFit fit = detail::fit_without_residuals(
      data,
      {.accuracy_mm = options.accuracy_mm, .smoothing_mm = options.smoothing_mm, .reduction_mm = options.reduction_mm},
      progress);
  SurfaceFit result{RbfField(std::move(fit.model)), {}};
  std::vector<double> residual_mm(count);
  result.field.evaluate(surface.positions_mm, residual_mm, {});
  for (double& value : residual_mm) value = std::abs(value);
  SurfaceFitReport& report = result.report;
  report.points = count;
  report.off_surface_points = data.points_mm.size() - taken.size();
  report.centres = fit.report.centres;
  report.iterations = fit.report.iterations;
  report.mean_residual_mm = std::accumulate(residual_mm.begin(), residual_mm.end(), 0.0) / static_cast<double>(count);
  std::sort(residual_mm.begin(), residual_mm.end());
  report.p99_residual_mm = residual_mm[(count - 1) * 99 / 100];
  report.max_residual_mm = residual_mm.back();
  return result;
}

}  // namespace spinaltap
