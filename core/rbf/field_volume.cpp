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
  // Large enough for any method of summation, small enough to be stopped between two.
  constexpr std::size_t kPiece = 1'000'000;
  const auto columns = static_cast<std::size_t>(lattice.size[0]);
  const auto rows = static_cast<std::size_t>(lattice.size[1]);
  const std::size_t count = lattice.voxel_count();
  ValueRange range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  std::vector<Vec3> points_mm;
  std::vector<double> values_mm;
  std::vector<float> floats;
  FileWriter file(path);
  file.write(nrrd_head(lattice, "float", "raw") + "\n");
  for (std::size_t begin = 0; begin < count; begin += kPiece) {
    progress.report("evaluating", static_cast<double>(begin) / static_cast<double>(count));
    points_mm.clear();
    for (std::size_t v = begin; v < std::min(begin + kPiece, count); ++v) {
      const std::size_t row = v / columns;
      const std::size_t slice = row / rows;
      points_mm.push_back(lattice.to_patient(
          Vec3(static_cast<double>(v % columns), static_cast<double>(row % rows), static_cast<double>(slice))));
    }
    values_mm.resize(points_mm.size());
    field.evaluate(points_mm, values_mm, {});
    const auto [min, largest] = std::minmax_element(values_mm.begin(), values_mm.end());
    range = {std::min(range.min_mm, *min), std::max(range.largest_mm, *largest)};
    floats.assign(values_mm.begin(), values_mm.end());
    file.write({reinterpret_cast<const char*>(floats.data()), floats.size() * sizeof(float)});
  }
  file.close();
  progress.report("evaluating", 1.0);
  return range;
}

}  // namespace spinaltap
