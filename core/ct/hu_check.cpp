#include "core/ct/hu_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>

#include "core/base/text_writer.h"

namespace spinaltap {
namespace {

constexpr int kLowest = std::numeric_limits<std::int16_t>::min();
constexpr int kHighest = std::numeric_limits<std::int16_t>::max();

/// How often each value occurs among samples. Spikes, single values that occur far more often than those around them
/// and fill over 1% of all, were set and not measured.
class Values {
 public:
  explicit Values(const CtVolume& ct) : counts_(65536) {
    constexpr std::size_t kMaxSamples = 1 << 20;
    // An odd stride meets all columns of a slice in turn.
    const std::size_t stride = (ct.hu.size() / kMaxSamples) | 1;
    for (std::size_t n = 0; n < ct.hu.size(); n += stride) ++at(ct.hu[n]), ++all_;
    low_ = kHighest;
    for (int value = kLowest; value <= kHighest; ++value) {
      const std::size_t count = at(value);
      if (count == 0) continue;
      low_ = std::min(low_, value);
      high_ = value;
      ++distinct_;
      const std::size_t around = (in_all(value - 4, value - 1) + in_all(value + 1, value + 4)) / 8;
      if (100 * count > all_ && count > 8 * around) spikes_.push_back(value);
    }
    measured_ = all_;
    for (const int spike : spikes_) measured_ -= at(spike);
  }

  int low() const { return low_; }
  int high() const { return high_; }
  std::size_t distinct() const { return distinct_; }
  std::size_t samples() const { return all_; }
  const std::vector<int>& spikes() const { return spikes_; }
  /// Of all values, 0 to 1.
  double part_of(int value) const { return static_cast<double>(at(value)) / static_cast<double>(all_); }
  /// Of the values that were measured, those from `first` to `last`, 0 to 1.
  double part_in(int first, int last) const {
    std::size_t count = in_all(first, last);
    for (const int spike : spikes_) count -= spike >= first && spike <= last ? at(spike) : 0;
    return measured_ > 0 ? static_cast<double>(count) / static_cast<double>(measured_) : 0.0;
  }
  /// Measured values, as a proportion of all.
  double measured_part() const { return static_cast<double>(measured_) / static_cast<double>(all_); }

 private:
  std::size_t& at(int value) { return counts_[static_cast<std::size_t>(value - kLowest)]; }
  std::size_t at(int value) const { return counts_[static_cast<std::size_t>(value - kLowest)]; }
  std::size_t in_all(int first, int last) const {
    std::size_t count = 0;
    for (int value = std::max(first, kLowest); value <= std::min(last, kHighest); ++value) count += at(value);
    return count;
  }

