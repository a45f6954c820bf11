// The paper's collision algorithm: section 7.1 and algorithm 1. Changed from the paper:
// - the ring bound uses the ellipse in which a tilted bit meets the disc's plane, not the circle of its radius;
// - a step's whole way is swept, so that no point is jumped;
// - the bit is kept in path-local coordinates, where numbers are small.

#include <cmath>

#include "core/engine/detail/disc_section.h"
#include "core/engine/volume_engine.h"

namespace spinaltap {
namespace {

class ReferenceEngine final : public VolumeEngine {
 public:
  ReferenceEngine(PointVolume& volume, const DrillBit& bit, const Material& material)
      : VolumeEngine(volume, bit, material), first_living_ring_(static_cast<std::size_t>(volume.disc_count()), 0) {}

  std::size_t memory_bytes() const override {
    return VolumeEngine::memory_bytes() + first_living_ring_.size() * sizeof(first_living_ring_[0]);
  }

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
    int& first_living_ring = first_living_ring_[static_cast<std::size_t>(disc)];
    bool all_dead_so_far = true;
    for (int ring = first_living_ring; ring <= outermost; ++ring) {
      const std::size_t begin = DiscPattern::ring_start(ring);
      const std::size_t end = begin + DiscPattern::ring_size(ring);
      bool ring_dead = true;
      for (std::size_t i = begin; i < end; ++i) ring_dead &= remove_point(disc, i, bit, removal);
      all_dead_so_far &= ring_dead;
      if (all_dead_so_far) first_living_ring = ring + 1;
    }
  }

  /// Whether the point is dead afterwards.
  bool remove_point(int disc, std::size_t index, const SweptBit& bit, Removal& removal) noexcept {
    if (!volume_.is_alive(disc, index)) return true;
    ++removal.tested;
    if (!bit.contains(volume_.point_in_path_mm(disc, index))) return false;
    kill(disc, index, removal);
    return true;
  }

  std::vector<int> first_living_ring_;  ///< per disc: every ring within is wholly destroyed
};

}  // namespace

std::unique_ptr<DrillEngine> make_reference_engine(PointVolume& volume, const DrillBit& bit, const Material& material) {
  return std::make_unique<ReferenceEngine>(volume, bit, material);
}

}  // namespace spinaltap
