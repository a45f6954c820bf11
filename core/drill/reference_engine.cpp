// The paper's collision algorithm: section 7.1 and algorithm 1. Changed from the paper:
// - the ring bound uses the ellipse in which a tilted bit meets the disc's plane, not the circle of its radius;
// - a step longer than half the point spacing is walked in poses at most that far apart, so that no point is jumped;
// - the bit is kept in path-local coordinates, where numbers are small.

#include <algorithm>
#include <cmath>

#include "core/drill/drill_engine.h"

namespace spinaltap {
namespace {

class ReferenceEngine final : public DrillEngine {
 public:
  ReferenceEngine(PointVolume& volume, const DrillBit& bit, const Material& material)
      : volume_(volume),
        bit_(bit),
        pressure_(material),
        first_living_ring_(static_cast<std::size_t>(volume.disc_count()), 0) {
    check_bit(bit);
  }

  StepResult step(const Pose& pose) noexcept override {
    StepResult result;
    const Pose target = volume_.frame().to_path(pose);
    const double axis_length = target.axis.norm();
    if (!target.tip_mm.allFinite() || !(std::abs(axis_length - 1.0) < 1e-6)) return result;
    if (!placed_) {
      placed_ = true;
      pose_ = target;
    }
    const Pose start = pose_;
    const int poses = poses_between(start, target);
    pressure_sum_ = {0, 0};
    for (int i = 1; i <= poses; ++i) {
      const double t = static_cast<double>(i) / poses;
      pose_ = i == poses ? target : between(start, target, t);
      remove_at_pose(result);
    }
    const DiscPattern& pattern = volume_.pattern();
    result.work_n_mm = PressureTable::kUnitMpa * (static_cast<double>(pressure_sum_[0]) * pattern.point_volume_mm3(0) +
                                                  static_cast<double>(pressure_sum_[1]) * pattern.point_volume_mm3(1));
    const double advance_mm = (target.tip_mm - start.tip_mm).dot(target.axis);
    if (advance_mm > 0.0) result.thrust_n = result.work_n_mm / advance_mm;
    return result;
  }

 private:
  static Pose between(const Pose& start, const Pose& target, double t) noexcept {
    const Vec3 axis = start.axis + t * (target.axis - start.axis);
    // Half way between opposite axes lies none: the bit is turned round at once there.
    const double length = axis.norm();
    return {start.tip_mm + t * (target.tip_mm - start.tip_mm), length > 1e-9 ? Vec3(axis / length) : target.axis};
  }

  /// How many poses make steps of at most half a spacing, measured at the tip and at the base.
  int poses_between(const Pose& start, const Pose& target) const noexcept {
    constexpr double kMaxPoses = 1e6;
    const double tip_mm = (target.tip_mm - start.tip_mm).norm();
    const double base_mm = tip_mm + bit_.length_mm * (target.axis - start.axis).norm();
    const double poses = std::ceil(base_mm / (0.5 * volume_.pattern().spacing_mm()));
    return static_cast<int>(std::clamp(poses, 1.0, kMaxPoses));
  }

  void remove_at_pose(StepResult& result) noexcept {
    const double spacing_mm = volume_.pattern().spacing_mm();
    const Vec3 base_mm = pose_.tip_mm - bit_.length_mm * pose_.axis;
    // The flat ends of a tilted bit reach beyond its axis's ends.
    const double along = pose_.axis.z();
    const double rim_mm = bit_.radius_mm() * std::sqrt(std::max(0.0, 1.0 - along * along));
    const Vec3 shoulder_mm = pose_.tip_mm - bit_.tip_length_mm * pose_.axis;
    const double deepest_mm = std::max({pose_.tip_mm.z(), base_mm.z() + rim_mm, shoulder_mm.z() + rim_mm});
    const double shallowest_mm = std::min({pose_.tip_mm.z(), base_mm.z() - rim_mm, shoulder_mm.z() - rim_mm});
    const double last_disc = volume_.disc_count() - 1;
    // One disc more on each side than the division says: rounding may not cost a disc.
    const double first = std::clamp(std::floor(shallowest_mm / spacing_mm) - 1.0, 0.0, last_disc + 1.0);
    const double last = std::clamp(std::ceil(deepest_mm / spacing_mm) + 1.0, -1.0, last_disc);
    for (int disc = static_cast<int>(first); disc <= static_cast<int>(last); ++disc) remove_in_disc(disc, result);
  }

  /// The outermost ring that the bit's section with the disc's plane can reach.
  int outermost_ring(int disc) const noexcept {
    const int last_ring = volume_.pattern().ring_count() - 1;
    const double along = std::abs(pose_.axis.z());
    if (along < 1e-3) return last_ring;  // The axis lies in the plane: the section is no ellipse.
    const double to_plane_mm = (volume_.disc_depth_mm(disc) - pose_.tip_mm.z()) / pose_.axis.z();
    const Vec3 centre_mm = pose_.tip_mm + to_plane_mm * pose_.axis;
    const double reach_mm = std::hypot(centre_mm.x(), centre_mm.y()) + bit_.radius_mm() / along;
    return static_cast<int>(
        std::min(std::floor(reach_mm / volume_.pattern().spacing_mm()) + 1.0, static_cast<double>(last_ring)));
  }

  void remove_in_disc(int disc, StepResult& result) noexcept {
    const int outermost = outermost_ring(disc);
    int& first_living_ring = first_living_ring_[static_cast<std::size_t>(disc)];
    bool all_dead_so_far = true;
    for (int ring = first_living_ring; ring <= outermost; ++ring) {
      const std::size_t begin = DiscPattern::ring_start(ring);
      const std::size_t end = begin + DiscPattern::ring_size(ring);
      bool ring_dead = true;
      for (std::size_t i = begin; i < end; ++i) {
        ring_dead &= remove_point(disc, i, ring, result);
      }
      all_dead_so_far &= ring_dead;
      if (all_dead_so_far) first_living_ring = ring + 1;
    }
  }

  /// Whether the point is dead afterwards.
  bool remove_point(int disc, std::size_t index_in_disc, int ring, StepResult& result) noexcept {
    const std::size_t index = volume_.disc_start(disc) + index_in_disc;
    std::uint8_t& alive = volume_.alive()[index];
    if (alive == 0) return true;
    ++result.tested;
    if (!bit_contains(bit_, pose_, volume_.point_in_path_mm(disc, index_in_disc))) return false;
    alive = 0;
    const std::int16_t hu = volume_.hu()[index];
    ++result.removed;
    result.removed_hu += hu;
    pressure_sum_[ring == 0 ? 0 : 1] += pressure_.units(hu);
    return true;
  }

  PointVolume& volume_;
  DrillBit bit_;
  PressureTable pressure_;
  std::vector<int> first_living_ring_;              ///< per disc: every ring within is wholly destroyed
  std::array<std::int64_t, 2> pressure_sum_{0, 0};  ///< of this step's dead: centres, points of rings
  Pose pose_;                                       ///< path-local
  bool placed_ = false;
};

}  // namespace

std::unique_ptr<DrillEngine> make_reference_engine(PointVolume& volume, const DrillBit& bit, const Material& material) {
  return std::make_unique<ReferenceEngine>(volume, bit, material);
}

}  // namespace spinaltap