  std::vector<std::size_t> counts_;
  std::vector<int> spikes_;
  std::size_t all_ = 0, measured_ = 0, distinct_ = 0;
  int low_ = 0, high_ = 0;
};

/// The air around a body: where the lowest values lie close together, as lung does not; none where there is little.
std::optional<int> air_peak(const Values& values) {
  constexpr int kHalf = 16, kAround = 60;
  constexpr double kLeast = 0.05;
  int peak = 0;
  double most = 0.0;
  for (int middle = -1600; middle <= -650; middle += kHalf / 2) {
    const double part = values.part_in(middle - kHalf, middle + kHalf);
    if (part > most) most = part, peak = middle;
  }
  if (!(values.part_in(peak - kAround, peak + kAround) > kLeast)) return std::nullopt;
  return peak;
}

/// Air and soft tissue, each a witness for the other; empty where they stand in their places, or one is not there.
std::string cause_by_air(const Values& values) {
  constexpr int kAirHu = -1000, kLeastShift = 40;
  const std::optional<int> air = air_peak(values);
  if (!air) return {};
  const int shift = *air - kAirHu;
  const auto muscle = [&](int by) { return values.part_in(20 + by, 80 + by); };
  // Fat that was shifted by some 150 HU lies where muscle was, but none where fat was.
  const auto muscle_and_fat = [&](int by) { return muscle(by) * values.part_in(-130 + by, -70 + by); };
  const bool both_fit = muscle(shift) > 3.0 * muscle(0) || muscle_and_fat(shift) > 9.0 * muscle_and_fat(0);
  if (std::abs(shift) >= kLeastShift && muscle(shift) > 0.1 && both_fit) {
    return joined("air at ", *air, " HU and soft tissue by as much off its place: looks like CT numbers ",
                  shift > 0 ? "+ " : "- ", std::abs(shift));
  }
  constexpr int kLowestAir = -1070, kHighestAir = -930;
  if (*air < kLowestAir) return joined("air at ", *air, " HU: looks like shifted or scaled CT numbers");
  if (*air < kHighestAir && values.part_in(-150, 150) < 0.5 * values.part_in(-300, 1500)) {
    return joined("air at ", *air, " HU, and soft tissue not between -150 and 150: looks like scaled CT numbers");
  }
  return {};
}

/// A likely cause in words; empty where the values may be Hounsfield units. The first rule that holds counts.
std::string cause_of(const Values& values) {
  const std::string range = joined("values from ", values.low(), " to ", values.high());
  constexpr std::size_t kFewDistinct = 24;
  if (values.low() >= -1 && values.high() <= 1) {
    return range + ": looks like values scaled to 1, as programs for learning want them, not HU";
  }
  if (values.distinct() <= kFewDistinct && values.high() <= 255) {
    return joined(values.distinct(), " different values from ", values.low(), " to ", values.high(),
                  ": looks like a label map or scaled values, not HU");
  }
  if (values.low() >= 0 && values.high() <= 255) return range + ": looks like a picture of 8 bits, not HU";
  // Soft tissue is most of a body, and bone thins out above it: so a peak that stands elsewhere is told from bone.
  const double at_1024 = values.part_in(874, 1174), above_water = values.part_in(300, 800);
  if (values.part_in(kLowest, -150) < 2e-4 && at_1024 > 0.25 && at_1024 > 3.0 * above_water) {
    return "nothing below 0 HU and soft tissue at 1,000 to 1,100: looks like CT numbers + 1024 (or + 1000)";
  }
  const bool has_peak_at_air = values.part_in(-1174, -874) > 0.25;
  const bool has_bone_below =
      values.high() < 700 && values.part_in(-860, -300) > 0.05 && values.part_in(-30, 110) < 0.1;
  if (has_peak_at_air && ((values.part_in(-150, 300) < 0.05 && values.part_in(-1200, -1060) > 0.03) ||
                          (has_bone_below && values.part_in(-1174, -874) > 0.5))) {
    return "soft tissue at -1,000 and values below air: looks like CT numbers - 1024, the intercept taken off twice";
  }
  if (values.part_in(4000, kHighest) > 0.1 && values.part_in(4000, kHighest) > values.part_in(-200, 200)) {
    return joined("values above 4,000 in ", std::lround(100.0 * values.part_in(4000, kHighest)),
                  " % of what was measured: looks like CT numbers with an offset or signs lost");
  }
  const bool has_set_above = std::any_of(values.spikes().begin(), values.spikes().end(),
                                         [&](int spike) { return spike > 4000 && values.part_of(spike) > 0.1; });
  if (has_set_above) {
    return joined(values.high(), " in much of the picture: looks like CT numbers whose signs were lost, or an offset");
  }
  if (values.part_in(kLowest, -1600) > 0.02) {
    return joined("values below -1,600, far below air, in ", std::lround(100.0 * values.part_in(kLowest, -1600)),
                  " % of what was measured: looks like CT numbers x 10, or with the intercept taken off twice");
  }
  if (values.part_in(3100, kHighest) > 0.1 && values.part_in(-600, -200) > values.part_in(-200, -30)) {
    return "values above 3,100 in over 10 % of what was measured: looks like CT numbers x 10";
  }
  // A value that was set and lies below all others: outside of a mask, or clamped air.
  const bool has_air_above = values.low() < -900 && values.part_in(values.low() + 1, -800) > 0.05;
  const bool is_masked = !values.spikes().empty() && values.spikes().front() == values.low() && !has_air_above;
  // Made CTs without noise have many at their upper end too, and little between.
  constexpr int kHighestOfWindow = 2000;
  const double at_end = values.part_of(values.high());
  if (values.measured_part() > 0.25 && values.high() < kHighestOfWindow && at_end > 1e-4 &&
      at_end * static_cast<double>(values.samples()) > 50.0 &&
      at_end > values.part_in(values.high() - 20, values.high() - 1)) {
    return range + ", with many at the upper end: looks like a window that was cut out, not all CT numbers";
  }
  if (values.high() < 350 && values.low() > -250 && values.part_in(-20, 20) > values.part_in(30, 80)) {
    return range + ", most of them near 0: looks like CT numbers / 10, or scaled otherwise";
  }
  if (values.low() >= 0 && values.part_in(1175, kHighest) > 0.5) {
    return range + ": nothing below 0 HU, most above 1,175: looks like scaled CT numbers";
  }
  // A small box around a bone may hold muscle and bone alone.
  if (values.low() >= 0 && !is_masked && values.part_in(10, 110) < 0.1) {
    return range + ": nothing below 0 HU, where fat and air lie: looks like shifted or scaled CT numbers";
  }
  if (!is_masked && values.part_in(-200, 200) < 0.01 * values.part_in(-800, kHighest)) {
    return "no value near 0 HU, where water and soft tissue lie: looks like shifted or scaled CT numbers";
  }
  return cause_by_air(values);
}

/// The median of what CT numbers grow by from slice k to the next, and how many of the differences lie near it.
struct SliceStep {
  double median = 0.0;
  double near = 0.0;  ///< 0 to 1
};

SliceStep step_after(const CtVolume& ct, int k) {
  constexpr std::size_t kPairs = 1021;
  const std::size_t slice = ct.geometry.offset(0, 0, 1);
  const std::size_t stride = (slice / kPairs) | 1;
  const auto first = static_cast<std::size_t>(k) * slice;
  std::vector<int> steps;
  for (std::size_t n = 0; n < slice; n += stride) steps.push_back(ct.hu[first + slice + n] - ct.hu[first + n]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  const int median = *middle;
  constexpr int kNear = 150;
  const auto near =
      std::count_if(steps.begin(), steps.end(), [&](int step) { return std::abs(step - median) <= kNear; });
  return {static_cast<double>(median), static_cast<double>(near) / static_cast<double>(steps.size())};
}

/// Anatomy changes by less from slice to slice, and not all over a slice.
std::string step_between_slices(const CtVolume& ct) {
  constexpr double kLeastStep = 500.0, kMostNear = 0.75;
  for (int k = 0; k + 1 < ct.geometry.size[2]; ++k) {
    const SliceStep step = step_after(ct, k);
    if (std::abs(step.median) < kLeastStep || step.near < kMostNear) continue;
    return joined("CT numbers change by ", step.median, " HU all over between slices ", k + 1, " and ", k + 2,
                  ": slices look as if their RescaleIntercept or signs disagreed");
  }
  return {};
}

}  // namespace

HuCheck check_hu(const CtVolume& ct) {
  HuCheck check;
  if (ct.hu.empty()) return check;
  const Values values(ct);
  if (std::string cause = cause_of(values); !cause.empty()) check.warnings.push_back(std::move(cause));
  if (std::string step = step_between_slices(ct); !step.empty()) check.warnings.push_back(std::move(step));
  const bool has_air_or_fat = values.part_of(values.low()) > 0.0 && values.part_in(-1100, -30) > 0.01;
  check.shows_tissue = check.warnings.empty() && has_air_or_fat && values.part_in(-30, 150) > 0.1;
  return check;
}

}  // namespace spinaltap
