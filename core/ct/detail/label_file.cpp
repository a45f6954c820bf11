#include "core/ct/detail/label_file.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "core/base/error.h"
#include "core/base/text_writer.h"

namespace spinaltap::detail {

namespace fs = std::filesystem;

std::size_t LabelFile::voxel_count() const {
  return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]);
}

LabelFile read_label_file(const fs::path& file, const std::function<void(const LabelFile&)>& begin,
                          const TakeLabels& take) {
  std::error_code error;
  if (!fs::exists(file, error)) fail("no such file: ", file.string());
  if (!fs::is_regular_file(file, error)) fail("expected a label map, found something else: ", file.string());
  const std::string name = file.filename().string();
  if (name.ends_with(".nrrd")) return read_nrrd_labels(file, begin, take);
  if (!name.ends_with(".nii") && !name.ends_with(".nii.gz")) {
    fail("expected a label map as NIfTI (.nii, .nii.gz) or NRRD (.nrrd, .seg.nrrd), found ", file.string());
  }
  return read_nifti_labels(file, begin, take);
}

void for_each_nearest(const LabelFile& file, const GridGeometry& grid,
                      const std::function<void(std::size_t, std::size_t)>& visit) {
  GridGeometry of_file;  // for its offsets
  of_file.size = file.size;
  const Mat3 to_file = file.index_to_patient.inverse();
  const Mat3 step = to_file * grid.index_to_patient_matrix();
  const Vec3 start = to_file * (grid.origin_mm - file.origin_mm);
  tbb::parallel_for(0, grid.size[2], [&](int k) {
    for (int j = 0; j < grid.size[1]; ++j) {
      for (int i = 0; i < grid.size[0]; ++i) {
        const Vec3 p_file = start + step * Vec3(i, j, k);
        const Eigen::Array3d nearest = (p_file.array() + 0.5).floor();
        const auto inside_axis = [&](int axis) {
          return nearest[axis] >= 0.0 && nearest[axis] < file.size[static_cast<std::size_t>(axis)];
        };
        if (!inside_axis(0) || !inside_axis(1) || !inside_axis(2)) continue;
        visit(grid.offset(i, j, k),
              of_file.offset(static_cast<int>(nearest[0]), static_cast<int>(nearest[1]), static_cast<int>(nearest[2])));
      }
    }
  });
}

std::string list_for_people(const std::set<long long>& labels) {
  constexpr int kMax = 40;
  if (labels.empty()) return "none";
  TextWriter text;
  int count = 0;
  for (const long long label : labels) {
    if (++count > kMax) {
      text << ", ... (" << labels.size() << " in all)";
      break;
    }
    text << (count > 1 ? ", " : "") << label;
  }
  return text.str();
}

void check_transform(const LabelFile& labels, const std::string& what) {
  const double volume_mm3 = std::abs(labels.index_to_patient.determinant());
  if (!labels.index_to_patient.allFinite() || !labels.origin_mm.allFinite() || !(volume_mm3 > 1e-12)) {
    fail("expected a transform that gives voxels a volume, found one that does not in ", what);
  }
}

}  // namespace spinaltap::detail
