#include "core/points/point_volume.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/tool/path_curve.h"

namespace spinaltap {
namespace {

/// Along the line from entry to target.
struct Cylinder {
  double begin_mm, end_mm, radius_mm;
};

Cylinder cylinder_about(const DrillPath& path, const PointVolumeOptions& options) {
  if (!path.is_curved()) return {-options.lead_in_mm, path.length_mm(), options.radius_mm};
  const PathCurve curve(path);
  const PathCurve::AboutChord about = curve.about_chord(-options.lead_in_mm, curve.length_mm());
  // A section across the path stands out along the chord by so much.
  const double slant_mm = options.radius_mm * std::sin(curve.max_tilt_deg() * kDegree);
  return {about.low_mm - slant_mm, about.high_mm + slant_mm,
          options.radius_mm + options.spacing_mm * std::ceil(about.off_mm / options.spacing_mm)};
}

}  // namespace

PointVolume::PointVolume(const DrillPath& path, const PointVolumeOptions& options)
    : pattern_((check_path(path), cylinder_about(path, options).radius_mm), options.spacing_mm, options.subdivision),
      lead_in_mm_(options.lead_in_mm),
      jitter_seed_(options.jitter_seed) {
  constexpr double kMaxPoints = 0x1.0p32;
  if (!(options.lead_in_mm >= 0.0) || !(options.lead_in_mm <= 100.0)) {
    fail("point volume: expected a lead-in of 0 to 100 mm, found ", options.lead_in_mm, " mm");
  }
  if (!(options.jitter >= 0.0) || !(options.jitter <= 0.5)) {
    fail("point volume: expected a jitter of 0 to 0.5 of the spacing, found ", options.jitter);
  }
  jitter_mm_ = options.jitter * options.spacing_mm;
  const Cylinder cylinder = cylinder_about(path, options);
  frame_ = PathFrame(path.entry_mm - -cylinder.begin_mm * path.direction(), path.direction());
  const double discs = std::max(1.0, std::round((cylinder.end_mm - cylinder.begin_mm) / options.spacing_mm));
  if (!(discs * static_cast<double>(pattern_.point_count()) <= kMaxPoints)) {
    fail("point volume: expected at most ", kMaxPoints, " points, found ", discs, " discs of ", pattern_.point_count());
  }
  disc_count_ = static_cast<int>(discs);
  const std::size_t per_disc = pattern_.point_count();
  words_per_disc_ = (per_disc + 63) / 64;
  occupied_.assign(static_cast<std::size_t>(disc_count_) * words_per_disc_, ~std::uint64_t{0});
  if (per_disc % 64 != 0) {
    const std::uint64_t last = (std::uint64_t{1} << (per_disc % 64)) - 1;
    for (int disc = 0; disc < disc_count_; ++disc) occupancy_words(disc).back() = last;
  }
  if (options.hu_bits == HuBits::sixteen) {
    hu16_.assign(point_count(), 0);
  } else {
    hu8_.assign(point_count(), -kLowestHuOfByte / kHuOfByteStep);
  }
}

double PointVolume::deviation_mm(int ring) const { return pattern_.deviation_mm(ring) + 1.7321 * jitter_mm_; }

std::size_t PointVolume::occupied_count() const {
  std::size_t count = 0;
  for (const std::uint64_t word : occupied_) count += static_cast<std::size_t>(std::popcount(word));
  return count;
}

std::size_t PointVolume::memory_bytes() const {
  return sizeof(*this) + occupied_.size() * sizeof(occupied_[0]) + hu16_.size() * sizeof(std::int16_t) + hu8_.size() +
         pattern_.point_count() * sizeof(Eigen::Vector2d);
}

void PointVolume::set_hu(int disc, std::size_t index, double hu) {
  hu_range_.forget();
  const std::size_t n = static_cast<std::size_t>(disc) * pattern_.point_count() + index;
  if (hu8_.empty()) {
    hu16_[n] = static_cast<std::int16_t>(std::lround(std::clamp(hu, -32768.0, 32767.0)));
  } else {
    hu8_[n] = byte_of_hu(hu);
  }
}

namespace {

/// std::minmax_element compares number by number; compilers turn this into vectors.
template <class Number>
std::pair<Number, Number> range_of(const std::vector<Number>& numbers) {
  Number lowest = numbers.front();
  Number highest = numbers.front();
  for (const Number number : numbers) {
    lowest = std::min(lowest, number);
    highest = std::max(highest, number);
  }
  return {lowest, highest};
}

}  // namespace

std::pair<std::int16_t, std::int16_t> PointVolume::hu_range() const {
  // Every engine and all forces ask when they are made.
  if (const std::optional<KeptRange::Range> kept = hu_range_.get()) return *kept;
  KeptRange::Range range;
  if (hu8_.empty()) {
    range = range_of(hu16_);
  } else {
    const auto [lowest, highest] = range_of(hu8_);
    range = {hu_of_byte(lowest), hu_of_byte(highest)};
  }
  hu_range_.keep(range);
  return range;
}

Vec3 PointVolume::jitter(int disc, std::size_t index) const {
  const auto n = static_cast<std::uint64_t>(disc) * pattern_.point_count() + index;
  const std::uint64_t random = mix_bits(mix_bits(jitter_seed_) ^ n);
  constexpr std::uint64_t kMask = (1 << 21) - 1;
  const auto share = [&](int shift) { return static_cast<double>(random >> shift & kMask) / (0.5 * kMask) - 1.0; };
  return jitter_mm_ * Vec3(share(0), share(21), share(42));
}

void fill_volume(PointVolume& volume, const BoneSampler& bone, const Progress& progress) {
  // Fields sort the points they are given: the more at once, the better.
  constexpr std::size_t kBatch = 1 << 14;
  const std::size_t per_disc = volume.pattern().point_count();
  const auto discs = static_cast<std::size_t>(volume.disc_count());
  const std::size_t batch = std::clamp<std::size_t>(kBatch / per_disc, 1, discs);
  const std::size_t batches = (discs + batch - 1) / batch;
  ProgressCounter counter(progress, "filling the point volume", batches);
  tbb::parallel_for(std::size_t{0}, batches, [&](std::size_t n) {
    const std::size_t first = n * batch;
    const std::size_t last = std::min(first + batch, discs);
    const std::size_t points = (last - first) * per_disc;
    std::vector<Vec3> points_mm(points);
    std::vector<float> distance_mm(points);
    std::vector<float> hu(points);
    for (std::size_t k = 0; k < points; ++k) {
      const auto disc = static_cast<int>(first + k / per_disc);
      points_mm[k] = volume.frame().to_patient(volume.point_in_path_mm(disc, k % per_disc));
    }
    bone(points_mm, distance_mm, hu);
    for (std::size_t k = 0; k < points; ++k) {
      const auto disc = static_cast<int>(first + k / per_disc);
      const bool is_inside = distance_mm[k] < 0.0F;
      volume.set_occupied(disc, k % per_disc, is_inside);
      if (is_inside && std::isnan(hu[k])) {
        fail("point volume: the CT number of a point inside the bone is not a number");
      }
      volume.set_hu(disc, k % per_disc, std::isnan(hu[k]) ? 0.0 : static_cast<double>(hu[k]));
    }
    counter.add();
  });
}

}  // namespace spinaltap
