#include "core/study/clustered_share.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"

namespace spinaltap {
namespace {

constexpr double kUpper = 0.975;
/// From as many degrees of freedom on Student's quantile is the normal one to 0.3 %.
constexpr std::size_t kMostDegrees = 1000;

double quantile_for(std::size_t patients) {
  const std::size_t degrees = patients - 1;
  return degrees > kMostDegrees ? normal_quantile(kUpper) : student_quantile(kUpper, static_cast<int>(degrees));
}

/// Wilson's interval, of a number of runs that need not be whole.
Interval wilson(double share, double runs, double quantile) {
  const double per_run = quantile * quantile / runs;
  const double middle = (share + 0.5 * per_run) / (1.0 + per_run);
  const double half = std::sqrt(share * (1.0 - share) * per_run + 0.25 * per_run * per_run) / (1.0 + per_run);
  // Rounding would leave 1e-18 where the formula has 0.
  return {share == 0.0 ? 0.0 : std::clamp(middle - half, 0.0, share),
          share == 1.0 ? 1.0 : std::clamp(middle + half, share, 1.0)};
}

/// Those with runs.
std::vector<PatientCount> checked(std::span<const PatientCount> patients) {
  std::vector<PatientCount> kept;
  for (const PatientCount& one : patients) {
    if (one.met > one.runs) fail("share of runs: expected at most ", one.runs, " of a patient, found ", one.met);
    if (one.runs > 0) kept.push_back(one);
  }
  if (kept.empty()) fail("share of runs: expected runs, found none");
  return kept;
}

ClusteredShare share_of(const std::vector<PatientCount>& patients) {
  ClusteredShare made;
  std::size_t met = 0;
  for (const PatientCount& one : patients) {
    met += one.met;
    made.runs += one.runs;
  }
  made.share = static_cast<double>(met) / static_cast<double>(made.runs);
  made.patients = patients.size();
  made.is_of_one_patient = made.patients == 1;
  return made;
}

/// As many independent runs as have the variance that is found between patients.
double effective_runs(const std::vector<PatientCount>& patients, const ClusteredShare& of_all) {
  const auto runs = static_cast<double>(of_all.runs);
  const double variance_of_run = of_all.share * (1.0 - of_all.share);
  double squares = 0.0, squared_runs = 0.0;
  for (const PatientCount& one : patients) {
    const auto of_one = static_cast<double>(one.runs);
    const double off = static_cast<double>(one.met) - of_all.share * of_one;
    squares += off * off;
    squared_runs += of_one * of_one;
  }
  // Kish's number of patients that would count alike.
  if (variance_of_run == 0.0) return runs * runs / squared_runs;
  const auto count = static_cast<double>(of_all.patients);
  const double variance = count / (count - 1.0) * squares / (runs * runs);
  return variance * runs > variance_of_run ? variance_of_run / variance : runs;
}

}  // namespace

ClusteredShare clustered_share(std::span<const PatientCount> patients) {
  const std::vector<PatientCount> kept = checked(patients);
  ClusteredShare made = share_of(kept);
  made.effective_runs = made.is_of_one_patient ? static_cast<double>(made.runs) : effective_runs(kept, made);
  const double quantile = made.is_of_one_patient ? normal_quantile(kUpper) : quantile_for(made.patients);
  made.interval = wilson(made.share, made.effective_runs, quantile);
  return made;
}

}  // namespace spinaltap
