// The fast engine. Three ideas:
//
// 1. Certificates. A disc that was just looked at has a nearest occupied point; until the bit has moved by the gap to
// it,
//    the disc needs no look. How much of a move counts depends on where the bit is: behind the cone only what goes
//    across its axis, in the cone also what goes forward, by the cone's slope. All discs are checked in one vector
//    loop. Behind the cone a disc also knows an empty circle: a bit that trembles in its hole comes back to it.
// 2. Gaps. A disc that does need a look knows for each ring between which occupied points the bit lies. Another vector
//    loop finds the few of these that the bit may reach; the others give the next certificate.
// 3. Walks over occupied points only. From those on set bits are visited, on the side of the ring that is reached,
//    until they are too far to be removed or to be the nearest survivor.
//
// Which points die is decided as in every engine: by SweptBit, asked only within what the step and its rounding leave
// open.

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>

#include "core/engine/detail/disc_certificates.h"
#include "core/engine/detail/empty_circles.h"
#include "core/engine/detail/nearest_point.h"
#include "core/engine/detail/ring_gaps.h"
#include "core/engine/volume_engine.h"
#include "core/points/occupied_bits.h"

namespace spinaltap {
namespace {

/// Axes nearer to the discs' planes than this (cosine) get no certificates.
constexpr double kSteepest = 0.25;
/// Certificates are about lines whose slopes differ by at most twice this.
constexpr double kMaxTurn = 0.1;
constexpr int kMaxRings = 4096;

class RingEngine final : public VolumeEngine {
 public:
  RingEngine(PointVolume& volume, const DrillBit& bit, const Material& material, const detail::DiscKernels& kernels)
      : VolumeEngine(volume, bit, material),
        certificates_(static_cast<std::size_t>(volume.disc_count()), volume.pattern().spacing_mm(), kernels),
        circles_(static_cast<std::size_t>(volume.disc_count())),
        gaps_(static_cast<std::size_t>(volume.disc_count()), volume.pattern(), kernels),
        first_occupied_ring_(static_cast<std::size_t>(volume.disc_count()), 0),
        due_(static_cast<std::size_t>(volume.disc_count()), 0),
        rings_per_mm_(1.0 / volume.pattern().spacing_mm()),
        deviation_mm_(volume.deviation_mm(volume.pattern().ring_count() - 1)) {}

  std::size_t memory_bytes() const override {
    return VolumeEngine::memory_bytes() + certificates_.memory_bytes() + circles_.memory_bytes() +
           gaps_.memory_bytes() + first_occupied_ring_.size() * sizeof(first_occupied_ring_[0]) +
           due_.size() * sizeof(due_[0]);
  }

 protected:
  void remove(const SweptBit& bit, Removal& removal) noexcept override {
    if (std::abs(bit.to().axis.z()) < kSteepest) {
      remove_without_certificates(bit, removal);
      return;
    }
    const detail::PointApproach approach(bit, volume_.out_of_plane_mm());
    if (!is_near_reference(approach.line)) {
      reference_ = approach.line;
      has_reference_ = true;
      certificates_.fail_all();
    }
    const AxisLine line = from_reference(approach.line);
    certificates_.check(motion(approach, line));
    const std::size_t due_count = find_due(bit);
    if (is_worth_sharing(approach, due_count)) {
      removal.add(tbb::parallel_reduce(
          tbb::blocked_range<std::size_t>(0, due_count, 8), removal.empty(),
          [&](const tbb::blocked_range<std::size_t>& range, Removal sum) {
            for (std::size_t n = range.begin(); n < range.end(); ++n) cut_disc(due_[n], approach, line, sum);
            return sum;
          },
          [](Removal a, const Removal& b) {
            a.add(b);
            return a;
          }));
      return;
    }
    for (std::size_t n = 0; n < due_count; ++n) cut_disc(due_[n], approach, line, removal);
  }

 private:
  AxisLine from_reference(const AxisLine& line) const noexcept {
    return {line.x_mm - reference_.x_mm,       line.y_mm - reference_.y_mm,
            line.x_slope - reference_.x_slope, line.y_slope - reference_.y_slope,
            line.back_mm - reference_.back_mm, line.back_slope - reference_.back_slope};
  }

  /// How far a line lies from the reference, at most, within the volume.
  double from_reference_mm(const AxisLine& from) const noexcept {
    const double depth_mm = volume_.disc_depth_mm(volume_.disc_count());
    return std::abs(from.x_mm) + std::abs(from.y_mm) + depth_mm * (std::abs(from.x_slope) + std::abs(from.y_slope));
  }

