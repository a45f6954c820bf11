#include "core/anatomy/bone_shape.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "core/anatomy/detail/lattice_depths.h"
#include "core/base/error.h"

namespace spinaltap {
namespace {

constexpr double kSampleMm = BoneShape::kSampleMm;

FloatGrid sampled_lattice(const ScalarField& surface, const Box3& bounds_mm, const Progress& progress) {
  constexpr double kLargestMm = 500.0;
  constexpr double kMarginMm = 2.0 * BoneShape::kLatticeMm;
  if (bounds_mm.isEmpty() || !bounds_mm.sizes().allFinite()) fail("planning: the bone has no surface");
  if (!(bounds_mm.sizes().maxCoeff() <= kLargestMm)) {
    fail("planning: expected a bone of at most ", kLargestMm, " mm, found ", bounds_mm.sizes().maxCoeff(), " mm");
  }
  FloatGrid lattice;
  lattice.geometry.origin_mm = bounds_mm.min() - Vec3::Constant(kMarginMm);
  lattice.geometry.spacing_mm = Vec3::Constant(BoneShape::kLatticeMm);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double side_mm = bounds_mm.sizes()[static_cast<Eigen::Index>(axis)] + 2.0 * kMarginMm;
    lattice.geometry.size[axis] = static_cast<int>(std::ceil(side_mm / BoneShape::kLatticeMm)) + 1;
  }
  const auto& size = lattice.geometry.size;
  lattice.values.resize(lattice.geometry.voxel_count());
  ProgressCounter counter(progress, "reading the bone's shape", static_cast<std::size_t>(size[2]));
  tbb::parallel_for(0, size[2], [&](int k) {
    std::vector<Vec3> row_mm(static_cast<std::size_t>(size[0]));
    std::vector<double> values_mm(row_mm.size());
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        row_mm[static_cast<std::size_t>(i)] = lattice.geometry.origin_mm + BoneShape::kLatticeMm * Vec3(i, j, k);
      }
      surface.evaluate(row_mm, values_mm, {});
      std::transform(values_mm.begin(), values_mm.end(),
                     lattice.values.begin() + static_cast<std::ptrdiff_t>(lattice.geometry.offset(0, j, k)),
                     [](double value_mm) { return static_cast<float>(value_mm); });
    }
    counter.add();
  });
  return lattice;
}

/// Centres of those eighths of the cells that the surface crosses which it may cross itself, k ascending.
std::vector<Vec3> places_near_surface(const FloatGrid& lattice) {
  constexpr std::array<double, 4> kWeights{27.0 / 64.0, 9.0 / 64.0, 3.0 / 64.0, 1.0 / 64.0};  // by axes away
  constexpr double kFarMm = 0.9 * kSampleMm;  // half an eighth's diagonal, and some for what is not linear
  const auto& size = lattice.geometry.size;
  std::vector<std::vector<Vec3>> of_layer(static_cast<std::size_t>(std::max(size[2] - 1, 0)));
  tbb::parallel_for(std::size_t{0}, of_layer.size(), [&](std::size_t layer) {
    const auto k = static_cast<int>(layer);
    for (int j = 0; j + 1 < size[1]; ++j) {
      for (int i = 0; i + 1 < size[0]; ++i) {
        std::array<float, 8> corners{};
        int inside = 0;
        for (int corner = 0; corner < 8; ++corner) {
          const float value = lattice.at(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2));
          corners[static_cast<std::size_t>(corner)] = value;
          inside += value < 0.0F ? 1 : 0;
        }
        if (inside == 0 || inside == 8) continue;
        for (int part = 0; part < 8; ++part) {
          // Tri-linear: 3/4 of the nearer corner and 1/4 of the other, along each axis.
          double value_mm = 0.0;
          for (int corner = 0; corner < 8; ++corner) {
            const int away = std::popcount(static_cast<unsigned>(corner ^ part));
            value_mm += kWeights[static_cast<std::size_t>(away)] *
                        static_cast<double>(corners[static_cast<std::size_t>(corner)]);
          }
          if (std::abs(value_mm) > kFarMm) continue;
          const Vec3 offset(0.25 + 0.5 * (part & 1), 0.25 + 0.5 * (part >> 1 & 1), 0.25 + 0.5 * (part >> 2));
          of_layer[layer].push_back(lattice.geometry.origin_mm + BoneShape::kLatticeMm * (Vec3(i, j, k) + offset));
        }
      }
    }
  });
  std::vector<Vec3> places;
  for (const std::vector<Vec3>& some : of_layer) places.insert(places.end(), some.begin(), some.end());
  return places;
}

