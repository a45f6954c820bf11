#include "core/surface/label_edges.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/segment/float_grid.h"
#include "core/surface/surface_points.h"

namespace spinaltap {
namespace {

constexpr double kReachMm = 5.0;
constexpr double kStepMm = 0.25;
constexpr double kHalfFallMm = 1.0;  // CT numbers are compared this far to either side of a place
constexpr double kSearchMm = 16.0;
constexpr double kNearMm = 1.0;

/// Places on a mask's edge with outward normals.
struct Edge {
  std::vector<Vec3> places_mm;
  std::vector<Vec3> normals;
};

/// CT numbers without noise of single voxels, and without what is far denser or thinner than the tissues at a bone's
/// edge: beside lungs and metal every other edge would count for nothing.
FloatGrid numbers_around(const CtVolume& ct, const BoneMask& mask) {
  constexpr double kSmoothMm = 0.5;
  constexpr float kBelowHu = 400.0F, kAboveHu = 800.0F;  // of the bone's own
  const VoxelBox box = grow_box(mask_box(mask), kSearchMm + kReachMm + 3.0, ct.geometry);
  FloatGrid hu = crop_hu(ct, box);
  const FloatGrid inside = crop_mask(mask, box);
  std::vector<float> in_bone;
  for (std::size_t v = 0; v < hu.values.size(); ++v) {
    if (inside.values[v] > 0.5F) in_bone.push_back(hu.values[v]);
  }
  const auto middle = in_bone.begin() + static_cast<std::ptrdiff_t>(in_bone.size() / 2);
  std::nth_element(in_bone.begin(), middle, in_bone.end());
  for (float& value : hu.values) value = std::clamp(value, *middle - kBelowHu, *middle + kAboveHu);
  return gaussian_blur(hu, kSmoothMm);
}

class EdgeSearch {
 public:
  EdgeSearch(const CtVolume& ct, const BoneMask& mask) : ct_(ct.geometry), hu_(numbers_around(ct, mask)) {}

  /// What a fit comes to: the shift that was found on top of `start_mm`, and how many places agree with it.
  struct Fit {
    Vec3 shift_mm = Vec3::Zero();
    double growth_mm = 0.0;
    double share = 0.0;
  };

  Fit fit(const Edge& edge, const Vec3& start_mm) const {
    constexpr int kMaxRounds = 8;
    constexpr double kDoneMm = 0.02;
    Fit fit{start_mm, 0.0, 0.0};
    for (int round = 0; round < kMaxRounds; ++round) {
      const std::vector<Offset> offsets = offsets_of(edge, fit.shift_mm);
      const Eigen::Vector4d step = solve(edge, offsets, fit.growth_mm);
      fit.growth_mm = step[3];
      fit.share = share_of(offsets, fit.growth_mm);
      if (step.head<3>().norm() < kDoneMm) break;
      fit.shift_mm += step.head<3>();
    }
    return fit;
  }

  /// The shift of up to 16 mm along each axis, in steps of 2 mm, with the greatest mean fall of the CT number outward.
  Vec3 best_start(const Edge& edge) const {
    constexpr double kCoarseMm = 2.0;
    constexpr double kHalfMm = 1.5;
    constexpr double kMinHu = -100.0, kMaxHu = 400.0;
    constexpr std::size_t kPlaces = 500;
    constexpr int kSide = static_cast<int>(kSearchMm / kCoarseMm);
    constexpr int kCount = 2 * kSide + 1;
    const std::size_t stride = std::max<std::size_t>(1, edge.places_mm.size() / kPlaces);
    std::vector<double> scores(static_cast<std::size_t>(kCount) * kCount * kCount);
    const auto shift_of = [&](std::size_t n) {
      const auto at = [&](std::size_t part) { return (static_cast<int>(part) % kCount - kSide) * kCoarseMm; };
      return Vec3(at(n), at(n / kCount), at(n / kCount / kCount));
    };
    tbb::parallel_for(std::size_t{0}, scores.size(), [&](std::size_t n) {
      const Vec3 shift_mm = shift_of(n);
      double sum = 0.0;
      for (std::size_t p = 0; p < edge.places_mm.size(); p += stride) {
        const Vec3 place_mm = edge.places_mm[p] + shift_mm;
        sum += std::clamp(at(place_mm - kHalfMm * edge.normals[p]) - at(place_mm + kHalfMm * edge.normals[p]), kMinHu,
                          kMaxHu);
      }
      scores[n] = sum;
    });
    const auto best = std::max_element(scores.begin(), scores.end());
    return shift_of(static_cast<std::size_t>(best - scores.begin()));
  }