  bool is_near_reference(const AxisLine& line) const noexcept {
    constexpr double kMaxMm = 4.0;
    const AxisLine from = from_reference(line);
    return has_reference_ && std::abs(from.x_slope) + std::abs(from.y_slope) < kMaxTurn &&
           from_reference_mm(from) < kMaxMm;
  }

  DiscCertificates::Motion motion(const detail::PointApproach& approach, const AxisLine& line) const noexcept {
    DiscCertificates::Motion motion;
    motion.line = line;
    const SweptBit& bit = approach.bit;
    const double slope = approach.is_tight ? approach.slope : 1.0;
    motion.counts_backward = !approach.is_tight;
    // The foot of a point on the axis lies off the disc's plane, by the tilt; so turning moves it there. It also
    // changes the ellipses, by no more than that again.
    const double far_mm = 1.2 * (approach.radius_mm + 2.0 * detail::kLongestMm) / (approach.along * approach.along);
    motion.turn_mm = 2.0 * far_mm * (approach.sine + 2.0 * kMaxTurn + slope) + volume_.out_of_plane_mm();
    // Ellipses move with the axis. Of other outlines a tilted bit's points come further back, too.
    motion.across_share = approach.is_tight ? 1.0 : 1.0 + slope * (approach.sine + 2.0 * kMaxTurn);
    // Between both ends of its way the bit may be further off than at either, by what turning bends it.
    const double turn = (bit.to().axis - bit.from().axis).norm() / (approach.along * approach.along);
    const double way_mm = (bit.to().tip_mm - bit.from().tip_mm).norm();
    const double reach_mm = bit.profile().length_mm() + approach.radius_mm;
    motion.slack_mm =
        (turn * (way_mm + 4.0 * turn * reach_mm) + bit.edge_mm()) * (1.0 + slope) + 1e-6 * from_reference_mm(line);
    return motion;
  }

  /// Lists the discs that the bit may reach and whose certificates do not hold.
  std::size_t find_due(const SweptBit& bit) noexcept {
    const auto [first, last] = discs_within(bit);
    const std::span<const std::uint8_t> due = certificates_.due();
    std::size_t count = 0;
    for (int begin = first / 8 * 8; begin <= last; begin += 8) {
      std::uint64_t eight = 0;  // mostly none of them is due
      std::memcpy(&eight, due.data() + begin, 8);
      if (eight == 0) continue;
      for (int disc = std::max(begin, first); disc <= std::min(begin + 7, last); ++disc) {
        if (due[static_cast<std::size_t>(disc)] != 0) due_[count++] = disc;
      }
    }
    return count;
  }

  bool is_worth_sharing(const detail::PointApproach& approach, std::size_t due_count) const noexcept {
    // Measured on two cores: sharing breaks even at about 20 us of work; a look at a disc costs 0.1 us, a point 10 ns.
    // Of small steps that is up to twice the work, for some discs turn out to be clear.
    constexpr double kMinUs = 50.0;
    const double spacing_mm = volume_.pattern().spacing_mm();
    const double way_mm = approach.bit.across_mm() + approach.slope * approach.bit.back_mm();
    const double points = std::min(2.0 * approach.radius_mm * way_mm / (spacing_mm * spacing_mm),
                                   static_cast<double>(volume_.pattern().point_count()));
    return due_count > 16 && static_cast<double>(due_count) * (0.1 + 0.01 * points) > kMinUs;
  }

  void cut_disc(int disc, const detail::PointApproach& approach, const AxisLine& line, Removal& removal) noexcept {
    const double z_mm = volume_.disc_depth_mm(disc);
    detail::NearestPoint nearest(approach, z_mm);
    if (deviation_mm_ > 0.0) {
      walk_all_rings(disc, z_mm, nearest, removal);
    } else if (!nearest.is_behind_cone()) {
      walk_reached_rings(disc, z_mm, nearest, removal);
    } else if (const double clear_mm = circles_.clear_mm(disc, nearest.x_mm(), nearest.y_mm());
               clear_mm > nearest.touched_mm()) {
      nearest.add_distance(clear_mm);
    } else {
      walk_reached_rings(disc, z_mm, nearest, removal);
      renew_circle(disc, nearest);
    }
    certificates_.renew(disc, line, nearest.free_mm(), nearest.back_share());
  }

  using ReachedEnds = std::array<std::uint8_t, kMaxRings + 2 * detail::kLongestVector>;

