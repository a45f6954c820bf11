#include "core/drill/corridor.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "core/segment/distance_transform.h"

namespace spinaltap {
namespace {

/// Distance to the nearest voxel outside the bone; 0 outside.
class Clearance {
 public:
  explicit Clearance(const BoneMask& bone) : geometry_(bone.geometry) {
    std::vector<std::uint8_t> outside(bone.inside.size());
    std::transform(bone.inside.begin(), bone.inside.end(), outside.begin(),
                   [](std::uint8_t inside) { return static_cast<std::uint8_t>(inside != 0 ? 0 : 1); });
    distance_mm_ = squared_distance_to(outside, geometry_);
    for (float& value : distance_mm_) value = std::sqrt(value);
    to_index_ = geometry_.index_to_patient_matrix().inverse();
  }

  double at(const Vec3& p_mm) const {
    const Vec3 p_index = to_index_ * (p_mm - geometry_.origin_mm);
    const auto voxel = [&](int axis) { return static_cast<int>(std::lround(p_index[axis])); };
    if (!geometry_.contains(voxel(0), voxel(1), voxel(2))) return 0.0;
    return static_cast<double>(distance_mm_[geometry_.offset(voxel(0), voxel(1), voxel(2))]);
  }
  float of_voxel(std::size_t offset) const { return distance_mm_[offset]; }

 private:
  GridGeometry geometry_;
  Mat3 to_index_;
  std::vector<float> distance_mm_;
};

struct Corridor {
  Vec3 entry_mm = Vec3::Zero();
  Vec3 target_mm = Vec3::Zero();
  double width_mm = 0.0;  ///< least clearance between the entry's neighbourhood and the target

  /// Twenty mm of length weigh as much as one of clearance: of ways of like width, the one that starts on the arch.
  double score() const { return width_mm + 0.05 * (target_mm - entry_mm).norm(); }
};

/// Follows the bone backwards from the target and forwards from it.
Corridor follow(const Clearance& clearance, const Vec3& seed_mm, const Vec3& direction,
                const CorridorOptions& options) {
  constexpr double kStepMm = 0.5;
  constexpr double kEntryMm = 8.0;  // the surface is near at the entry by nature
  constexpr double kLongestMm = 80.0;
  Corridor corridor;
  double front_mm = 0.0;
  while (front_mm < 20.0 && clearance.at(seed_mm + (front_mm + kStepMm) * direction) >= options.front_clearance_mm) {
    front_mm += kStepMm;
  }
  corridor.target_mm = seed_mm + front_mm * direction;
  std::vector<double> way;
  double back_mm = 0.0;
  while (back_mm < kLongestMm) {
    const double here_mm = clearance.at(seed_mm - back_mm * direction);
    if (!(here_mm > 0.0)) break;
    way.push_back(here_mm);
    back_mm += kStepMm;
  }
  corridor.entry_mm = seed_mm - (back_mm - kStepMm) * direction;
  if (back_mm + front_mm < options.least_length_mm || back_mm >= kLongestMm) return corridor;
  const auto counted = static_cast<std::ptrdiff_t>(way.size()) - static_cast<std::ptrdiff_t>(kEntryMm / kStepMm);
  if (counted > 0) corridor.width_mm = *std::min_element(way.begin(), way.begin() + counted);
  return corridor;
}

/// Whether no bone lies behind the entry, so that a straight bit can come to it. A way that enters the body through its
/// back wall has the vertebral arch behind it.
bool is_open_behind(const Clearance& clearance, const Corridor& corridor) {
  constexpr double kStepMm = 0.5;
  constexpr double kWayMm = 60.0;
  const Vec3 back = (corridor.entry_mm - corridor.target_mm).normalized();
  for (double way_mm = 2.0 * kStepMm; way_mm <= kWayMm; way_mm += kStepMm) {
    if (clearance.at(corridor.entry_mm + way_mm * back) > 0.0) return false;
  }
  return true;
}

/// Patient y of the vertebral canal's middle, mm; +infinity when none is seen. In a transverse slice the canal is what
/// has bone on all four sides; the median over the slices passes over those few that show a hollow endplate instead.
double canal_y_mm(const BoneMask& bone) {
  const auto& size = bone.geometry.size;
  const auto columns = static_cast<std::size_t>(size[0]);
  const auto rows = static_cast<std::size_t>(size[1]);
  struct Span {
    int first = std::numeric_limits<int>::max();
    int last = -1;
    void add(int at) { first = std::min(first, at), last = std::max(last, at); }
    bool encloses(int at) const { return first < at && at < last; }
  };
  std::vector<double> of_slice_mm;
  for (int k = 0; k < size[2]; ++k) {
    std::vector<Span> of_column(columns);
    std::vector<Span> of_row(rows);
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        if (!bone.at(i, j, k)) continue;
        of_column[static_cast<std::size_t>(i)].add(j);
        of_row[static_cast<std::size_t>(j)].add(i);
      }
    }
    double sum_mm = 0.0;
    int count = 0;
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        if (bone.at(i, j, k) || !of_column[static_cast<std::size_t>(i)].encloses(j) ||
            !of_row[static_cast<std::size_t>(j)].encloses(i)) {
          continue;
        }
        sum_mm += bone.geometry.to_patient(Vec3(i, j, k)).y();
        ++count;
      }
    }
    if (count > 0) of_slice_mm.push_back(sum_mm / count);
  }
  if (of_slice_mm.empty()) return std::numeric_limits<double>::infinity();
  const auto middle = of_slice_mm.begin() + static_cast<std::ptrdiff_t>(of_slice_mm.size() / 2);
  std::nth_element(of_slice_mm.begin(), middle, of_slice_mm.end());
  return *middle;
}

}  // namespace

