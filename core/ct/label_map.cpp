#include "core/ct/label_map.h"

#include <tbb/parallel_for.h>

#include <atomic>
#include <cmath>
#include <set>
#include <span>
#include <sstream>

#include "core/base/error.h"
#include "core/ct/nifti_volume.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;

/// Which voxels of the file carry the label, i fastest, and where they lie.
struct LabelVoxels {
  GridGeometry grid;      ///< only the size is used
  Mat3 index_to_patient;  ///< mm, LPS; steps of any length and angle
  Vec3 origin_mm;         ///< centre of voxel (0, 0, 0), LPS
  std::vector<std::uint8_t> has_label;
};

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

LabelVoxels load(const fs::path& file, int label) {
  const NiftiVolume nifti(file);
  LabelVoxels voxels;
  voxels.grid.size = nifti.size();
  voxels.index_to_patient = nifti.index_to_patient();
  voxels.origin_mm = nifti.origin_mm();
  std::set<long long> present;
  long long last = 0;
  nifti.read_values([&](std::span<const double> values) {
    for (const double value : values) {
      const bool is_label = std::abs(value) < 1e15;  // false also for what is not a number
      const long long found = is_label ? std::llround(value) : 0;
      if (found != last) present.insert(found);
      last = found;
      voxels.has_label.push_back(is_label && found == label ? 1 : 0);
    }
  });
  present.erase(0);
  if (label == 0 || !present.contains(label)) {
    fail("no label ", label, " in ", file.string(), "; there are: ", list_for_people(present));
  }
  return voxels;
}

}  // namespace

BoneMask read_label_map(const fs::path& file, int label, const GridGeometry& ct_geometry) {
  check_geometry(ct_geometry, "CT");
  const LabelVoxels voxels = load(file, label);
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
          return nearest[axis] >= 0.0 && nearest[axis] < voxels.grid.size[static_cast<std::size_t>(axis)];
        };
        if (!inside_axis(0) || !inside_axis(1) || !inside_axis(2)) continue;
        const std::size_t offset = voxels.grid.offset(static_cast<int>(nearest[0]), static_cast<int>(nearest[1]),
                                                      static_cast<int>(nearest[2]));
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
