#include "vdb/bake/detail/closest_points.h"

#include <openvdb/math/Half.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "core/base/error.h"
#include "vdb/bake/detail/evaluate_batches.h"
#include "vdb/detail/bone_grids.h"

namespace spinaltap::detail {
namespace {

using openvdb::Coord;

/// A voxel of the band and what is known of the point of the zero set closest to it.
struct BandVoxel {
  Coord at;
  bool is_found = false;                             ///< whether `way_mm` ends on the zero set
  Eigen::Vector3f way_mm = Eigen::Vector3f::Zero();  ///< from the voxel to that point

  double distance_mm() const { return is_found ? static_cast<double>(way_mm.norm()) : kUnknown; }
  static constexpr double kUnknown = std::numeric_limits<double>::infinity();
};

constexpr std::int32_t kNone = -1;
constexpr double kSameDistance = 2e-3;  // voxels: distances that differ by less are one

std::array<Coord, 26> neighbour_steps() {
  std::array<Coord, 26> steps;
  std::size_t next = 0;
  for (int k = -1; k <= 1; ++k) {
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) {
        if (i != 0 || j != 0 || k != 0) steps[next++] = Coord(i, j, k);
      }
    }
  }
  return steps;
}

class ClosestPoints {
 public:
  ClosestPoints(const openvdb::FloatGrid& near, const openvdb::Vec3SGrid& ways_mm, const ScalarField& field,
                double band_mm, const Progress& progress)
      : field_(field),
        progress_(progress),
        voxel_mm_(near.voxelSize()[0]),
        band_mm_(band_mm),
        places_(kNone),
        place_(places_) {
    const auto way = ways_mm.getConstAccessor();
    for (auto voxel = near.cbeginValueOn(); voxel; ++voxel) {
      const openvdb::Vec3s first_mm = way.getValue(voxel.getCoord());
      add(voxel.getCoord(), {first_mm.x(), first_mm.y(), first_mm.z()});
    }
  }

  std::size_t evaluations() const { return evaluations_; }
  const std::vector<BandVoxel>& voxels() const { return voxels_; }

  /// Closest points of the first voxels, from where they stand.
  void find_near() {
    std::vector<std::uint32_t> all(voxels_.size());
    std::iota(all.begin(), all.end(), 0U);
    search(all);
  }

  /// Adds the next layer of voxels; returns whether any of it lies in the band.
  bool widen() {
    const std::size_t known = voxels_.size();
    for (std::size_t i = layer_begin_; i < known; ++i) {
      if (!(voxels_[i].distance_mm() < band_mm_)) continue;
      for (const Coord& step : kSteps) {
        const Coord at = voxels_[i].at + step;
        if (place_.getValue(at) != kNone) continue;
        add(at);
      }
    }
    layer_begin_ = known;
    if (voxels_.size() == known) return false;
    std::vector<std::uint32_t> fresh;
    for (std::size_t i = known; i < voxels_.size(); ++i) fresh.push_back(static_cast<std::uint32_t>(i));
    take_from_neighbours(fresh);
    std::erase_if(fresh, [&](std::uint32_t i) { return !(voxels_[i].distance_mm() < band_mm_ + voxel_mm_); });
    search(fresh);
    return true;
  }

  /// Gives each voxel its neighbours' closest point where that is nearer, until none is.
  void exchange() {
    constexpr int kMaxRounds = 16;
    std::vector<std::uint32_t> open(voxels_.size());
    std::iota(open.begin(), open.end(), 0U);
    for (int round = 0; round < kMaxRounds && !open.empty(); ++round) {
      const std::vector<std::uint32_t> changed = take_from_neighbours(open);
      search(changed);
      open = neighbours_of(changed);
    }
  }

 private:
  void add(const Coord& at, const Eigen::Vector3f& way_mm = Eigen::Vector3f::Zero()) {
    constexpr std::size_t kMax = std::numeric_limits<std::int32_t>::max();
    if (voxels_.size() >= kMax) fail("baking: more than ", kMax, " voxels near the surface; choose larger ones");
    place_.setValue(at, static_cast<std::int32_t>(voxels_.size()));
    voxels_.push_back({.at = at, .way_mm = way_mm});
  }

