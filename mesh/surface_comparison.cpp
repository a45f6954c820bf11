#include "mesh/surface_comparison.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/rbf/fit_rbf.h"
#include "core/rbf/fit_surface.h"
#include "core/rbf/rbf_field.h"
#include "mesh/mesh_quality.h"
#include "vdb/bake/bake.h"
#include "vdb/grid/isosurface.h"

namespace spinaltap {
namespace {

SurfaceFigures figures_of(const BoneModel& bone, const Solid& ground_truth) {
  const TriangleMesh mesh = bone_surface(bone);
  const MeshQuality quality = measure_mesh(mesh);
  const SurfaceError error = surface_error(mesh, ground_truth);
  SurfaceFigures figures;
  figures.roughness_deg = roughness_deg(mesh);
  figures.volume_mm3 = quality.volume_mm3;
  figures.mean_mm = error.mean_mm;
  figures.p99_mm = error.p99_mm;
  figures.max_mm = error.max_mm;
  figures.pieces = quality.pieces;
  figures.euler_number = quality.euler_number;
  return figures;
}

/// The function that a method's points give. Contours go the way that `bake` goes, the paper's methods as the paper
/// did: through all points.
RbfField fit(const SurfaceSamples& samples, PointMethod method, double smoothing_mm, const Progress& progress) {
  if (method != PointMethod::contours) {
    return RbfField(
        fit_rbf({samples.positions_mm, samples.values_mm, {}}, {.smoothing_mm = smoothing_mm}, progress).model);
  }
  const auto count = static_cast<std::ptrdiff_t>(samples.surface_count);
  const SurfacePoints surface{{samples.positions_mm.begin(), samples.positions_mm.begin() + count},
                              {samples.normals.begin(), samples.normals.begin() + count}};
  return fit_surface(surface, {.smoothing_mm = smoothing_mm}, progress).field;
}

}  // namespace

SurfaceError surface_error(const TriangleMesh& mesh, const ScalarField& ground_truth) {
  if (mesh.vertices_mm.empty()) fail("comparing surfaces: the mesh is empty");
  std::vector<Vec3> points_mm;
  for (const Eigen::Vector3f& p : mesh.vertices_mm) points_mm.push_back(p.cast<double>());
  std::vector<double> distance_mm(points_mm.size());
  std::vector<Vec3> gradients(points_mm.size());
  ground_truth.evaluate(points_mm, distance_mm, gradients);
  SurfaceError error;
  for (std::size_t i = 0; i < distance_mm.size(); ++i) {
    // Far from the surface a ground truth may be flat; its value is then the least that the distance can be.
    const double slope = gradients[i].norm();
    if (slope > 0.5) distance_mm[i] /= slope;
    error.bias_mm += distance_mm[i];
    distance_mm[i] = std::abs(distance_mm[i]);
    error.mean_mm += distance_mm[i];
  }
  const auto count = static_cast<double>(distance_mm.size());
  error.bias_mm /= count;
  error.mean_mm /= count;
  std::sort(distance_mm.begin(), distance_mm.end());
  error.p99_mm = distance_mm[(distance_mm.size() - 1) * 99 / 100];
  error.max_mm = distance_mm.back();
  return error;
}

Comparison compare_surfaces(const Solid& ground_truth, const CtVolume& ct, const BoneMask& mask,
                            const ComparisonOptions& options, const Progress& progress) {
  const BakeOptions bake{.voxel_mm = options.voxel_mm};
  constexpr double kTissueHu = 40.0;
  Comparison comparison{bake_solid(ground_truth, bake, kTissueHu, progress), {}, {}};
  comparison.ground_truth_figures = figures_of(comparison.ground_truth, ground_truth);
  const double true_mm3 = comparison.ground_truth_figures.volume_mm3;
  for (const PointMethod method : options.methods) {
    const SurfaceSamples samples = sample_surface(ct, mask, {.method = method}, progress);
    const std::span<const Vec3> seeds_mm(samples.positions_mm.data(), samples.surface_count);
    for (const double smoothing_mm : options.smoothings_mm) {
      const RbfField field = fit(samples, method, smoothing_mm, progress);
      ComparedSurface surface{method, smoothing_mm, field.centre_count(), {}, {}};
      try {
        BakeReport report;
        surface.bone = bake_bone(field, seeds_mm, ct, bake, {}, &report, progress);
        surface.figures = figures_of(*surface.bone, ground_truth);
        surface.figures.pieces += report.dropped_pieces;
        surface.figures.volume_change = surface.figures.volume_mm3 / true_mm3 - 1.0;
      } catch (const Cancelled&) {
        throw;
      } catch (const Error&) {
        // So smooth that nothing of a surface is left: a result, too.
      }
      comparison.surfaces.push_back(std::move(surface));
    }
  }
  return comparison;
}

}  // namespace spinaltap
