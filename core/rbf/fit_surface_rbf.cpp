#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/error.h"
#include "core/rbf/rbf_fit.h"
#include "core/surface/off_surface.h"
#include "core/surface/point_grid.h"

namespace spinaltap {
namespace {

struct Subset {
  std::vector<std::size_t> indices;
  double spacing_mm = 0.0;  ///< that they keep from each other
};

/// About `count` points, at most, spread evenly: the spacing of the Poisson-disc subset is found by bisection.
Subset spread_count(std::span<const Vec3> points_mm, std::size_t count) {
  Box3 box;
  for (const Vec3& p : points_mm) box.extend(p);
  double low_mm = 0.0;
  double high_mm = std::max(box.diagonal().norm(), 1e-3);
  // The largest subset that is not too large. On a lattice no spacing may give a number near `count`.
  Subset best;
  for (int i = 0; i < 24 || best.indices.empty(); ++i) {
    Subset subset;
    subset.spacing_mm = i == 0 ? 0.02 * high_mm : 0.5 * (low_mm + high_mm);
    subset.indices = spread_subset(points_mm, subset.spacing_mm);
    if (subset.indices.size() > count) {
      low_mm = subset.spacing_mm;
      continue;
    }
    high_mm = subset.spacing_mm;
    if (subset.indices.size() > best.indices.size()) best = std::move(subset);
    if (best.indices.size() > count * 19 / 20 || best.indices.size() == points_mm.size()) break;
  }
  return best;
}

struct Centres {
  std::vector<Vec3> points_mm;
  std::vector<double> values_mm;
  std::size_t surface = 0;
};

Centres make_centres(const SurfacePoints& surface, const PointGrid& grid, const std::vector<std::size_t>& chosen,
                     double off_surface_mm) {
  Centres centres;
  for (const std::size_t i : chosen) {
    centres.points_mm.push_back(surface.positions_mm[i]);
    centres.values_mm.push_back(0.0);
  }
  centres.surface = chosen.size();
  for (const double side : {1.0, -1.0}) {
    for (const std::size_t i : chosen) {
      const Vec3 way = side * surface.normals[i];
      const double length_mm = off_surface_length_mm(grid, surface.positions_mm[i], way, off_surface_mm);
      if (!(length_mm > 0.0)) continue;
      centres.points_mm.push_back(surface.positions_mm[i] + length_mm * way);
      centres.values_mm.push_back(side * length_mm);
    }
  }
  return centres;
}

/// |s| at all points.
std::vector<double> residuals_mm(const RbfField& field, const std::vector<Vec3>& points_mm) {
  std::vector<double> residual_mm(points_mm.size());
  field.evaluate(points_mm, residual_mm, {});
  for (double& value : residual_mm) value = std::abs(value);
  return residual_mm;
}

/// Up to `room` points that the surface misses by more than the tolerance, worst first, `spacing_mm` from each other
/// and from the centres.
std::vector<std::size_t> worst_points(const SurfacePoints& surface, const std::vector<double>& residual_mm,
                                      const std::vector<std::size_t>& chosen, double tolerance_mm, double spacing_mm,
                                      std::size_t room) {
  std::vector<std::size_t> order(residual_mm.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return residual_mm[a] > residual_mm[b]; });
  const PointGrid grid(surface.positions_mm, spacing_mm);
  std::vector<bool> covered(residual_mm.size(), false);
  const auto cover = [&](std::size_t i) {
    grid.for_each_within(surface.positions_mm[i], spacing_mm, [&](std::size_t near) { covered[near] = true; });
  };
  for (const std::size_t i : chosen) cover(i);
  std::vector<std::size_t> worst;
  for (const std::size_t i : order) {
    if (residual_mm[i] <= tolerance_mm || worst.size() == room) break;
    if (covered[i]) continue;
    worst.push_back(i);
    cover(i);
  }
  return worst;
}

}  // namespace

RbfFit fit_surface_rbf(const SurfacePoints& surface, const RbfFitOptions& options, const Progress& progress) {
  constexpr std::size_t kFewestPoints = 20;
  constexpr std::size_t kMostCentres = 6'000;
  constexpr int kRounds = 3;
  constexpr double kFirstShare = 0.6;
  constexpr double kLaterSpacing = 0.4;  // later centres may lie nearer to each other than the first
  if (surface.positions_mm.size() < kFewestPoints || surface.normals.size() != surface.positions_mm.size()) {
    fail("RBF: expected ", kFewestPoints, " surface points with normals or more, found ", surface.positions_mm.size());
  }
  const auto finite = [](const Vec3& v) { return v.allFinite(); };
  if (!std::all_of(surface.positions_mm.begin(), surface.positions_mm.end(), finite) ||
      !std::all_of(surface.normals.begin(), surface.normals.end(), finite)) {
    fail("RBF: a surface point or its normal is not a number");
  }
  if (!(options.tolerance_mm > 0.0) || !(options.off_surface_mm > 0.0)) {
    fail("RBF: expected tolerance and off-surface distance above 0 mm, found ", options.tolerance_mm, " and ",
         options.off_surface_mm);
  }
  const std::size_t most = std::clamp<std::size_t>(options.max_surface_centres, kFewestPoints, kMostCentres);
  const PointGrid grid(surface.positions_mm, options.off_surface_mm);
  const Subset first =
      spread_count(surface.positions_mm, static_cast<std::size_t>(kFirstShare * static_cast<double>(most)));
  std::vector<std::size_t> chosen = first.indices;

  RbfFitReport report;
  report.points = surface.positions_mm.size();
  for (int round = 1;; ++round) {
    progress.report("fitting the surface", static_cast<double>(round - 1) / kRounds);
    const Centres centres = make_centres(surface, grid, chosen, options.off_surface_mm);
    if (centres.points_mm.size() == centres.surface) {
      fail("RBF: expected unit normals that point out of the surface, found no room along any of them");
    }
    RbfField field = interpolate_rbf(centres.points_mm, centres.values_mm, options.smoothing_mm);
    std::vector<double> residual_mm = residuals_mm(field, surface.positions_mm);
    const std::size_t room = round == kRounds || chosen.size() >= most ? 0
                             : round == kRounds - 1                    ? most - chosen.size()
                                                                       : (most - chosen.size()) / 2;
    const std::vector<std::size_t> worst =
        worst_points(surface, residual_mm, chosen, options.tolerance_mm, kLaterSpacing * first.spacing_mm, room);
    if (!worst.empty()) {
      chosen.insert(chosen.end(), worst.begin(), worst.end());
      continue;
    }
    report.surface_centres = centres.surface;
    report.off_surface_centres = centres.points_mm.size() - centres.surface;
    report.rounds = round;
    report.mean_residual_mm =
        std::accumulate(residual_mm.begin(), residual_mm.end(), 0.0) / static_cast<double>(residual_mm.size());
    std::sort(residual_mm.begin(), residual_mm.end());
    report.p99_residual_mm = residual_mm[(residual_mm.size() - 1) * 99 / 100];
    report.max_residual_mm = residual_mm.back();
    progress.report("fitting the surface", 1.0);
    return {std::move(field), report};
  }
}

}  // namespace spinaltap