  Vec3 centre_mm(const BandVoxel& voxel) const { return voxel_mm_ * Vec3(voxel.at.x(), voxel.at.y(), voxel.at.z()); }

  /// Each once, ascending.
  std::vector<std::uint32_t> neighbours_of(const std::vector<std::uint32_t>& some) {
    std::vector<std::uint32_t> found;
    for (const std::uint32_t i : some) {
      for (const Coord& step : kSteps) {
        const std::int32_t index = place_.getValue(voxels_[i].at + step);
        if (index != kNone) found.push_back(static_cast<std::uint32_t>(index));
      }
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  /// Voxels whose neighbours know a point nearer than their own take the nearest of those. All look before any takes.
  std::vector<std::uint32_t> take_from_neighbours(const std::vector<std::uint32_t>& wanted) {
    const double gain_mm = 2.0 * kSameDistance * voxel_mm_;
    std::vector<Eigen::Vector3f> nearest(wanted.size());
    std::vector<std::uint8_t> is_nearer(wanted.size(), 0);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, wanted.size(), 4096), [&](const auto& range) {
      const openvdb::tree::ValueAccessor<const openvdb::Int32Tree> place(places_);
      for (std::size_t n = range.begin(); n < range.end(); ++n) {
        const BandVoxel& voxel = voxels_[wanted[n]];
        double best_mm = voxel.distance_mm() - gain_mm;
        for (const Coord& step : kSteps) {
          const std::int32_t index = place.getValue(voxel.at + step);
          if (index == kNone) continue;
          const BandVoxel& other = voxels_[static_cast<std::size_t>(index)];
          if (!other.is_found) continue;
          const Eigen::Vector3f way_mm =
              other.way_mm + static_cast<float>(voxel_mm_) * Eigen::Vector3f(static_cast<float>(step.x()),
                                                                             static_cast<float>(step.y()),
                                                                             static_cast<float>(step.z()));
          const double distance_mm = static_cast<double>(way_mm.norm());
          if (!(distance_mm < best_mm)) continue;
          best_mm = distance_mm;
          nearest[n] = way_mm;
          is_nearer[n] = 1;
        }
      }
    });
    std::vector<std::uint32_t> changed;
    for (std::size_t n = 0; n < wanted.size(); ++n) {
      if (is_nearer[n] == 0) continue;
      voxels_[wanted[n]].way_mm = nearest[n];
      voxels_[wanted[n]].is_found = true;
      changed.push_back(wanted[n]);
    }
    return changed;
  }

