// The two engines that the paper describes.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/engine/volume_engine.h"
#include "core/points/occupied_bits.h"

namespace spinaltap {
namespace {

/// Where a bit's axis meets the plane of a disc, and how far around the swept bit can reach there.
struct DiscSection {
  double x_mm = 0.0;
  double y_mm = 0.0;
  double reach_mm = 0.0;  ///< from (x, y) in the plane; infinite where the axis lies nearly in the plane

  /// Within `out_of_plane_mm` of the plane at z. A bit's section with a plane is an ellipse, or less, that is longer
  /// than its radius by the tilt.
  DiscSection(const SweptBit& bit, double z_mm, double out_of_plane_mm) {
    const Pose& pose = bit.to();
    const double along = std::abs(pose.axis.z());
    if (along < 1e-3) {
      reach_mm = HUGE_VAL;
      return;
    }
    const double to_plane_mm = (z_mm - pose.tip_mm.z()) / pose.axis.z();
    x_mm = pose.tip_mm.x() + to_plane_mm * pose.axis.x();
    y_mm = pose.tip_mm.y() + to_plane_mm * pose.axis.y();
    reach_mm = (bit.profile().radius_mm() + bit.across_mm() + out_of_plane_mm) / along + 1e-4;
  }
};

/// An engine that knows of each disc how many of its innermost rings are wholly destroyed.
class RingsEngine : public VolumeEngine {
 public:
  RingsEngine(PointVolume& volume, const DrillBit& bit, const Material& material)
      : VolumeEngine(volume, bit, material), first_occupied_ring_(static_cast<std::size_t>(volume.disc_count()), 0) {}

  std::size_t memory_bytes() const override {
    return VolumeEngine::memory_bytes() + first_occupied_ring_.size() * sizeof(first_occupied_ring_[0]);
  }

 protected:
  std::vector<int> first_occupied_ring_;  ///< per disc: every ring within is wholly destroyed
};

// The paper's collision algorithm: section 7.1 and algorithm 1. Changed from the paper:
// - the ring bound uses the ellipse in which a tilted bit meets the disc's plane, not the circle of its radius;
// - a step's whole way is swept, so that no point is jumped;
// - the bit is kept in path-local coordinates, where numbers are small.
class ReferenceEngine final : public RingsEngine {
 public:
  using RingsEngine::RingsEngine;

 protected:
  void remove(const SweptBit& bit, Removal& removal) noexcept override {
    const auto [first, last] = discs_within(bit);
    for (int disc = first; disc <= last; ++disc) remove_in_disc(disc, bit, removal);
  }

 private:
  /// The outermost ring that the bit's section with the disc's plane can reach.
  int outermost_ring(int disc, const SweptBit& bit) const noexcept {
    const DiscPattern& pattern = volume_.pattern();
    const int last_ring = pattern.ring_count() - 1;
    const DiscSection section(bit, volume_.disc_depth_mm(disc), volume_.out_of_plane_mm());
    const double reach_mm = std::hypot(section.x_mm, section.y_mm) + section.reach_mm + volume_.deviation_mm(last_ring);
    return static_cast<int>(
        std::min(std::floor(reach_mm / pattern.spacing_mm()) + 1.0, static_cast<double>(last_ring)));
  }

  void remove_in_disc(int disc, const SweptBit& bit, Removal& removal) noexcept {
    const int outermost = outermost_ring(disc, bit);
    int& first_occupied_ring = first_occupied_ring_[static_cast<std::size_t>(disc)];
    bool all_dead_so_far = true;
    for (int ring = first_occupied_ring; ring <= outermost; ++ring) {
      const std::size_t begin = DiscPattern::ring_start(ring);
      const std::size_t end = begin + DiscPattern::ring_size(ring);
      bool ring_dead = true;
      for (std::size_t i = begin; i < end; ++i) ring_dead &= remove_point(disc, i, bit, removal);
      all_dead_so_far &= ring_dead;
      if (all_dead_so_far) first_occupied_ring = ring + 1;
    }
  }