  /// Rings from the first to before the last that have points within `reach_mm` of a place so far off the path.
  std::pair<int, int> rings_within(int disc, double off_axis_mm, double reach_mm) const noexcept {
    const int rings = volume_.pattern().ring_count();
    const auto ring_at = [&](double mm) { return static_cast<int>(std::clamp(mm * rings_per_mm_, 0.0, 1.0 * rings)); };
    return {std::max(first_occupied_ring_[static_cast<std::size_t>(disc)], ring_at(off_axis_mm - reach_mm)),
            std::min(rings, ring_at(off_axis_mm + reach_mm) + 2)};
  }

  void walk_reached_rings(int disc, double z_mm, detail::NearestPoint& nearest, Removal& removal) noexcept {
    ReachedEnds reached;
    const auto [begin, end] = rings_within(disc, nearest.off_axis_mm(), nearest.reach_mm());
    if (begin >= end) return;
    // Eight bytes are read at once below; vectors may end before.
    std::memset(reached.data() + (end - begin) / 8 * 8, 0, 8);
    nearest.add_off_centre(gaps_.min_distance_mm(disc, begin, end, nearest.x_mm(), nearest.y_mm(),
                                                 nearest.touched_off_centre_mm(), nearest.ellipse(), reached.data()));
    for (int offset = 0; offset < end - begin; offset += 8) {
      std::uint64_t eight = 0;
      std::memcpy(&eight, reached.data() + offset, 8);
      while (eight != 0) {
        const int place = std::countr_zero(eight) / 8;
        const std::uint64_t ends = eight >> 8 * place & 0xff;
        eight ^= ends << 8 * place;
        walk_ring(disc, begin + offset + place, z_mm, static_cast<std::uint8_t>(ends), nearest, removal);
      }
    }
    int& first = first_occupied_ring_[static_cast<std::size_t>(disc)];
    while (first < volume_.pattern().ring_count() && gaps_.is_dead(disc, first)) ++first;
  }

  void renew_circle(int disc, const detail::NearestPoint& nearest) noexcept {
    const double reach_mm = nearest.touched_mm() + detail::kLongestMm;
    circles_.renew(disc, nearest.x_mm(), nearest.y_mm(), [&](double x_mm, double y_mm) {
      ReachedEnds none;
      const auto [begin, end] = rings_within(disc, std::sqrt(x_mm * x_mm + y_mm * y_mm), reach_mm);
      return std::min(reach_mm, gaps_.min_distance_mm(disc, begin, std::max(begin, end), x_mm, y_mm, -1.0,
                                                      detail::kCircle, none.data()));
    });
  }

  /// Where points lie off their rings, gaps say nothing.
  void walk_all_rings(int disc, double z_mm, detail::NearestPoint& nearest, Removal& removal) noexcept {
    const double spacing_mm = volume_.pattern().spacing_mm();
    for (int ring = 0; ring < volume_.pattern().ring_count(); ++ring) {
      const double gap_mm = std::abs(ring * spacing_mm - nearest.off_axis_mm());
      if (gap_mm > nearest.reach_mm() + 2.0 * volume_.deviation_mm(ring)) continue;
      walk_ring(disc, ring, z_mm, detail::kReachesBoth, nearest, removal);
    }
  }

  /// Where walks from the ring's place nearest to the middle begin, downwards and upwards.
  RingGaps::Ends nearest_places(int ring, const detail::NearestPoint& nearest) const noexcept {
    const std::size_t size = DiscPattern::ring_size(ring);
    // Within half a turn of 0: truncation and one more turn take the place of divisions.
    const double place = nearest.turns() * static_cast<double>(size);
    const auto rounded = static_cast<std::int32_t>(place < 0.0 ? place - 0.5 : place + 0.5);
    const auto whole = static_cast<std::int32_t>(size);
    const auto middle = static_cast<std::size_t>(rounded < 0 ? rounded + whole : rounded < whole ? rounded : 0);
    return {middle > 0 ? middle - 1 : size - 1, middle};
  }