  /// Improves the closest points of some voxels. What does not arrive on the zero set, or arrives further away than
  /// what was known, changes nothing.
  void search(const std::vector<std::uint32_t>& open) {
    constexpr int kMaxRounds = 4;
    // A point that moved by less than this many voxels has arrived: by the plane that it moved in the distance is
    // wrong by half the curvature times the square of that, 0.001 voxels where the radius is 4.
    constexpr double kStill = 0.1;
    constexpr double kOnSurface = 0.1;  // voxels: its last way along the gradient may be no longer
    struct Search {
      Eigen::Vector3f way_mm;
      bool has_arrived = false;
    };
    std::vector<Search> searches(open.size());
    std::vector<std::uint32_t> searching(open.size());
    for (std::size_t n = 0; n < open.size(); ++n) {
      searches[n].way_mm = voxels_[open[n]].way_mm;
      searching[n] = static_cast<std::uint32_t>(n);
    }
    for (int round = 0; round < kMaxRounds && !searching.empty(); ++round) {
      std::vector<std::uint8_t> goes_on(searching.size(), 0);
      evaluate_batches(
          field_, searching.size(), "measuring distances", progress_,
          [&](std::size_t i) -> Vec3 {
            const std::uint32_t n = searching[i];
            return centre_mm(voxels_[open[n]]) + searches[n].way_mm.template cast<double>();
          },
          [&](std::size_t i, double value_mm, const Vec3& gradient) {
            Search& search = searches[searching[i]];
            const double slope = gradient.norm();
            const double step_mm = value_mm / slope;
            // A gradient that vanishes leads nowhere.
            if (!(std::abs(step_mm) < 2.0 * band_mm_)) return;
            const Vec3 normal = gradient / slope;
            const Vec3 way_mm = search.way_mm.template cast<double>();
            const Vec3 next_mm = (way_mm.dot(normal) - step_mm) * normal;
            const double moved_mm = (next_mm - way_mm).norm();
            search.way_mm = next_mm.cast<float>();
            search.has_arrived = std::abs(step_mm) < kOnSurface * voxel_mm_;
            goes_on[i] = moved_mm > kStill * voxel_mm_ ? 1 : 0;
          });
      evaluations_ += searching.size();
      std::vector<std::uint32_t> rest;
      for (std::size_t i = 0; i < searching.size(); ++i) {
        if (goes_on[i] != 0) rest.push_back(searching[i]);
      }
      searching = std::move(rest);
    }
    for (std::size_t n = 0; n < open.size(); ++n) {
      BandVoxel& voxel = voxels_[open[n]];
      if (!searches[n].has_arrived || !searches[n].way_mm.allFinite()) continue;
      // Going on from a neighbour's point must not end on a part of the surface that is further off.
      if (static_cast<double>(searches[n].way_mm.norm()) > voxel.distance_mm() + kSameDistance * voxel_mm_) continue;
      voxel.way_mm = searches[n].way_mm;
      voxel.is_found = true;
    }
  }

  static inline const std::array<Coord, 26> kSteps = neighbour_steps();

  const ScalarField& field_;
  const Progress& progress_;
  double voxel_mm_, band_mm_;
  std::size_t evaluations_ = 0;
  std::vector<BandVoxel> voxels_;
  openvdb::Int32Tree places_;  ///< of each voxel, its place in voxels_
  openvdb::tree::ValueAccessor<openvdb::Int32Tree> place_;
  std::size_t layer_begin_ = 0;
};

/// The nearest number that a half float has, with its sign and never zero.
float signed_half(double distance_mm, bool is_inside) {
  const float value = rounded_to_half(static_cast<float>(distance_mm));
  const float smallest = static_cast<float>(std::numeric_limits<openvdb::math::half>::denorm_min());
  return std::copysign(std::max(value, smallest), is_inside ? -1.0F : 1.0F);
}

}  // namespace

openvdb::FloatGrid::Ptr with_true_distances(const openvdb::FloatGrid& near, const openvdb::Vec3SGrid& ways_mm,
                                            const ScalarField& field, float band_mm, std::size_t& evaluations,
                                            const Progress& progress) {
  ClosestPoints closest(near, ways_mm, field, static_cast<double>(band_mm), progress);
  closest.find_near();
  while (closest.widen()) {
  }
  closest.exchange();
  evaluations += closest.evaluations();

  openvdb::FloatGrid::Ptr grid = openvdb::FloatGrid::create(band_mm);
  grid->setTransform(near.transform().copy());
  auto accessor = grid->getAccessor();
  const auto first_order = near.getConstAccessor();
  for (const BandVoxel& voxel : closest.voxels()) {
    const float known = first_order.getValue(voxel.at);
    // Where no way led to the zero set, the distance to first order is the best there is.
    const double distance_mm = voxel.is_found ? voxel.distance_mm() : static_cast<double>(std::abs(known));
    if (!(distance_mm < static_cast<double>(band_mm))) continue;
    const float value = signed_half(distance_mm, known < 0.0F);
    if (std::abs(value) < band_mm) accessor.setValue(voxel.at, value);
  }
  openvdb::tools::signedFloodFill(grid->tree());
  openvdb::tools::pruneLevelSet(grid->tree());
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  return grid;
}

}  // namespace spinaltap::detail
