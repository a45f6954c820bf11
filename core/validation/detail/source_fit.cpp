#include "core/validation/detail/source_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/error.h"

namespace spinaltap {
namespace {

/// Before any figure: spreads between sources of a factor 2.7 are usual, within one of a third.
constexpr double kBetweenPrior = 1.0, kWithinPrior = 0.3;
constexpr double kLeastSpread = 0.02, kGreatestSpread = 3.0;
constexpr int kFitSteps = 12;
constexpr double kStepShare = 0.8;  ///< of a Gauss-Newton step: laws bend

Eigen::MatrixXd jacobian_of(const FitModel& model, const Eigen::VectorXd& numbers) {
  constexpr double kShare = 1e-3;  // of the deviation before: small beside what figures say, large beside rounding
  Eigen::MatrixXd jacobian;
  for (Eigen::Index n = 0; n < numbers.size(); ++n) {
    Eigen::VectorXd up = numbers, down = numbers;
    const double step = kShare * model.prior_sd[n];
    up[n] += step;
    down[n] -= step;
    const Eigen::VectorXd slope = (model.predict(up).mean - model.predict(down).mean) / (2.0 * step);
    if (n == 0) jacobian.resize(slope.size(), numbers.size());
    jacobian.col(n) = slope;
  }
  return jacobian;
}

/// The figures of a fit, about the numbers that a law has been made linear at.
struct LinearFigures {
  std::vector<FitFigure> figures;
  Eigen::VectorXd rest;  ///< measured less predicted with the numbers' prior means
  Eigen::VectorXd open;
  Eigen::MatrixXd jacobian;
  Eigen::MatrixXd of_numbers;  ///< covariance of the figures by the numbers' prior

  Eigen::MatrixXd covariance(const SourceFit& spreads) const {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(rest.size(), rest.size());
    for (Eigen::Index i = 0; i < sum.rows(); ++i) {
      for (Eigen::Index j = 0; j < sum.cols(); ++j) {
        const FitFigure& a = figures[static_cast<std::size_t>(i)];
        const FitFigure& b = figures[static_cast<std::size_t>(j)];
        if (a.source != b.source || a.kind != b.kind) continue;
        const double between = spreads.between[static_cast<std::size_t>(a.kind)];
        sum(i, j) = between * between + open[i] * open[j];
      }
      sum(i, i) += spreads.within * spreads.within;
    }
    return sum;
  }