struct Samples {
  std::vector<Vec3> points_mm, normals;
};

/// The places moved onto the surface, less those that are far from it or do not arrive.
Samples moved_to_surface(const ScalarField& surface, const std::vector<Vec3>& places) {
  constexpr int kRounds = 3;
  constexpr std::size_t kBatch = 1024;
  constexpr double kFarMm = kSampleMm;  // half the diagonal of a cube of kSampleMm, and some
  constexpr double kArrivedMm = 2e-3;
  std::vector<Samples> of_batch((places.size() + kBatch - 1) / kBatch);
  tbb::parallel_for(std::size_t{0}, of_batch.size(), [&](std::size_t n) {
    const auto first = places.begin() + static_cast<std::ptrdiff_t>(n * kBatch);
    const std::vector<Vec3> start_mm(first,
                                     first + static_cast<std::ptrdiff_t>(std::min(kBatch, places.size() - n * kBatch)));
    std::vector<Vec3> at_mm = start_mm;
    std::vector<double> values_mm(at_mm.size());
    std::vector<Vec3> gradients(at_mm.size());
    for (int round = 0; round <= kRounds; ++round) {
      surface.evaluate(at_mm, values_mm, gradients);
      if (round == kRounds) break;
      for (std::size_t i = 0; i < at_mm.size(); ++i) {
        const double squared = gradients[i].squaredNorm();
        if (squared > 0.01) at_mm[i] -= values_mm[i] / squared * gradients[i];
      }
    }
    for (std::size_t i = 0; i < at_mm.size(); ++i) {
      if (!(std::abs(values_mm[i]) < kArrivedMm) || !((at_mm[i] - start_mm[i]).norm() < kFarMm)) continue;
      const double slope = gradients[i].norm();
      if (!(slope > 0.1)) continue;
      of_batch[n].points_mm.push_back(at_mm[i]);
      of_batch[n].normals.push_back(gradients[i] / slope);
    }
  });
  std::size_t count = 0;
  for (const Samples& some : of_batch) count += some.points_mm.size();
  Samples all;
  all.points_mm.reserve(count);
  all.normals.reserve(count);
  for (const Samples& some : of_batch) {
    all.points_mm.insert(all.points_mm.end(), some.points_mm.begin(), some.points_mm.end());
    all.normals.insert(all.normals.end(), some.normals.begin(), some.normals.end());
  }
  return all;
}

}  // namespace

double without_sampling_error_mm(const Vec3& p_mm, const Vec3& nearest_mm, const Vec3& normal, double spacing_mm) {
  const Vec3 way_mm = p_mm - nearest_mm;
  const double across_mm = way_mm.dot(normal);
  const double beside_squared = std::max(0.0, way_mm.squaredNorm() - across_mm * across_mm);
  // Further beside it than samples lie from each other, p looks at an edge, to which the distance is right as it is.
  if (beside_squared > spacing_mm * spacing_mm) return way_mm.norm();
  return std::abs(across_mm);
}

BoneShape::BoneShape(std::shared_ptr<const ScalarField> surface, const Box3& bounds_mm, double trusted_band_mm,
                     const Progress& progress)
    : surface_(std::move(surface)),
      trusted_band_mm_(trusted_band_mm),
      lattice_(sampled_lattice(*surface_, bounds_mm, progress)),
      tree_(std::vector<Vec3>{}) {
  Samples samples = moved_to_surface(*surface_, places_near_surface(lattice_));
  if (samples.points_mm.empty()) fail("planning: the bone has no surface");
  bounds_mm_ = bounds_of(samples.points_mm);
  normals_ = std::move(samples.normals);
  tree_ = PointTree(std::move(samples.points_mm));
  lattice_ = with_depths(std::move(lattice_), tree_, trusted_band_mm_, progress);
}

double BoneShape::distance_mm(const Vec3& p_mm) const {
  double value_mm = 0.0;
  surface_->evaluate({&p_mm, 1}, {&value_mm, 1}, {});
  if (std::abs(value_mm) < trusted_band_mm_) return value_mm;
  const PointTree::Nearest near = nearest(p_mm);
  if (near.index >= normals_.size()) return std::numeric_limits<double>::infinity();
  const double distance_mm = without_sampling_error_mm(p_mm, points_mm()[near.index], normals_[near.index], kSampleMm);
  return std::copysign(std::max(distance_mm, trusted_band_mm_), value_mm);
}

bool BoneShape::is_inside(const Vec3& p_mm) const {
  double value_mm = 0.0;
  surface_->evaluate({&p_mm, 1}, {&value_mm, 1}, {});
  return value_mm < 0.0;
}

}  // namespace spinaltap
