#include "core/ct/label_map.h"

#include <atomic>
#include <cmath>

#include "core/base/error.h"
#include "core/ct/detail/label_file.h"

namespace spinaltap {

BoneMask read_label_map(const std::filesystem::path& file, int label, const GridGeometry& ct_geometry) {
  check_geometry(ct_geometry, "CT");
  std::vector<std::uint8_t> has_label;  // of the file's voxels
  std::set<long long> present;          // without 0
  long long last = 0;
  const detail::LabelFile labels = detail::read_label_file(
      file, [&](const detail::LabelFile& head) { has_label.reserve(head.voxel_count()); },
      [&](std::span<const double> values) {
        for (const double value : values) {
          const bool is_label = std::abs(value) < 1e15;  // false also for what is not a number
          const long long found = is_label ? std::llround(value) : 0;
          if (found != last && found != 0) present.insert(found);
          last = found;
          has_label.push_back(is_label && found == label ? 1 : 0);
        }
      });
  if (label == 0 || !present.contains(label)) {
    fail("no label ", label, " in ", file.string(), "; there are: ", detail::list_for_people(present));
  }
  BoneMask mask{ct_geometry, std::vector<std::uint8_t>(ct_geometry.voxel_count(), 0)};
  std::atomic<bool> found{false};
  detail::for_each_nearest(labels, ct_geometry, [&](std::size_t at, std::size_t at_file) {
    if (has_label[at_file] == 0) return;
    mask.inside[at] = 1;
    found.store(true, std::memory_order_relaxed);
  });
  if (!found) fail("expected label ", label, " within the CT, found it only outside: ", file.string());
  return mask;
}

}  // namespace spinaltap