  /// Whether the point is dead afterwards.
  bool remove_point(int disc, std::size_t index, const SweptBit& bit, Removal& removal) noexcept {
    if (!volume_.is_occupied(disc, index)) return true;
    ++removal.tested;
    if (!bit.contains_inlined(volume_.point_in_path_mm(disc, index))) return false;
    kill(disc, index, removal);
    return true;
  }
};

// The paper's section 7.2, its correction for the bias towards on-path drilling: on each ring the walk starts at the
// point nearest the bit's axis and goes both ways. Changed from the paper: the walk does not end at the first point
// that the bit misses, because a tilted bit's section can meet a ring four times; it ends where the ellipse around that
// section, widened by the step, can no longer reach.
class ArcEngine final : public RingsEngine {
 public:
  using RingsEngine::RingsEngine;

 protected:
  void remove(const SweptBit& bit, Removal& removal) noexcept override {
    const auto [first, last] = discs_within(bit);
    for (int disc = first; disc <= last; ++disc) {
      const DiscSection section(bit, volume_.disc_depth_mm(disc), volume_.out_of_plane_mm());
      const double turns = std::atan2(section.y_mm, section.x_mm) / (2.0 * std::numbers::pi);
      int& first_occupied_ring = first_occupied_ring_[static_cast<std::size_t>(disc)];
      const int rings = volume_.pattern().ring_count();
      for (int ring = first_occupied_ring; ring < rings; ++ring) walk(disc, ring, section, turns, bit, removal);
      while (first_occupied_ring < rings && is_dead(disc, first_occupied_ring)) ++first_occupied_ring;
    }
  }

 private:
  bool is_dead(int disc, int ring) const noexcept {
    const std::size_t begin = DiscPattern::ring_start(ring);
    return visit_up(volume_.occupancy_words(disc).data(), begin, begin + DiscPattern::ring_size(ring),
                    [](std::size_t) { return false; });
  }

  void walk(int disc, int ring, const DiscSection& section, double turns, const SweptBit& bit,
            Removal& removal) noexcept {
    const double ring_mm = ring * volume_.pattern().spacing_mm();
    const double reach_mm = section.reach_mm + volume_.deviation_mm(ring);
    const double off_mm = std::hypot(section.x_mm, section.y_mm);
    if (std::abs(off_mm - ring_mm) > reach_mm) return;
    // Law of cosines: from this angle on, to both sides of the axis, the ring is out of reach.
    double share = 1.0;
    if (off_mm * ring_mm > 0.0 && reach_mm < off_mm + ring_mm) {
      const double cosine = (off_mm * off_mm + ring_mm * ring_mm - reach_mm * reach_mm) / (2.0 * off_mm * ring_mm);
      share = std::acos(std::clamp(cosine, -1.0, 1.0)) / std::numbers::pi;
    }
    const auto size = static_cast<int>(DiscPattern::ring_size(ring));
    const int nearest = static_cast<int>(std::lround(turns * size));
    // A point more for rounding.
    const int steps = std::min(size / 2, static_cast<int>(std::ceil(0.5 * share * size)) + 1);
    const int twice = 2 * steps + 1 > size ? 1 : 0;  // a walk all around would meet its last point from both sides
    for (int step = -steps; step <= steps - twice; ++step) {
      const int place = (nearest + step + 2 * size) % size;
      remove_point(disc, DiscPattern::ring_start(ring) + static_cast<std::size_t>(place), bit, removal);
    }
  }

  void remove_point(int disc, std::size_t index, const SweptBit& bit, Removal& removal) noexcept {
    if (!volume_.is_occupied(disc, index)) return;
    ++removal.tested;
    if (bit.contains_inlined(volume_.point_in_path_mm(disc, index))) kill(disc, index, removal);
  }
};

}  // namespace

std::unique_ptr<DrillEngine> make_reference_engine(PointVolume& volume, const DrillBit& bit, const Material& material) {
  return std::make_unique<ReferenceEngine>(volume, bit, material);
}

std::unique_ptr<DrillEngine> make_arc_engine(PointVolume& volume, const DrillBit& bit, const Material& material) {
  return std::make_unique<ArcEngine>(volume, bit, material);
}

}  // namespace spinaltap
