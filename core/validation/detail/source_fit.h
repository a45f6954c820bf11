#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

namespace spinaltap {

/// A measured figure, as a fit over sources takes it.
struct FitFigure {
  int source = 0;
  int kind = 0;  ///< 0 or 1: each has a spread between sources of its own
  double log_measured = 0.0;
};

/// Mean of the logarithm over what a figure's source leaves open, and its standard deviation: one each a figure.
struct LogPredictions {
  Eigen::VectorXd mean, open;
};

/// A law with free numbers, normal before any figure is seen.
struct FitModel {
  Eigen::VectorXd prior_mean, prior_sd;
  std::function<LogPredictions(const Eigen::VectorXd&)> predict;  ///< of all figures
};

struct SourceFit {
  Eigen::VectorXd numbers;
  Eigen::MatrixXd covariance;
  std::array<double, 2> between{};  ///< standard deviation of the logarithm between sources, by kind
  double within = 0.0;              ///< and within one
  std::array<int, 2> sources{};     ///< with figures of a kind
};

/// Fits a law's numbers and the spread between sources together (a random-effects model: Gelman et al., "Bayesian Data
/// Analysis", chapters 5 and 15), by Gauss-Newton steps on the law and, at each, the most probable spreads of the
/// linear model that is left, the numbers integrated out. What a source leaves open moves all of its figures of a kind
/// alike. `is_used`: one a figure. The same input gives the same bits.
SourceFit fit_over_sources(const std::vector<FitFigure>& figures, const std::vector<bool>& is_used,
                           const FitModel& model);

/// What a source that the fit has not seen may measure: Student's t of the logarithm, one each a figure.
struct NewSource {
  Eigen::VectorXd mean, scale;
  std::vector<int> degrees;  ///< one below the number of sources
};
NewSource predict_new_source(const SourceFit& fit, const std::vector<FitFigure>& figures, const FitModel& model);

}  // namespace spinaltap
