#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/scalar_field.h"
#include "core/base/triangle_mesh.h"
#include "core/phantom/solid.h"
#include "core/surface/surface_samples.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// How far a mesh's vertices lie from a true surface, mm.
struct SurfaceError {
  double mean_mm = 0.0;  ///< of the absolute distances
  double p99_mm = 0.0;
  double max_mm = 0.0;
  double bias_mm = 0.0;  ///< mean of the signed distances: positive where the mesh lies outside
};

/// Distances by the ground truth's value over its slope. Throws Error on an empty mesh.
SurfaceError surface_error(const TriangleMesh& mesh, const ScalarField& ground_truth);

/// What is compared: every method with every smoothing.
struct ComparisonOptions {
  std::vector<PointMethod> methods{PointMethod::pixels, PointMethod::normals, PointMethod::contours};
  std::vector<double> smoothings_mm{0.0, 0.5, 30.0};
  double voxel_mm = 0.25;  ///< of the baked grids
};

/// Figures of one surface.
struct SurfaceFigures {
  double roughness_deg = 0.0;  ///< spread of normals within 1 mm (mesh/roughness.h)
  double volume_mm3 = 0.0;
  double volume_change = 0.0;  ///< against the ground truth: 0.01 is 1 % more
  double mean_mm = 0.0;        ///< distance of its vertices from the ground truth
  double p99_mm = 0.0;
  double max_mm = 0.0;
  std::size_t pieces = 0;  ///< of the zero set; the largest is measured
  long euler_number = 0;
};

struct ComparedSurface {
  PointMethod method = PointMethod::contours;
  double smoothing_mm = 0.0;
  std::size_t centres = 0;  ///< of the radial basis function, on and off the surface
  SurfaceFigures figures;
  std::optional<BoneModel> bone;  ///< none where the function has no closed zero set
};

struct Comparison {
  BoneModel ground_truth;
  SurfaceFigures ground_truth_figures;
  std::vector<ComparedSurface> surfaces;  ///< method by method
};

/// The comparison of the paper's figures 6, 9, 11 and 12 with a ground truth beside it: from the CT of a body and its
/// mask to surface points, radial basis function, grid and surface, by each method and smoothing. What smoothing means
/// is said in FitOptions (core/rbf/fit_rbf.h).
Comparison compare_surfaces(const Solid& ground_truth, const CtVolume& ct, const BoneMask& mask,
                            const ComparisonOptions& options = {}, const Progress& progress = {});

}  // namespace spinaltap
