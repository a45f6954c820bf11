#pragma once

#include <cstddef>
#include <span>

#include "core/base/statistics.h"

namespace spinaltap {

/// Runs of one patient, and how many of them have a property: a grade, a breach.
struct PatientCount {
  std::size_t met = 0;
  std::size_t runs = 0;
};

/// A share of runs with its 95 % interval for patients like these.
struct ClusteredShare {
  double share = 0.0;  ///< of all runs
  Interval interval;
  std::size_t patients = 0;  ///< those with runs
  std::size_t runs = 0;
  /// How many independent runs would tell as much.
  double effective_runs = 0.0;
  /// The interval is of this one patient's runs, and says nothing of others.
  bool is_of_one_patient = false;
};

/// Runs of one patient resemble each other: 1,000 runs of 10 patients are not 10,000 patients. The variance of the
/// share is therefore that between patients (a ratio's, linearised: Cochran, "Sampling Techniques", 3rd ed. 1977,
/// section 11.8); as many independent runs as would have it, never more than there are, make a Wilson interval with
/// Student's quantile for the patients, as surveys do (Korn & Graubard, "Confidence intervals for proportions with
/// small expected number of positive counts estimated from survey data", Survey Methodol. 1998; Dean & Pagano,
/// "Evaluating confidence interval methods for binomial proportions in clustered surveys", J. Surv. Stat. Methodol.
/// 2015). A bootstrap over patients would be the plain choice: where no run has the property it gives 0 to 0, and with
/// 5 patients it holds the truth in 30 to 85 % of cases instead of 95. Where none or all have it, nothing tells how
/// alike runs of one patient are, and each patient counts as one run. With one patient: Wilson's of its runs. With two
/// or three it is right and too wide to be of use. docs/study-statistics.md has how often it holds the truth, and where
/// it falls short: at shares of a few percent that are all a few patients'. Throws Error on more met than runs, and on
/// no runs at all.
ClusteredShare clustered_share(std::span<const PatientCount> patients);

}  // namespace spinaltap