 private:
  struct Offset {
    double mm = 0.0;  ///< of the greatest fall from the place, outward
    double fall_hu = 0.0;
    bool is_seen = false;  ///< the place lies within the CT
  };

  double at(const Vec3& p_mm) const { return sample_clamped(hu_, hu_.geometry.to_index(p_mm)); }

  bool is_in_ct(const Vec3& p_mm) const {
    const Vec3 index = ct_.to_index(p_mm);
    for (int axis = 0; axis < 3; ++axis) {
      if (!(index[axis] >= 0.0 && index[axis] <= ct_.size[static_cast<std::size_t>(axis)] - 1)) return false;
    }
    return true;
  }

  std::vector<Offset> offsets_of(const Edge& edge, const Vec3& shift_mm) const {
    constexpr int kHalf = static_cast<int>(kHalfFallMm / kStepMm);
    constexpr int kSide = static_cast<int>(kReachMm / kStepMm) + kHalf;
    constexpr int kCount = 2 * kSide + 1;
    std::vector<Offset> offsets(edge.places_mm.size());
    tbb::parallel_for(std::size_t{0}, offsets.size(), [&](std::size_t n) {
      const Vec3 place_mm = edge.places_mm[n] + shift_mm;
      if (!is_in_ct(place_mm)) return;
      std::array<double, kCount> hu{};
      for (int i = 0; i < kCount; ++i) {
        hu[static_cast<std::size_t>(i)] = at(place_mm + (i - kSide) * kStepMm * edge.normals[n]);
      }
      Offset best{0.0, -1e9, true};
      for (int i = kHalf; i < kCount - kHalf; ++i) {
        const double* const here = hu.data() + i;
        const double fall_hu = here[-kHalf] - here[kHalf];
        if (fall_hu > best.fall_hu) best = {(i - kSide) * kStepMm, fall_hu, true};
      }
      offsets[n] = best;
    });
    // What falls far less than most is no edge of bone.
    constexpr double kLeast = 0.3;
    std::vector<double> falls_hu;
    for (const Offset& offset : offsets) {
      if (offset.is_seen) falls_hu.push_back(offset.fall_hu);
    }
    if (falls_hu.empty()) return offsets;
    const auto middle = falls_hu.begin() + static_cast<std::ptrdiff_t>(falls_hu.size() / 2);
    std::nth_element(falls_hu.begin(), middle, falls_hu.end());
    const double least_hu = kLeast * *middle;
    for (Offset& offset : offsets) {
      if (offset.is_seen && !(offset.fall_hu > least_hu)) offset.fall_hu = 0.0;
    }
    return offsets;
  }

  /// The shift and the growth that leave least of the offsets; what is over a millimetre off counts ever less (Cauchy's
  /// weights).
  static Eigen::Vector4d solve(const Edge& edge, const std::vector<Offset>& offsets, double growth_mm) {
    constexpr int kRounds = 6;
    constexpr double kTiny = 1e-6;  // where all normals face one way
    Eigen::Vector4d found(0.0, 0.0, 0.0, growth_mm);
    for (int round = 0; round < kRounds; ++round) {
      Eigen::Matrix4d matrix = kTiny * Eigen::Matrix4d::Identity();
      Eigen::Vector4d right_side = Eigen::Vector4d::Zero();
      for (std::size_t n = 0; n < offsets.size(); ++n) {
        if (!(offsets[n].fall_hu > 0.0)) continue;
        const Eigen::Vector4d row(edge.normals[n].x(), edge.normals[n].y(), edge.normals[n].z(), 1.0);
        const double left_mm = (offsets[n].mm - row.dot(found)) / kNearMm;
        const double weight = 1.0 / (1.0 + left_mm * left_mm);
        matrix += weight * row * row.transpose();
        right_side += weight * offsets[n].mm * row;
      }
      found = matrix.ldlt().solve(right_side);
    }
    return found;
  }

