#include "core/registration/register_surface.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/error.h"
#include "core/base/quasi_random.h"
#include "core/registration/detail/fit_touched.h"
#include "core/registration/detail/measured_spread.h"

namespace spinaltap {
namespace {

using detail::FittedPose;
using detail::TouchedFit;

constexpr double kRivalAwayMm = 3.0;   ///< nearer poses are the same
constexpr double kRivalRatio = 1.5;    ///< of residuals
constexpr double kUnknownFitMm = 1.0;  ///< residuals that nobody expected
constexpr double kMaxRejected = 0.25;

void check(std::span<const Vec3> touched_mm, const TouchedOptions& options) {
  constexpr std::size_t kFewest = 12, kMost = 20'000;
  constexpr double kNarrowestMm = 5.0, kWidestMm = 500.0;
  if (touched_mm.size() < kFewest || touched_mm.size() > kMost) {
    fail("touched points: expected ", kFewest, " to ", kMost, ", found ", touched_mm.size());
  }
  for (const Vec3& p_mm : touched_mm) {
    if (!p_mm.allFinite()) fail("touched points: expected finite positions, found others");
  }
  const double spread_mm = bounds_of(touched_mm).diagonal().norm();
  if (!(spread_mm >= kNarrowestMm && spread_mm <= kWidestMm)) {
    fail("touched points: expected them to spread over ", kNarrowestMm, " to ", kWidestMm, " mm, found ", spread_mm);
  }
  constexpr double kFurthestMm = 100.0, kFurthestDeg = 90.0, kLargestNoiseMm = 10.0;
  constexpr int kMostStarts = 100'000;
  if (!(options.search_mm >= 0.0 && options.search_mm <= kFurthestMm) ||
      !(options.search_deg >= 0.0 && options.search_deg <= kFurthestDeg)) {
    fail("surface registration: expected a search of up to ", kFurthestMm, " mm and ", kFurthestDeg, " degrees, found ",
         options.search_mm, " and ", options.search_deg);
  }
  if (options.starts < 1 || options.starts > kMostStarts) {
    fail("surface registration: expected 1 to ", kMostStarts, " starts, found ", options.starts);
  }
  if (!(options.noise_mm >= 0.0 && options.noise_mm <= kLargestNoiseMm)) {
    fail("surface registration: expected noise of 0 to ", kLargestNoiseMm, " mm, found ", options.noise_mm);
  }
  if (!(options.max_slide_mm > 0.0) || !(options.max_target_mm > 0.0)) {
    fail("surface registration: expected a largest slide and target error above 0 mm, found ", options.max_slide_mm,
         " and ", options.max_target_mm);
  }
}

/// A vector in a ball, evenly, from three uniform numbers.
Vec3 in_ball(double radius, double for_length, double for_height, double for_angle) {
  const double height = 2.0 * for_height - 1.0;
  const double beside = std::sqrt(std::max(0.0, 1.0 - height * height));
  const double angle = 2.0 * std::numbers::pi * for_angle;
  return radius * std::cbrt(for_length) * Vec3(beside * std::cos(angle), beside * std::sin(angle), height);
}

/// Where the search begins: the start itself, then poses all about it.
std::vector<RigidPose> starts_of(const TouchedOptions& options, const Vec3& middle_ct_mm) {
  std::vector<RigidPose> starts{options.start};
  for (int n = 1; n < options.starts; ++n) {
    std::array<double, 6> u{};
    for (int k = 0; k < 6; ++k) {
      u[static_cast<std::size_t>(k)] = sobol_uniform(options.seed, static_cast<std::uint32_t>(n - 1), k);
    }
    const Vec3 shift_mm = in_ball(options.search_mm, u[0], u[1], u[2]);
    const Vec3 turn_rad = in_ball(options.search_deg * kDegree, u[3], u[4], u[5]);
    starts.push_back(small_motion(turn_rad, shift_mm, middle_ct_mm).after(options.start));
  }
  return starts;
}

/// Places of the `count` lowest costs, lowest first.
std::vector<std::size_t> best_of(const std::vector<FittedPose>& fits, std::size_t count) {
  std::vector<std::size_t> order(fits.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return fits[a].cost < fits[b].cost; });
  order.resize(std::min(order.size(), count));
  return order;
}

double moved_mm(const RigidPose& a, const RigidPose& b, std::span<const Vec3> touched_mm) {
  double sum = 0.0;
  for (const Vec3& p_mm : touched_mm) sum += (a.apply(p_mm) - b.apply(p_mm)).squaredNorm();
  return std::sqrt(sum / static_cast<double>(touched_mm.size()));
}

/// The `count` lowest costs of poses that differ, so that one pose met often leaves room for its rivals.
std::vector<FittedPose> best_apart(const std::vector<FittedPose>& fits, std::size_t count,
                                   std::span<const Vec3> touched_mm) {
  constexpr double kApartMm = 1.5;
  std::vector<FittedPose> kept;
  for (const std::size_t n : best_of(fits, fits.size())) {
    const bool is_new = std::all_of(kept.begin(), kept.end(), [&](const FittedPose& fit) {
      return moved_mm(fit.pose, fits[n].pose, touched_mm) > kApartMm;
    });
    if (is_new) kept.push_back(fits[n]);
    if (kept.size() == count) break;
  }
  return kept;
}

/// The best of those that are another pose than fits[0].
void warn_of_a_rival(const std::vector<FittedPose>& fits, std::span<const Vec3> touched_mm, Registration& found) {
  const FittedPose* rival = nullptr;
  double away_mm = 0.0;
  for (const FittedPose& fit : fits) {
    const double moved = moved_mm(fits.front().pose, fit.pose, touched_mm);
    if (moved < kRivalAwayMm || (rival != nullptr && rival->cost <= fit.cost)) continue;
    rival = &fit;
    away_mm = moved;
  }
  if (rival == nullptr) return;
  const double own_mm = std::sqrt(fits.front().cost), other_mm = std::sqrt(rival->cost);
  if (other_mm < kRivalRatio * own_mm) {
    found.warnings.push_back(joined(
        "another pose, ", fixed_text(away_mm, 1), " mm away at the touched points, fits to ", fixed_text(other_mm, 2),
        " mm, this one to ", fixed_text(own_mm, 2), " mm: touch more places, further apart"));
  }
}

void judge_fit(const TouchedOptions& options, double noise_of_fit_mm, double degrees, std::size_t touched,
               Registration& found) {
  found.noise_was_told = options.noise_mm > 0.0;
  found.noise_mm = noise_of_fit_mm;
  if (found.noise_was_told) {
    const double limit_mm = options.noise_mm * std::sqrt(detail::unlikely_variance_ratio(degrees));
    if (noise_of_fit_mm > limit_mm) {
      found.warnings.push_back(joined("the touched points scatter by ", fixed_text(noise_of_fit_mm, 2),
                                      " mm about the surface: up to ", fixed_text(limit_mm, 2),
                                      " mm were to be expected of noise of ", fixed_text(options.noise_mm, 2), " mm"));
    } else {
      found.noise_mm = options.noise_mm;
    }
  } else if (noise_of_fit_mm > kUnknownFitMm) {
    found.warnings.push_back(
        joined("the touched points scatter by ", fixed_text(noise_of_fit_mm, 2), " mm about the surface"));
  }
  if (static_cast<double>(found.rejected.size()) > kMaxRejected * static_cast<double>(touched)) {
    found.warnings.push_back(
        joined(found.rejected.size(), " of ", touched, " touched points do not lie on the surface"));
  }
}

}  // namespace

