#include "core/ct/label_map.h"

#include <tbb/parallel_for.h>

#include <atomic>
#include <sstream>

#include "core/base/error.h"
#include "core/ct/label_file.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;

/// "1, 2, 22"; the first of them where there are many.
std::string list_for_people(const std::set<long long>& labels) {
  constexpr int kMost = 40;
  if (labels.empty()) return "none";
  std::ostringstream text;
  int count = 0;
  for (const long long label : labels) {
    if (++count > kMost) {
      text << ", ... (" << labels.size() << " in all)";
      break;
    }
    text << (count > 1 ? ", " : "") << label;
  }
  return text.str();
}

detail::LabelVoxels load(const fs::path& file, int label) {
  std::error_code error;
  if (!fs::exists(file, error)) fail("no such file: ", file.string());
  if (!fs::is_regular_file(file, error)) fail("expected a label map, found something else: ", file.string());
  const std::string name = file.filename().string();
  const bool is_nrrd = name.ends_with(".nrrd");
  if (!is_nrrd && !name.ends_with(".nii") && !name.ends_with(".nii.gz")) {
    fail("expected a label map as NIfTI (.nii, .nii.gz) or NRRD (.nrrd, .seg.nrrd), found ", file.string());
  }
  detail::LabelVoxels voxels = is_nrrd ? detail::load_nrrd_label(file, label) : detail::load_nifti_label(file, label);
  if (label == 0 || !voxels.present.contains(label)) {
    fail("no label ", label, " in ", file.string(), "; there are: ", list_for_people(voxels.present));
  }
  return voxels;
}

}  // namespace

BoneMask read_label_map(const fs::path& file, int label, const GridGeometry& ct_geometry) {
  check_geometry(ct_geometry, "CT");
  const detail::LabelVoxels voxels = load(file, label);
  GridGeometry grid;  // for its offsets
  grid.size = voxels.size;
  const Mat3 to_file = voxels.index_to_patient.inverse();
  const Mat3 step = to_file * ct_geometry.index_to_patient_matrix();
  const Vec3 start = to_file * (ct_geometry.origin_mm - voxels.origin_mm);

  BoneMask mask{ct_geometry, std::vector<std::uint8_t>(ct_geometry.voxel_count(), 0)};
  std::atomic<bool> found{false};
  tbb::parallel_for(0, ct_geometry.size[2], [&](int k) {
    for (int j = 0; j < ct_geometry.size[1]; ++j) {
      for (int i = 0; i < ct_geometry.size[0]; ++i) {
        const Vec3 p_file = start + step * Vec3(i, j, k);
        const Eigen::Array3d nearest = (p_file.array() + 0.5).floor();
        const auto inside_axis = [&](int axis) {
          return nearest[axis] >= 0.0 && nearest[axis] < voxels.size[static_cast<std::size_t>(axis)];
        };
        if (!inside_axis(0) || !inside_axis(1) || !inside_axis(2)) continue;
        const std::size_t offset =
            grid.offset(static_cast<int>(nearest[0]), static_cast<int>(nearest[1]), static_cast<int>(nearest[2]));
        if (voxels.has_label[offset] == 0) continue;
        mask.inside[ct_geometry.offset(i, j, k)] = 1;
        found.store(true, std::memory_order_relaxed);
      }
    }
  });
  if (!found) fail("expected label ", label, " within the CT, found it only outside: ", file.string());
  return mask;
}

}  // namespace spinaltap
