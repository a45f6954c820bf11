#include "core/files/strokes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/ct/label_volume.h"

namespace spinaltap {
namespace {

constexpr double kApartMm = 1.5;

/// Points of one label, none near another.
class SparsePoints {
 public:
  bool add(const Vec3& p_mm) {
    const Cell own{cell(p_mm.x()), cell(p_mm.y()), cell(p_mm.z())};
    for (int z = -1; z <= 1; ++z) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
          const auto found = by_cell_.find(Cell{own[0] + x, own[1] + y, own[2] + z});
          if (found == by_cell_.end()) continue;
          for (const Vec3& other : found->second) {
            if ((other - p_mm).norm() < kApartMm) return false;
          }
        }
      }
    }
    by_cell_[own].push_back(p_mm);
    return true;
  }

 private:
  using Cell = std::array<long, 3>;
  static long cell(double mm) { return std::lround(std::floor(mm / kApartMm)); }

  std::map<Cell, std::vector<Vec3>> by_cell_;
};

}  // namespace

std::vector<Correction> read_strokes(const std::filesystem::path& file, const GridGeometry& ct_geometry) {
  const LabelVolume strokes = read_label_volume(file, ct_geometry, {.convention = LabelConvention::any_names});
  std::map<int, SparsePoints> points;
  std::vector<Correction> corrections;
  std::size_t at = 0;
  for (int k = 0; k < ct_geometry.size[2]; ++k) {
    for (int j = 0; j < ct_geometry.size[1]; ++j) {
      for (int i = 0; i < ct_geometry.size[0]; ++i) {
        const int label = strokes.labels[at++];
        if (label == 0) continue;
        const Vec3 p_mm = ct_geometry.to_patient(Vec3(i, j, k));
        if (points[label].add(p_mm)) corrections.push_back({strokes.names.at(label).level, p_mm});
      }
    }
  }
  return corrections;
}

}  // namespace spinaltap