DrillPath widest_corridor(const BoneMask& bone, const DrillBit& bit, const CorridorOptions& options,
                          const Progress& progress) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  constexpr double kAngleStepDeg = 2.5;
  constexpr double kEntryBehindCanalMm = 8.0;  // entries through the side of a pedicle lie beside the canal
  check_bit(bit);
  const Clearance clearance(bone);
  const double entry_behind_mm = canal_y_mm(bone) + kEntryBehindCanalMm;
  const auto& size = bone.geometry.size;
  std::vector<Vec3> directions;
  for (double across = -options.most_convergence_deg; across <= options.most_convergence_deg; across += kAngleStepDeg) {
    for (double up = -options.most_inclination_deg; up <= options.most_inclination_deg; up += kAngleStepDeg) {
      directions.emplace_back(std::sin(across * kDegree) * std::cos(up * kDegree),
                              -std::cos(across * kDegree) * std::cos(up * kDegree), std::sin(up * kDegree));
    }
  }
  // One best corridor a slice, compared in order: the same at any thread count.
  std::vector<Corridor> best_of_slice(static_cast<std::size_t>(size[2]));
  ProgressCounter counter(progress, "looking for a path", best_of_slice.size());
  tbb::parallel_for(0, size[2], [&](int k) {
    Corridor& best = best_of_slice[static_cast<std::size_t>(k)];
    for (int j = 0; j < size[1]; j += 2) {
      for (int i = 0; i < size[0]; i += 2) {
        if (static_cast<double>(clearance.of_voxel(bone.geometry.offset(i, j, k))) < options.body_clearance_mm)
          continue;
        const Vec3 seed_mm = bone.geometry.to_patient(Vec3(i, j, k));
        for (const Vec3& direction : directions) {
          const Corridor corridor = follow(clearance, seed_mm, direction, options);
          if (corridor.width_mm > 0.0 && corridor.entry_mm.y() > entry_behind_mm && corridor.score() > best.score() &&
              is_open_behind(clearance, corridor)) {
            best = corridor;
          }
        }
      }
    }
    counter.add();
  });
  const auto best = std::max_element(best_of_slice.begin(), best_of_slice.end(),
                                     [](const Corridor& a, const Corridor& b) { return a.score() < b.score(); });
  if (best == best_of_slice.end() || !(best->width_mm > 0.0)) {
    fail("no straight way of ", options.least_length_mm,
         " mm through bone from the back into a vertebral body; give "
         "--entry and --target");
  }
  DrillPath path{"suggested", best->entry_mm, best->target_mm, bit};
  check_path(path);
  return path;
}

}  // namespace spinaltap
