#include "core/rbf/field_volume.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/error.h"
#include "core/base/file_stream.h"
#include "core/ct/nrrd_head.h"

namespace spinaltap {

GridGeometry lattice_over(std::span<const Vec3> points_mm, double spacing_mm) {
  if (points_mm.empty()) fail("lattice: expected points to put it around, found none");
  if (!(spacing_mm > 0.0)) fail("lattice: expected a step above 0 mm, found ", spacing_mm);
  const Box3 box = bounds_of(points_mm);
  constexpr double kMaxVoxels = 2147483648.0;
  const Vec3 counts = ((box.sizes() / spacing_mm).array().ceil() + 1.0).matrix();
  if (!(counts.prod() <= kMaxVoxels)) {
    fail("lattice: expected at most 2^31 voxels, found ", counts.prod(), " at a step of ", spacing_mm, " mm");
  }
  GridGeometry lattice;
  lattice.spacing_mm = Vec3::Constant(spacing_mm);
  lattice.origin_mm = box.center() - 0.5 * spacing_mm * (counts - Vec3::Ones());
  for (int axis = 0; axis < 3; ++axis) lattice.size[static_cast<std::size_t>(axis)] = static_cast<int>(counts[axis]);
  return lattice;
}

ValueRange write_field_volume(const ScalarField& field, const GridGeometry& lattice, const std::filesystem::path& path,
                              const Progress& progress) {
  check_geometry(lattice, "lattice");
  // Whole slices, or rows of one, at a time: enough for any method of summation, few enough to be stopped between two,
  // and a lattice by themselves, which some fields are quicker on.
  constexpr int kPiece = 1'000'000;
  const auto [columns, rows, slices] = lattice.size;
  const int rows_at_once = std::clamp(kPiece / columns, 1, rows);
  const int slices_at_once = rows_at_once < rows ? 1 : std::clamp(kPiece / columns / rows, 1, slices);
  const auto count = static_cast<double>(lattice.voxel_count());
  ValueRange range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  std::vector<Vec3> points_mm;
  std::vector<double> values_mm;
  std::vector<float> floats;
  double done = 0.0;
  FileWriter file(path);
  file.write(nrrd_head(lattice, "float", "raw") + "\n");
  for (int slice = 0; slice < slices; slice += slices_at_once) {
    for (int row = 0; row < rows; row += rows_at_once) {
      progress.report("evaluating", done / count);
      points_mm.clear();
      for (int k = slice; k < std::min(slice + slices_at_once, slices); ++k) {
        for (int j = row; j < std::min(row + rows_at_once, rows); ++j) {
          for (int i = 0; i < columns; ++i) points_mm.push_back(lattice.to_patient(Vec3(i, j, k)));
        }
      }
      values_mm.resize(points_mm.size());
      field.evaluate(points_mm, values_mm, {});
      const auto [min, largest] = std::minmax_element(values_mm.begin(), values_mm.end());
      range = {std::min(range.min_mm, *min), std::max(range.largest_mm, *largest)};
      floats.assign(values_mm.begin(), values_mm.end());
      file.write({reinterpret_cast<const char*>(floats.data()), floats.size() * sizeof(float)});
      done += static_cast<double>(points_mm.size());
    }
  }
  file.close();
  progress.report("evaluating", 1.0);
  return range;
}

}  // namespace spinaltap
