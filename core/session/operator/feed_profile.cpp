#include "core/session/operator/path_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"

namespace spinaltap {
namespace {

void check_feed(double mm_s, const char* what) {
  constexpr double kFastestMmS = 1e6;
  if (!(mm_s > 0.0 && mm_s <= kFastestMmS)) {
    fail("operator: expected ", what, " above 0 and at most ", kFastestMmS, " mm/s, found ", mm_s, " mm/s");
  }
}

void check_profile(double begin_mm, double end_mm, const FeedProfileOptions& options) {
  if (!(end_mm >= begin_mm) || !std::isfinite(end_mm - begin_mm)) {
    fail("operator: expected a way from a depth to a larger one, found ", begin_mm, " to ", end_mm, " mm");
  }
  if (options.steps.empty()) fail("operator: expected a feed at least, found none");
  for (std::size_t n = 0; n < options.steps.size(); ++n) {
    check_feed(options.steps[n].mm_s, "a feed");
    const double from_mm = options.steps[n].from_mm;
    if (!std::isfinite(from_mm) || (n > 0 && !(from_mm > options.steps[n - 1].from_mm))) {
      fail("operator: expected the depths of feeds to rise, found ", from_mm, " mm as number ", n + 1);
    }
  }
  const Pecking& pecking = options.pecking;
  if (!(pecking.every_mm >= 0.0)) fail("operator: expected pecks every 0 mm or more, found ", pecking.every_mm, " mm");
  if (pecking.every_mm > 0.0) {
    check_feed(pecking.mm_s, "a feed of pecks");
    if (!(pecking.back_mm > 0.0)) fail("operator: expected pecks that go back, found ", pecking.back_mm, " mm");
    constexpr double kMaxPauseS = 3600.0;
    if (!(pecking.pause_s >= 0.0 && pecking.pause_s <= kMaxPauseS)) {
      fail("operator: expected pecks that wait 0 to ", kMaxPauseS, " s, found ", pecking.pause_s, " s");
    }
    constexpr double kMaxPecks = 0x1.0p18;
    if (!((end_mm - begin_mm) / pecking.every_mm <= kMaxPecks)) {
      fail("operator: expected at most ", kMaxPecks, " pecks, found one every ", pecking.every_mm, " mm");
    }
  }
  if (options.withdraw_mm_s != 0.0) check_feed(options.withdraw_mm_s, "a feed of the way back");
}

}  // namespace

void FeedProfile::go(double to_mm, double mm_s) {
  const Knot& last = knots_.back();
  const double way_mm = std::abs(to_mm - last.depth_mm);
  if (way_mm > 0.0) knots_.push_back({last.time_s + way_mm / mm_s, to_mm});
}

void FeedProfile::wait(double pause_s) {
  const Knot& last = knots_.back();
  if (pause_s > 0.0) knots_.push_back({last.time_s + pause_s, last.depth_mm});
}

FeedProfile::FeedProfile(double begin_mm, double end_mm, const FeedProfileOptions& options) {
  check_profile(begin_mm, end_mm, options);
  const Pecking& pecking = options.pecking;
  knots_.push_back({0.0, begin_mm});
  std::size_t step = 0;
  double pecks = 1.0;
  while (knots_.back().depth_mm < end_mm) {
    const double at_mm = knots_.back().depth_mm;
    while (step + 1 < options.steps.size() && at_mm >= options.steps[step + 1].from_mm) ++step;
    const bool is_last = step + 1 == options.steps.size();
    const double step_end_mm = is_last ? std::numeric_limits<double>::infinity() : options.steps[step + 1].from_mm;
    const double peck_mm =
        pecking.every_mm > 0.0 ? begin_mm + pecks * pecking.every_mm : std::numeric_limits<double>::infinity();
    const double to_mm = std::min({step_end_mm, peck_mm, end_mm});
    go(to_mm, options.steps[step].mm_s);
    if (to_mm == peck_mm) {
      ++pecks;
      if (to_mm < end_mm) {
        const double back_mm = std::max(begin_mm, to_mm - pecking.back_mm);
        go(back_mm, pecking.mm_s);
        wait(pecking.pause_s);
        go(std::max(back_mm, to_mm - Pecking::kSlowMm), pecking.mm_s);
        go(to_mm, options.steps[step].mm_s);
      }
    }
  }
  if (options.withdraw_mm_s > 0.0) go(begin_mm, options.withdraw_mm_s);
}

double FeedProfile::depth_mm(double time_s) const {
  const auto after = std::upper_bound(knots_.begin(), knots_.end(), time_s,
                                      [](double time, const Knot& knot) { return time < knot.time_s; });
  if (after == knots_.begin()) return knots_.front().depth_mm;
  if (after == knots_.end()) return knots_.back().depth_mm;
  const Knot& from = *(after - 1);
  const double share = (time_s - from.time_s) / (after->time_s - from.time_s);
  return from.depth_mm + share * (after->depth_mm - from.depth_mm);
}

}  // namespace spinaltap
