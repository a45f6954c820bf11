#include "core/anatomy/detail/lattice_depths.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/anatomy/surface_sample.h"

namespace spinaltap {
namespace {

constexpr double kShallowMm = 3.0;
constexpr double kFewMm = 0.75;  // at kShallowMm the nearest of a few points is at most 0.1 mm further

/// Points, mm, and which of the surface's they are. Each coordinate lies for itself, for vector instructions.
struct Points {
  std::vector<double> x, y, z;
  std::vector<std::size_t> index;

  std::size_t size() const { return index.size(); }
  /// As PointTree sums it, bit for bit.
  double squared_mm2(std::size_t n, const Vec3& p_mm) const {
    const double dx = p_mm.x() - x[n], dy = p_mm.y() - y[n], dz = p_mm.z() - z[n];
    return dx * dx + dy * dy + dz * dz;
  }
  void add(double x_mm, double y_mm, double z_mm, std::size_t place) {
    x.push_back(x_mm);
    y.push_back(y_mm);
    z.push_back(z_mm);
    index.push_back(place);
  }
};

Points few_of(const std::vector<Vec3>& points_mm) {
  Points few;
  for (const std::size_t n : first_of_each_cell(points_mm, Vec3::Zero(), kFewMm)) {
    few.add(points_mm[n].x(), points_mm[n].y(), points_mm[n].z(), n);
  }
  return few;
}

double min_mm(const Points& points, const Vec3& p_mm) {
  constexpr std::size_t kLanes = 4;
  std::array<double, kLanes> min{};
  min.fill(std::numeric_limits<double>::infinity());
  std::size_t n = 0;
  for (; n + kLanes <= points.size(); n += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const double squared_mm2 = points.squared_mm2(n + lane, p_mm);
      min[lane] = squared_mm2 < min[lane] ? squared_mm2 : min[lane];
    }
  }
  for (; n < points.size(); ++n) min[0] = std::min(min[0], points.squared_mm2(n, p_mm));
  return std::sqrt(*std::min_element(min.begin(), min.end()));
}

/// A cube of the lattice's samples, cut off where the lattice ends.
struct SampleCube {
  std::array<int, 3> low;
  int side;
};

/// Goes down from large cubes to small ones. What is nearest to a place of a cube is nearly as near to the cube's
/// middle, so each cube looks only at what its parent leaves over: for neighbours at one go what a tree would look up
/// for each of them, which deep in the bone, where very many points are about as near, is most of them.
class DepthSearch {
 public:
  DepthSearch(FloatGrid& lattice, const PointTree& surface, double trusted_band_mm)
      : lattice_(lattice), surface_(surface), trusted_band_mm_(trusted_band_mm) {}

  void measure(const SampleCube& cube, const Points& around) {
    if (!has_bone(cube)) return;
    const double step_mm = lattice_.geometry.spacing_mm.x();
    const double half_mm = 0.5 * (cube.side - 1) * step_mm;
    const double reach_mm = std::numbers::sqrt3 * half_mm + 1e-6;  // from the middle to the furthest sample, and some
    const Vec3 middle_mm = place_mm(cube.low[0], cube.low[1], cube.low[2]) + Vec3::Constant(half_mm);
    squared_mm2_.resize(around.size());
    for (std::size_t n = 0; n < around.size(); ++n) squared_mm2_[n] = around.squared_mm2(n, middle_mm);
    const auto nearest = std::min_element(squared_mm2_.begin(), squared_mm2_.end());
    const double nearest_mm = std::sqrt(*nearest);
    if (near_ == kNone || cube.side > kSmallSide)
      near_ = around.index[static_cast<std::size_t>(nearest - squared_mm2_.begin())];
    if (nearest_mm + reach_mm < kShallowMm) {
      for_each_in_bone(cube, [&](const Vec3& p_mm) { return shallow_mm(p_mm); });
      return;
    }
    const double furthest_mm = nearest_mm + 2.0 * reach_mm;
    Points left;
    for (std::size_t n = 0; n < around.size(); ++n) {
      if (squared_mm2_[n] <= furthest_mm * furthest_mm)
        left.add(around.x[n], around.y[n], around.z[n], around.index[n]);
    }
    if (cube.side <= kSmallSide) {
      for_each_in_bone(cube, [&](const Vec3& p_mm) {
        const double depth_mm = min_mm(left, p_mm);
        return depth_mm < kShallowMm ? shallow_mm(p_mm) : depth_mm;
      });
      return;
    }
    const int half = cube.side / 2;
    for (int part = 0; part < 8; ++part) {
      measure(
          {{cube.low[0] + (part & 1) * half, cube.low[1] + (part >> 1 & 1) * half, cube.low[2] + (part >> 2) * half},
           half},
          left);
    }
  }

 private:
  static constexpr int kSmallSide = 2;
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  Vec3 place_mm(int i, int j, int k) const {
    return lattice_.geometry.origin_mm + lattice_.geometry.spacing_mm.x() * Vec3(i, j, k);
  }

  /// Calls `visit(i, j, k, value)` for the cube's samples in the bone until it returns false.
  template <class Visit>
  void visit_bone(const SampleCube& cube, const Visit& visit) {
    std::array<int, 3> end{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      end[axis] = std::min(cube.low[axis] + cube.side, lattice_.geometry.size[axis]);
    }
    for (int k = cube.low[2]; k < end[2]; ++k) {
      for (int j = cube.low[1]; j < end[1]; ++j) {
        for (int i = cube.low[0]; i < end[0]; ++i) {
          float& value = lattice_.values[lattice_.geometry.offset(i, j, k)];
          if (static_cast<double>(value) > -trusted_band_mm_) continue;
          if (!visit(i, j, k, value)) return;
        }
      }
    }
  }

  bool has_bone(const SampleCube& cube) {
    bool has = false;
    visit_bone(cube, [&](int, int, int, float&) {
      has = true;
      return false;
    });
    return has;
  }

  template <class Depth>
  void for_each_in_bone(const SampleCube& cube, const Depth& depth_mm) {
    visit_bone(cube, [&](int i, int j, int k, float& value) {
      value = -static_cast<float>(depth_mm(place_mm(i, j, k)));
      return true;
    });
  }

  double shallow_mm(const Vec3& p_mm) {
    const PointTree::Nearest found = surface_.nearest(p_mm, near_);
    near_ = found.index;
    return found.distance_mm;
  }

  FloatGrid& lattice_;
  const PointTree& surface_;
  double trusted_band_mm_;
  std::vector<double> squared_mm2_;
  std::size_t near_ = kNone;  ///< point of the surface near the last sample
};

}  // namespace

FloatGrid with_depths(FloatGrid lattice, const PointTree& surface, double trusted_band_mm, const Progress& progress) {
  constexpr int kSide = 16;
  const Points few = few_of(surface.points_mm());
  std::vector<SampleCube> cubes;
  const auto& size = lattice.geometry.size;
  for (int k = 0; k < size[2]; k += kSide) {
    for (int j = 0; j < size[1]; j += kSide) {
      for (int i = 0; i < size[0]; i += kSide) cubes.push_back({{i, j, k}, kSide});
    }
  }
  ProgressCounter counter(progress, "measuring the bone's depth", cubes.size());
  tbb::parallel_for(std::size_t{0}, cubes.size(), [&](std::size_t n) {
    DepthSearch(lattice, surface, trusted_band_mm).measure(cubes[n], few);
    counter.add();
  });
  return lattice;
}

}  // namespace spinaltap