  static double share_of(const std::vector<Offset>& offsets, double growth_mm) {
    std::size_t seen = 0, near = 0;
    for (const Offset& offset : offsets) {
      if (!offset.is_seen) continue;
      ++seen;
      if (offset.fall_hu > 0.0 && std::abs(offset.mm - growth_mm) < kNearMm) ++near;
    }
    return seen == 0 ? 0.0 : static_cast<double>(near) / static_cast<double>(seen);
  }

  GridGeometry ct_;
  FloatGrid hu_;
};

/// Some 3,000 places, evenly chosen, of the mask's surface that lie in the CT: where its border cuts a mask, there is
/// no edge.
Edge edge_of(const CtVolume& ct, const BoneMask& mask, const Progress& progress) {
  constexpr std::size_t kPlaces = 3000;
  SurfaceOptions options;
  options.refine_by_hu = false;
  const SurfacePoints surface = extract_surface(ct, mask, options, progress);
  Edge all;
  for (std::size_t n = 0; n < surface.positions_mm.size(); ++n) {
    const Vec3 index = ct.geometry.to_index(surface.positions_mm[n]);
    bool is_in = true;
    for (int axis = 0; axis < 3; ++axis) {
      is_in = is_in && index[axis] >= 0.0 && index[axis] <= ct.geometry.size[static_cast<std::size_t>(axis)] - 1;
    }
    if (!is_in) continue;
    all.places_mm.push_back(surface.positions_mm[n]);
    all.normals.push_back(surface.normals[n]);
  }
  const std::size_t stride = std::max<std::size_t>(1, all.places_mm.size() / kPlaces);
  Edge edge;
  for (std::size_t n = 0; n < all.places_mm.size(); n += stride) {
    edge.places_mm.push_back(all.places_mm[n]);
    edge.normals.push_back(all.normals[n]);
  }
  return edge;
}

Edge mirrored(const Edge& edge, int axis) {
  Box3 box;
  for (const Vec3& place_mm : edge.places_mm) box.extend(place_mm);
  const double twice_mm = 2.0 * box.center()[axis];
  Edge turned = edge;
  for (Vec3& place_mm : turned.places_mm) place_mm[axis] = twice_mm - place_mm[axis];
  for (Vec3& normal : turned.normals) normal[axis] = -normal[axis];
  return turned;
}

}  // namespace

LabelEdges find_label_edges(const CtVolume& ct, const BoneMask& mask, const Progress& progress) {
  constexpr std::size_t kFewPlaces = 300;
  constexpr double kMany = 0.5;
  constexpr double kNearlyAll = 0.75;  // of a label's edge lies on bone where nothing is wrong with it or its CT
  LabelEdges found;
  Edge edge;
  try {
    edge = edge_of(ct, mask, progress);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error&) {
    if (mask_box(mask).empty()) throw;
    return found;  // thinner than a voxel: there is no edge to look at
  }
  if (edge.places_mm.size() < kFewPlaces) return found;
  found.places = edge.places_mm.size();
  const EdgeSearch search(ct, mask);
  EdgeSearch::Fit fit = search.fit(edge, Vec3::Zero());
  if (fit.share < kMany) {
    const EdgeSearch::Fit other = search.fit(edge, search.best_start(edge));
    if (other.share > fit.share) fit = other;
  }
  found.on_edge = fit.share;
  found.moved_mm = -fit.shift_mm;
  found.grown_mm = -fit.growth_mm;
  for (int axis = 0; axis < 3; ++axis) {
    const Edge turned = mirrored(edge, axis);
    const EdgeSearch::Fit in_place = search.fit(turned, fit.shift_mm);
    double share = in_place.share;
    if (fit.share < kNearlyAll && share < kNearlyAll) {
      share = std::max(share, search.fit(turned, search.best_start(turned)).share);
    }
    found.on_edge_mirrored[axis] = share;
  }
  return found;
}

}  // namespace spinaltap
