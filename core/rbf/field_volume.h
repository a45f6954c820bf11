#pragma once

#include <filesystem>
#include <span>

#include "core/base/progress.h"
#include "core/base/scalar_field.h"
#include "core/ct/grid_geometry.h"

namespace spinaltap {

/// The smallest lattice along the axes with this step (mm) that the points' box (patient LPS, mm) fits into, with the
/// same centre. Throws Error when there is no point, the step is not above 0, or there would be over 2^31 voxels.
GridGeometry lattice_over(std::span<const Vec3> points_mm, double spacing_mm);

struct ValueRange {
  double min_mm = 0.0;
  double largest_mm = 0.0;
};

/// Evaluates a field on a lattice, piece by piece, and writes it as an NRRD volume of floats (mm, patient LPS) that 3D
/// Slicer and ParaView open. `path` is a staged (temporary) name. Throws Error when the disk is full; Cancelled.
ValueRange write_field_volume(const ScalarField& field, const GridGeometry& lattice, const std::filesystem::path& path,
                              const Progress& progress = {});

}  // namespace spinaltap
