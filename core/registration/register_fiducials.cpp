#include "core/registration/register_fiducials.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/registration/detail/measured_spread.h"

namespace spinaltap {
namespace {

/// Mean square distance from the line along which the points spread most, mm².
double spread_beside_a_line_mm2(std::span<const Vec3> points_mm) {
  const Vec3 middle = detail::middle_of(points_mm);
  Mat3 products = Mat3::Zero();
  for (const Vec3& p_mm : points_mm) products += (p_mm - middle) * (p_mm - middle).transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(products, Eigen::EigenvaluesOnly);
  return (solver.eigenvalues()[0] + solver.eigenvalues()[1]) / static_cast<double>(points_mm.size());
}

void check_marks(std::span<const Vec3> points_mm, const char* where) {
  constexpr double kWidestMm = 1000.0;
  constexpr double kNarrowestMm = 2.0;
  for (const Vec3& p_mm : points_mm) {
    if (!p_mm.allFinite()) fail("fiducials ", where, ": expected finite positions, found others");
  }
  const Box3 box = bounds_of(points_mm);
  if (!(box.diagonal().norm() <= kWidestMm)) {
    fail("fiducials ", where, ": expected them within ", kWidestMm, " mm, found them over ", box.diagonal().norm());
  }
  const double beside_mm = std::sqrt(spread_beside_a_line_mm2(points_mm));
  if (!(beside_mm >= kNarrowestMm)) {
    fail("fiducials ", where, ": expected them to lie ", kNarrowestMm,
         " mm or more (root mean square) beside one line, which holds no turn about it; found ", beside_mm, " mm");
  }
}

double mean_square(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

std::vector<double> distances_of(const RigidPose& pose, std::span<const Vec3> ct_mm, std::span<const Vec3> patient_mm) {
  std::vector<double> distances;
  for (std::size_t n = 0; n < ct_mm.size(); ++n) distances.push_back((pose.apply(patient_mm[n]) - ct_mm[n]).norm());
  return distances;
}

/// The mark without which the others fit by far better, if there is one: swapped, moved or mistaken.
void warn_of_a_bad_mark(std::span<const Vec3> ct_mm, std::span<const Vec3> patient_mm, Registration& found) {
  constexpr std::size_t kFewest = 5;  // without one, as many as can disagree
  constexpr double kBetter = 3.0;
  constexpr double kWorthMm = 1.0;
  if (ct_mm.size() < kFewest) return;
  std::size_t worst = 0;
  double least_mm = found.residual_rms_mm;
  for (std::size_t left_out = 0; left_out < ct_mm.size(); ++left_out) {
    std::vector<double> weights(ct_mm.size(), 1.0);
    weights[left_out] = 0.0;
    std::vector<double> distances = distances_of(fit_pose(patient_mm, ct_mm, weights), ct_mm, patient_mm);
    distances.erase(distances.begin() + static_cast<std::ptrdiff_t>(left_out));
    const double rms_mm = std::sqrt(mean_square(distances));
    if (rms_mm < least_mm) {
      least_mm = rms_mm;
      worst = left_out;
    }
  }
  if (found.residual_rms_mm > kWorthMm && found.residual_rms_mm > kBetter * least_mm) {
    found.warnings.push_back(joined("fiducial ", worst + 1, " does not fit the others: without it they fit to ",
                                    fixed_text(least_mm, 2), " mm, with it to ", fixed_text(found.residual_rms_mm, 2),
                                    " mm"));
  }
}

}  // namespace

const char* name_of(Registration::Kind kind) { return kind == Registration::Kind::fiducials ? "fiducials" : "surface"; }

Registration register_fiducials(std::span<const Vec3> ct_mm, std::span<const Vec3> patient_mm,
                                const FiducialOptions& options) {
  constexpr std::size_t kFewest = 3;
  constexpr double kLargestFleMm = 50.0;
  if (ct_mm.size() != patient_mm.size() || ct_mm.size() < kFewest) {
    fail("fiducials: expected the same 3 or more in the CT and on the patient, found ", ct_mm.size(), " and ",
         patient_mm.size());
  }
  if (!(options.fle_mm >= 0.0 && options.fle_mm <= kLargestFleMm)) {
    fail("fiducials: expected a localisation error of 0 to ", kLargestFleMm, " mm, found ", options.fle_mm);
  }
  check_marks(ct_mm, "in the CT");
  check_marks(patient_mm, "on the patient");
  Registration found;
  found.ct_from_patient = fit_pose(patient_mm, ct_mm);
  found.residuals_mm = distances_of(found.ct_from_patient, ct_mm, patient_mm);
  found.residual_rms_mm = std::sqrt(mean_square(found.residuals_mm));

  const double count = static_cast<double>(ct_mm.size());
  const double fle_of_fre_mm = found.residual_rms_mm / std::sqrt(1.0 - 2.0 / count);
  found.noise_was_told = options.fle_mm > 0.0;
  double fle_mm = found.noise_was_told ? options.fle_mm : fle_of_fre_mm;
  if (found.noise_was_told) {
    // The FRE's square is FLE²/3 times chi-square of 3N - 6 degrees over N.
    const double degrees = 3.0 * count - 6.0;
    const double limit_mm =
        options.fle_mm * std::sqrt(degrees * detail::unlikely_variance_ratio(degrees) / (3.0 * count));
    if (found.residual_rms_mm > limit_mm) {
      fle_mm = fle_of_fre_mm;
      found.warnings.push_back(joined("the fiducials fit to ", fixed_text(found.residual_rms_mm, 2), " mm only: up to ",
                                      fixed_text(limit_mm, 2), " mm were to be expected of a localisation error of ",
                                      fixed_text(options.fle_mm, 2), " mm"));
    }
  } else {
    constexpr std::size_t kFew = 4;
    if (ct_mm.size() < kFew) {
      found.warnings.emplace_back("three fiducials say little of their own error: measure four or more, or tell it");
    }
  }
  found.noise_mm = fle_mm / std::sqrt(3.0);

  // Least squares: J = [-(x - c)x, I] of each mark, so that turn and shift do not mix about the marks' middle.
  const Vec3 centre_mm = detail::middle_of(ct_mm);
  Mat3 inertia = Mat3::Zero();
  double square_mm2 = 0.0;
  for (const Vec3& p_mm : ct_mm) {
    const Vec3 arm = p_mm - centre_mm;
    inertia += arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose();
    square_mm2 += arm.squaredNorm();
  }
  const double variance_mm2 = found.noise_mm * found.noise_mm;
  found.covariance.centre_mm = centre_mm;
  found.covariance.turn_rad2 = variance_mm2 * inertia.inverse();
  found.covariance.shift_mm2 = variance_mm2 / count * Mat3::Identity();
  warn_of_a_bad_mark(ct_mm, patient_mm, found);
  const double reach_mm = std::sqrt(square_mm2 / count);
  for (const WeakMotion& motion : weak_motions(found.covariance, reach_mm, options.max_slide_mm)) {
    found.warnings.push_back("the fiducials do not hold the pose: it " + in_words(motion));
  }
  return found;
}

}  // namespace spinaltap