  /// Logarithm of the spreads' probability, but for what does not depend on them.
  double log_probability(const SourceFit& spreads) const {
    const Eigen::LLT<Eigen::MatrixXd> factor(covariance(spreads) + of_numbers);
    double sum = -0.5 * rest.dot(factor.solve(rest));
    for (Eigen::Index n = 0; n < rest.size(); ++n) sum -= std::log(factor.matrixLLT()(n, n));
    for (const double between : spreads.between) sum -= 0.5 * std::pow(between / kBetweenPrior, 2);
    return sum - 0.5 * std::pow(spreads.within / kWithinPrior, 2);
  }
};

/// The most probable of one spread, the others as they are: a grid of its logarithm, then a finer one.
void improve(double& spread, const LinearFigures& figures, const SourceFit& fit) {
  constexpr int kPlaces = 16;
  double low = std::log(kLeastSpread), high = std::log(kGreatestSpread);
  for (int round = 0; round < 3; ++round) {
    double best = low, best_log = -1e300;
    const double gap = (high - low) / kPlaces;
    for (int n = 0; n <= kPlaces; ++n) {
      spread = std::exp(low + n * gap);
      const double now = figures.log_probability(fit);
      if (now > best_log) {
        best_log = now;
        best = low + n * gap;
      }
    }
    spread = std::exp(best);
    low = std::max(std::log(kLeastSpread), best - gap);
    high = std::min(std::log(kGreatestSpread), best + gap);
  }
}

LinearFigures linear_at(const std::vector<FitFigure>& figures, const std::vector<bool>& is_used, const FitModel& model,
                        const Eigen::VectorXd& numbers) {
  const LogPredictions predicted = model.predict(numbers);
  const Eigen::MatrixXd jacobian = jacobian_of(model, numbers);
  LinearFigures linear;
  std::vector<Eigen::Index> places;
  for (std::size_t n = 0; n < figures.size(); ++n) {
    if (!is_used[n]) continue;
    places.push_back(static_cast<Eigen::Index>(n));
    linear.figures.push_back(figures[n]);
  }
  const auto count = static_cast<Eigen::Index>(places.size());
  linear.rest.resize(count);
  linear.open.resize(count);
  linear.jacobian.resize(count, numbers.size());
  for (Eigen::Index n = 0; n < count; ++n) {
    const Eigen::Index place = places[static_cast<std::size_t>(n)];
    linear.rest[n] = linear.figures[static_cast<std::size_t>(n)].log_measured - predicted.mean[place] -
                     jacobian.row(place).dot(model.prior_mean - numbers);
    linear.open[n] = predicted.open[place];
    linear.jacobian.row(n) = jacobian.row(place);
  }
  const Eigen::MatrixXd scaled = linear.jacobian * model.prior_sd.asDiagonal();
  linear.of_numbers = scaled * scaled.transpose();
  return linear;
}

}  // namespace

SourceFit fit_over_sources(const std::vector<FitFigure>& figures, const std::vector<bool>& is_used,
                           const FitModel& model) {
  SourceFit fit;
  std::array<std::set<int>, 2> sources;
  for (std::size_t n = 0; n < figures.size(); ++n) {
    if (is_used[n]) sources[static_cast<std::size_t>(figures[n].kind)].insert(figures[n].source);
  }
  for (std::size_t kind = 0; kind < 2; ++kind) fit.sources[kind] = static_cast<int>(sources[kind].size());
  if (fit.sources[0] + fit.sources[1] == 0) fail("fit over sources: expected one figure or more, found none");
  fit.numbers = model.prior_mean;
  fit.between = {0.5, 0.5};
  fit.within = 0.2;
  const Eigen::MatrixXd prior = model.prior_sd.cwiseAbs2().asDiagonal();
  for (int step = 0; step < kFitSteps; ++step) {
    const LinearFigures linear = linear_at(figures, is_used, model, fit.numbers);
    for (int round = 0; round < 2; ++round) {
      improve(fit.between[0], linear, fit);
      improve(fit.between[1], linear, fit);
      improve(fit.within, linear, fit);
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(linear.covariance(fit) + linear.of_numbers);
    const Eigen::MatrixXd gain = prior * linear.jacobian.transpose();
    const Eigen::VectorXd wanted = model.prior_mean + gain * factor.solve(linear.rest);
    fit.numbers += kStepShare * (wanted - fit.numbers);
    fit.covariance = prior - gain * factor.solve(gain.transpose());
  }
  return fit;
}

NewSource predict_new_source(const SourceFit& fit, const std::vector<FitFigure>& figures, const FitModel& model) {
  const LogPredictions predicted = model.predict(fit.numbers);
  const Eigen::MatrixXd jacobian = jacobian_of(model, fit.numbers);
  NewSource result;
  result.mean = predicted.mean;
  result.scale.resize(predicted.mean.size());
  for (Eigen::Index n = 0; n < result.mean.size(); ++n) {
    const auto kind = static_cast<std::size_t>(figures[static_cast<std::size_t>(n)].kind);
    const double of_numbers = jacobian.row(n) * fit.covariance * jacobian.row(n).transpose();
    result.scale[n] = std::sqrt(fit.between[kind] * fit.between[kind] + fit.within * fit.within +
                                predicted.open[n] * predicted.open[n] + std::max(0.0, of_numbers));
    result.degrees.push_back(std::max(1, fit.sources[kind] - 1));
  }
  return result;
}

}  // namespace spinaltap
