#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/progress.h"
#include "core/points/disc_pattern.h"
#include "core/points/hu_byte.h"
#include "core/points/point_volume_options.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// The cylinder of discs of rings of points that a bit decimates (the paper's section 6). A point's position follows
/// from its indices; what is stored of it is one bit, whether it is occupied, and its CT number.
class PointVolume {
 public:
  /// A cylinder along the path, every point occupied and of 0 HU. Discs: (lead-in + path length) / spacing, rounded. Of
  /// a curved path it lies along its chord, wider by as much as the path is off that, in whole spacings, and so long
  /// that it holds all within `radius_mm` of the path from the lead-in to the target. Throws Error on absurd sizes
  /// (over 2^32 points).
  PointVolume(const DrillPath& path, const PointVolumeOptions& options);

  const PathFrame& frame() const { return frame_; }
  const DiscPattern& pattern() const { return pattern_; }
  int disc_count() const { return disc_count_; }
  std::size_t point_count() const { return static_cast<std::size_t>(disc_count_) * pattern_.point_count(); }
  std::size_t occupied_count() const;
  double lead_in_mm() const { return lead_in_mm_; }
  /// Of all that is stored for the points.
  std::size_t memory_bytes() const;

  /// Distance of a disc from the volume's start along the path, mm.
  double disc_depth_mm(int disc) const { return disc * pattern_.spacing_mm(); }
  /// Position in path-local coordinates, mm.
  Vec3 point_in_path_mm(int disc, std::size_t index) const {
    const Eigen::Vector2d& p = pattern_.point_mm(index);
    const Vec3 nominal(p.x(), p.y(), disc_depth_mm(disc));
    return jitter_mm_ > 0.0 ? Vec3(nominal + jitter(disc, index)) : nominal;
  }
  /// How far points of a ring lie, at most, from even steps around its circle in the disc's plane, mm.
  double deviation_mm(int ring) const;
  /// How far points lie, at most, out of their disc's plane, mm.
  double out_of_plane_mm() const { return jitter_mm_; }

  bool is_occupied(int disc, std::size_t index) const { return (word(disc, index) >> (index % 64) & 1) != 0; }
  void set_occupied(int disc, std::size_t index, bool occupied) {
    const std::uint64_t bit = std::uint64_t{1} << (index % 64);
    std::uint64_t& word = occupied_[word_index(disc, index)];
    word = occupied ? word | bit : word & ~bit;
  }
  /// A disc's points, 64 to a word, the lowest bit first; bits beyond the last point are 0.
  std::span<const std::uint64_t> occupancy_words(int disc) const {
    return {occupied_.data() + word_index(disc, 0), words_per_disc_};
  }
  std::span<std::uint64_t> occupancy_words(int disc) {
    return {occupied_.data() + word_index(disc, 0), words_per_disc_};
  }
  /// All discs' words.
  std::span<const std::uint64_t> occupancy_words() const { return occupied_; }

  /// Of a point, as stored.
  std::int16_t hu(int disc, std::size_t index) const {
    const std::size_t n = static_cast<std::size_t>(disc) * pattern_.point_count() + index;
    return hu8_.empty() ? hu16_[n] : hu_of_byte(hu8_[n]);
  }
  /// Stores the nearest number that there is. Engines take the range of the numbers when they are made: fill first.
  /// Many threads may set points of their own at once.
  void set_hu(int disc, std::size_t index, double hu);
  /// Lowest and highest CT number of all points, as stored. Looks at all of them once; is then known, also of copies,
  /// until a number is set.
  std::pair<std::int16_t, std::int16_t> hu_range() const;

 private:
  std::size_t word_index(int disc, std::size_t index) const {
    return static_cast<std::size_t>(disc) * words_per_disc_ + index / 64;
  }
  std::uint64_t word(int disc, std::size_t index) const { return occupied_[word_index(disc, index)]; }
  Vec3 jitter(int disc, std::size_t index) const;

  /// What hu_range() found. Threads that fill a volume forget it at once, and engines may be made at once.
  class KeptRange {
   public:
    using Range = std::pair<std::int16_t, std::int16_t>;

    KeptRange() = default;
    KeptRange(const KeptRange& other) noexcept : ends_(other.ends_.load(std::memory_order_relaxed)) {}
    KeptRange& operator=(const KeptRange& other) noexcept {
      ends_.store(other.ends_.load(std::memory_order_relaxed), std::memory_order_relaxed);
      return *this;
    }
    ~KeptRange() = default;

    std::optional<Range> get() const noexcept {
      const Ends ends = ends_.load(std::memory_order_relaxed);
      return ends.lowest <= ends.highest ? std::optional(Range(ends.lowest, ends.highest)) : std::nullopt;
    }
    void keep(const Range& range) noexcept { ends_.store({range.first, range.second}, std::memory_order_relaxed); }
    void forget() noexcept {
      // Threads that only look do not take the line from each other.
      if (get()) ends_.store({}, std::memory_order_relaxed);
    }

   private:
    /// Aligned as a word: what is one to GCC is a call of libatomic to Clang.
    struct alignas(2 * sizeof(std::int16_t)) Ends {
      std::int16_t lowest = 1, highest = 0;  ///< of nothing
    };
    std::atomic<Ends> ends_{Ends{}};
  };

  PathFrame frame_;
  DiscPattern pattern_;
  int disc_count_ = 0;
  double lead_in_mm_ = 0.0;
  double jitter_mm_ = 0.0;
  std::uint64_t jitter_seed_ = 1;
  std::size_t words_per_disc_ = 0;
  std::vector<std::uint64_t> occupied_;
  std::vector<std::int16_t> hu16_;  ///< empty where eight bits do
  std::vector<std::uint8_t> hu8_;
  mutable KeptRange hu_range_;
};

/// What fills a volume: for patient positions (mm), the signed distance to the bone's surface (mm, negative inside) and
/// the CT number (HU). Called from many threads at once.
using BoneSampler =
    std::function<void(std::span<const Vec3> points_mm, std::span<float> distance_mm, std::span<float> hu)>;

/// Kills every point outside the bone and gives the others their CT number (the paper's section 6.3). Points whose
/// distance is not a number die. Throws Error when the CT number of a point inside is not a number.
void fill_volume(PointVolume& volume, const BoneSampler& bone, const Progress& progress = {});

}  // namespace spinaltap