  /// Visits occupied points from those ends of the ring's gap on that are reached; from the middle to both sides where
  /// it faces no gap that is known.
  void walk_ring(int disc, int ring, double z_mm, std::uint8_t reached, detail::NearestPoint& nearest,
                 Removal& removal) noexcept {
    std::uint64_t* words = volume_.occupancy_words(disc).data();
    const std::size_t start = DiscPattern::ring_start(ring);
    const std::size_t end = start + DiscPattern::ring_size(ring);
    const double ring_mm = ring * volume_.pattern().spacing_mm();
    const double deviation_mm = 2.0 * volume_.deviation_mm(ring);
    const double max_mm = nearest.touched_mm() + deviation_mm;
    const double max_square = max_mm < 0.0 ? -1.0 : max_mm * max_mm;
    std::size_t survivor = RingGaps::kNowhere;  ///< the first of this direction
    bool is_upwards = true;
    // Towards the side of the ring away from the middle, points are ever further from it.
    const auto visit = [&](std::size_t index) {
      ++removal.tested;
      const Vec3 p = volume_.point_in_path_mm(disc, index);
      const double x = p.x() - nearest.x_mm();
      const double y = p.y() - nearest.y_mm();
      const double square = x * x + y * y;
      const bool is_far = square > max_square;
      if (!is_far && nearest.removes(p, z_mm)) {
        words[index / 64] &= ~(std::uint64_t{1} << (index % 64));
        account(disc, index, removal);
        return true;
      }
      if (survivor == RingGaps::kNowhere) survivor = index - start;
      if (!is_far) return true;
      if (deviation_mm > 0.0) {
        nearest.add_distance(std::sqrt(square) - deviation_mm);
      } else {
        nearest.add_end(ring_mm, is_upwards, p);
      }
      return false;
    };
    RingGaps::Ends gap = gaps_.faced_gap(disc, ring, nearest.x_mm(), nearest.y_mm());
    if (gap.above == RingGaps::kNowhere) {
      gap = nearest_places(ring, nearest);
      reached = detail::kReachesBoth;
    }
    const auto [down_from, up_from] = gap;
    const bool is_round_the_end = up_from > down_from;
    // Mostly a few points of a side are reached: words are looked at beyond the first only.
    const auto goes_on = [&](std::size_t place) {
      const std::size_t index = start + place;
      return (words[index / 64] >> (index % 64) & 1) == 0 || visit(index);
    };
    if ((reached & detail::kReachesAbove) != 0) {
      if (goes_on(up_from) &&
          visit_up(words, start + up_from + 1, is_round_the_end ? end : start + down_from + 1, visit) &&
          is_round_the_end) {
        visit_up(words, start, start + down_from + 1, visit);
      }
      gap.above = survivor;
      if (survivor == RingGaps::kNowhere) return gaps_.set_dead(disc, ring);
    }
    if ((reached & detail::kReachesBelow) != 0) {
      survivor = RingGaps::kNowhere;
      is_upwards = false;
      if (goes_on(down_from) &&
          visit_down(words, is_round_the_end ? start : start + up_from, start + down_from, visit) && is_round_the_end) {
        visit_down(words, start + up_from, end, visit);
      }
      gap.below = survivor;
      if (survivor == RingGaps::kNowhere) return gaps_.set_dead(disc, ring);
    }
    if (ring > 0) gaps_.set_gap(disc, ring, gap.below, gap.above);
  }

  void remove_without_certificates(const SweptBit& bit, Removal& removal) noexcept {
    certificates_.fail_all();
    const auto [first, last] = discs_within(bit);
    for (int disc = first; disc <= last; ++disc) {
      std::uint64_t* words = volume_.occupancy_words(disc).data();
      visit_up(words, 0, volume_.pattern().point_count(), [&](std::size_t index) {
        ++removal.tested;
        if (bit.contains_inlined(volume_.point_in_path_mm(disc, index))) kill(disc, index, removal);
        return true;
      });
    }
  }

  DiscCertificates certificates_;
  EmptyCircles circles_;
  RingGaps gaps_;
  std::vector<int> first_occupied_ring_;  ///< per disc: every ring within is wholly destroyed
  std::vector<int> due_;                  ///< discs to look at, for one step
  double rings_per_mm_;
  double deviation_mm_;  ///< of points from their rings, at most
  AxisLine reference_;
  bool has_reference_ = false;
};

}  // namespace

std::unique_ptr<DrillEngine> make_ring_engine(PointVolume& volume, const DrillBit& bit, const Material& material) {
  return detail::make_ring_engine(volume, bit, material, detail::disc_kernels().back());
}

std::unique_ptr<DrillEngine> detail::make_ring_engine(PointVolume& volume, const DrillBit& bit,
                                                      const Material& material, const DiscKernels& kernels) {
  return std::make_unique<RingEngine>(volume, bit, material, kernels);
}

}  // namespace spinaltap