Registration register_surface(const BoneShape& bone, std::span<const Vec3> touched_mm, const TouchedOptions& options,
                              const Progress& progress) {
  check(touched_mm, options);
  TouchedOptions checked = options;
  checked.start = checked_pose(options.start, "the start of a surface registration");
  const TouchedFit fit(bone, touched_mm);
  Vec3 middle_mm = Vec3::Zero();
  for (const Vec3& p_mm : touched_mm) middle_mm += p_mm / static_cast<double>(touched_mm.size());

  // Many starts, a few steps each; then fewer, further.
  const std::vector<RigidPose> starts = starts_of(checked, checked.start.apply(middle_mm));
  std::vector<FittedPose> fits(starts.size());
  const auto run = [&](const auto& step) {
    progress.report("registration", 0.0);
    tbb::parallel_for(std::size_t{0}, fits.size(), step);
  };
  run([&](std::size_t n) { fits[n] = fit.coarse(starts[n], detail::kFirstRound); });
  const auto keep = [&](std::size_t count) {
    std::vector<FittedPose> kept;
    for (const std::size_t n : best_of(fits, count)) kept.push_back(fits[n]);
    fits = std::move(kept);
  };
  keep(std::max<std::size_t>(1, fits.size() / 4));
  run([&](std::size_t n) { fits[n] = fit.coarse(fits[n].pose, detail::kSecondRound); });
  constexpr std::size_t kFinal = 12;
  fits = best_apart(fits, kFinal, touched_mm);
  run([&](std::size_t n) { fits[n] = fit.fine(fits[n].pose, checked.noise_mm); });
  keep(fits.size());

  const FittedPose& best = fits.front();
  Registration found;
  found.kind = Registration::Kind::surface;
  found.ct_from_patient = best.pose;
  found.residuals_mm = best.residuals_mm;
  double squares_mm2 = 0.0;
  for (std::size_t n = 0; n < touched_mm.size(); ++n) {
    if (best.is_kept[n]) {
      squares_mm2 += best.residuals_mm[n] * best.residuals_mm[n];
    } else {
      found.rejected.push_back(n);
    }
  }
  const double kept = static_cast<double>(touched_mm.size() - found.rejected.size());
  found.residual_rms_mm = std::sqrt(squares_mm2 / kept);
  constexpr double kOfPose = 6.0;
  const double degrees = std::max(1.0, kept - kOfPose);
  judge_fit(checked, std::sqrt(squares_mm2 / degrees), degrees, touched_mm.size(), found);
  found.covariance = fit.covariance(best, found.noise_mm, checked.search_mm, checked.search_deg);
  warn_of_a_rival(fits, touched_mm, found);

  const Vec3 centre_mm = found.covariance.centre_mm;
  double reach_mm2 = 0.0;
  for (const Vec3& p_mm : touched_mm) reach_mm2 += (best.pose.apply(p_mm) - centre_mm).squaredNorm();
  const double reach_mm = std::sqrt(reach_mm2 / static_cast<double>(touched_mm.size()));
  for (const WeakMotion& motion : weak_motions(found.covariance, reach_mm, checked.max_slide_mm)) {
    found.warnings.push_back("the touched points do not hold the pose: it " + in_words(motion));
  }
  double target_mm = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double share : {-0.25, 0.0, 0.25}) {
      const Vec3 aside_mm = share * bone.bounds_mm().sizes()[axis] * Vec3::Unit(axis);
      target_mm = std::max(target_mm, target_error_mm(found.covariance, bone.bounds_mm().center() + aside_mm));
    }
  }
  if (!(target_mm <= checked.max_target_mm)) {
    found.warnings.push_back(joined("inside the bone an error of ", fixed_text(target_mm, 1),
                                    " mm is to be expected: touch places further apart"));
  }
  const double away_mm = (best.pose.apply(middle_mm) - checked.start.apply(middle_mm)).norm();
  const double turned_deg = angle_between_rad(best.pose, checked.start) / kDegree;
  constexpr double kBeyond = 1.25;  // the search may end a little outside of where it began
  if (checked.starts > 1 && (away_mm > kBeyond * checked.search_mm || turned_deg > kBeyond * checked.search_deg)) {
    found.warnings.push_back(joined("the best fit lies ", fixed_text(away_mm, 1), " mm and ", fixed_text(turned_deg, 1),
                                    " degrees from the start, further than was searched"));
  }
  return found;
}

}  // namespace spinaltap
