#include "core/validation/force_validation.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "core/base/error.h"
#include "core/base/statistics.h"
#include "core/force/cutting_law.h"
#include "core/validation/detail/source_fit.h"

namespace spinaltap {
namespace {

constexpr double kLow = 0.05, kHigh = 0.95;

/// CT numbers in which a density is read off: exact enough, and the same for every material.
constexpr HuToDensity kThousandths{0.0, 1e-3};

/// What laws are fitted to: figures, and drillings that each may have been of.
struct Figures {
  std::vector<FitFigure> fit;
  std::vector<PredictedFigure> rows;   ///< measured only
  std::vector<std::size_t> drillings;  ///< which of `conditions` each is of
  std::vector<std::vector<DrillingCondition>> conditions;
  std::vector<UnpredictedRow> unpredicted;
  int sources = 0;
};

double middle_of(const MeasuredRange& range) { return 0.5 * (range.low + range.high); }

Figures figures_of(const Measurements& measurements, const OpenConditions& open) {
  Figures figures;
  std::map<std::string, int> sources;
  for (std::size_t n = 0; n < measurements.drilling.size(); ++n) {
    const DrillingMeasurement& row = measurements.drilling[n];
    if (std::string why = why_not_predicted(row); !why.empty()) {
      figures.unpredicted.push_back({n, std::move(why)});
      continue;
    }
    const int source = sources.try_emplace(row.source, static_cast<int>(sources.size())).first->second;
    figures.conditions.push_back(conditions_of(row, open));
    const auto add = [&](int kind, const std::optional<double>& value, const std::optional<MeasuredRange>& range) {
      if (!value && !range) return;
      const double measured = value ? *value : middle_of(*range);
      figures.fit.push_back({source, kind, std::log(measured)});
      figures.rows.push_back({n, kind == 1, measured, value ? std::nullopt : range});
      figures.drillings.push_back(figures.conditions.size() - 1);
    };
    add(0, row.thrust_n, row.thrust_range_n);
    add(1, row.torque_n_mm, row.torque_range_n_mm);
  }
  figures.sources = static_cast<int>(sources.size());
  if (figures.fit.empty()) fail("forces: expected a measurement of drilling that a law speaks of, found none");
  return figures;
}

/// A logarithm's mean and deviation over the drillings that a row may be of.
struct LogSum {
  double sum = 0.0, squares = 0.0;
  void add(double value) {
    sum += std::log(value);
    squares += std::log(value) * std::log(value);
  }
};

LogPredictions predict(const Figures& figures, Material material) {
  material.density = kThousandths;
  std::vector<std::array<LogSum, 2>> sums(figures.conditions.size());
  for (std::size_t n = 0; n < sums.size(); ++n) {
    for (const DrillingCondition& one : figures.conditions[n]) {
      const CuttingResistance asked =
          resistance_of_block(one.bit, material, 1000.0 * one.density_g_cm3, one.rpm, one.depth_mm);
      sums[n][0].add(asked.thrust_n(one.feed_mm_per_turn));
      sums[n][1].add(asked.torque_n_mm(one.feed_mm_per_turn));
    }
  }
  const auto count = static_cast<Eigen::Index>(figures.fit.size());
  LogPredictions predictions{Eigen::VectorXd(count), Eigen::VectorXd(count)};
  for (Eigen::Index n = 0; n < count; ++n) {
    const auto figure = static_cast<std::size_t>(n);
    const std::size_t drilling = figures.drillings[figure];
    const LogSum& sum = sums[drilling][static_cast<std::size_t>(figures.fit[figure].kind)];
    const auto samples = static_cast<double>(figures.conditions[drilling].size());
    const double mean = sum.sum / samples;
    predictions.mean[n] = mean;
    predictions.open[n] = std::sqrt(std::max(0.0, sum.squares / samples - mean * mean));
  }
  return predictions;
}

/// The law with its six free numbers; what they leave is as materials have it without a file.
Material material_of(CuttingLaw law, const Eigen::VectorXd& numbers) {
  Material material;
  material.law = law;
  material.thrust_spread = material.torque_spread = ForceSpread{};
  material.specific_cutting_energy_mpa = std::min(std::exp(numbers[0]), 1e4);
  material.chisel_mpa = std::min(std::exp(numbers[1]), 1e4);
  material.feed_exponent = std::clamp(numbers[2], 0.0, 0.95);
  if (law == CuttingLaw::power) {
    material.lip_thrust_share = std::min(std::exp(numbers[3]), 10.0);
  } else {
    material.lips.friction_deg = std::clamp(numbers[3], 1.0, 45.0);
  }
  material.cutting_exponent = std::clamp(numbers[4], 0.0, 4.0);
  material.chisel_exponent = std::clamp(numbers[5], 0.0, 4.0);
  return material;
}

/// What is known of each number without any drilling: of levels next to nothing; exponents of density from the strength
/// of bone, its square (Carter & Hayes 1977); that of the feed and the friction as of chips of other materials.
FitModel model_of(const Figures& figures, CuttingLaw law) {
  const bool is_power = law == CuttingLaw::power;
  FitModel model;
  model.prior_mean.resize(6);
  model.prior_sd.resize(6);
  model.prior_mean << std::log(100.0), std::log(100.0), 0.3, is_power ? std::log(0.5) : 30.0, 2.0, 2.0;
  model.prior_sd << 1.5, 1.5, 0.15, is_power ? 0.5 : 6.0, 0.3, 0.3;
  model.predict = [&figures, law](const Eigen::VectorXd& numbers) {
    return predict(figures, material_of(law, numbers));
  };
  return model;
}

/// A law as it is, but for a level of its thrust and one of its torque.
FitModel levels_of(const Figures& figures, const Material& material) {
  FitModel model;
  model.prior_mean = Eigen::VectorXd::Zero(2);
  model.prior_sd = Eigen::VectorXd::Constant(2, 2.0);
  model.predict = [&figures, known = predict(figures, material)](const Eigen::VectorXd& levels) {
    LogPredictions predictions = known;
    for (Eigen::Index n = 0; n < predictions.mean.size(); ++n) {
      predictions.mean[n] += levels[figures.fit[static_cast<std::size_t>(n)].kind];
    }
    return predictions;
  };
  return model;
}

ForceSpreads spreads_of(const Figures& figures, const Material& material) {
  const SourceFit fit =
      fit_over_sources(figures.fit, std::vector<bool>(figures.fit.size(), true), levels_of(figures, material));
  const auto spread = [&](std::size_t kind) {
    const auto at = static_cast<Eigen::Index>(kind);
    return ForceSpread{
        std::exp(fit.numbers[at]),
        std::sqrt(fit.between[kind] * fit.between[kind] + fit.within * fit.within + fit.covariance(at, at)),
        static_cast<double>(std::max(1, fit.sources[kind] - 1))};
  };
  return {spread(0), spread(1)};
}

PredictedFigure with_band(PredictedFigure figure, double mean, double scale, int degrees) {
  figure.predicted = std::exp(mean);
  figure.p05 = std::exp(mean + scale * student_quantile(kLow, degrees));
  figure.p95 = std::exp(mean + scale * student_quantile(kHigh, degrees));
  return figure;
}

LawValidation validate(const Figures& figures, CuttingLaw law, const Progress& progress) {
  const FitModel model = model_of(figures, law);
  LawValidation result;
  result.law = law;
  result.left_out.resize(figures.rows.size());
  // One fit without each source, and one of all; each is the same whatever thread makes it.
  tbb::parallel_for(0, figures.sources + 1, [&](int left_out) {
    std::vector<bool> is_used;
    for (const FitFigure& figure : figures.fit) is_used.push_back(figure.source != left_out);
    const SourceFit fit = fit_over_sources(figures.fit, is_used, model);
    if (left_out == figures.sources) {
      result.fitted = material_of(law, fit.numbers);
      return;
    }
    const NewSource predicted = predict_new_source(fit, figures.fit, model);
    for (std::size_t n = 0; n < figures.fit.size(); ++n) {
      if (is_used[n]) continue;
      const auto at = static_cast<Eigen::Index>(n);
      result.left_out[n] = with_band(figures.rows[n], predicted.mean[at], predicted.scale[at], predicted.degrees[n]);
    }
  });
  progress.report("fitting laws", law == CuttingLaw::power ? 0.5 : 1.0);
  const ForceSpreads spreads = spreads_of(figures, result.fitted);
  result.fitted.thrust_spread = spreads.thrust;
  result.fitted.torque_spread = spreads.torque;
  return result;
}

std::vector<PredictedFigure> by_given(const Figures& figures, const Material& material) {
  const LogPredictions known = predict(figures, material);
  std::vector<PredictedFigure> predicted;
  for (std::size_t n = 0; n < figures.rows.size(); ++n) {
    const auto at = static_cast<Eigen::Index>(n);
    const ForceSpread& spread = figures.rows[n].is_torque ? material.torque_spread : material.thrust_spread;
    predicted.push_back(with_band(figures.rows[n], known.mean[at] + std::log(spread.median),
                                  std::hypot(spread.log_scale, known.open[at]), static_cast<int>(spread.degrees)));
  }
  return predicted;
}

}  // namespace

double PredictedFigure::error_factor() const { return std::exp(std::abs(std::log(predicted / measured))); }

FigureSummary summary_of(const std::vector<PredictedFigure>& figures) {
  FigureSummary summary;
  std::vector<double> factors, widths;
  for (const PredictedFigure& figure : figures) {
    ++summary.figures;
    summary.inside_share += figure.is_inside() ? 1.0 : 0.0;
    factors.push_back(figure.error_factor());
    widths.push_back(figure.p95 / figure.p05);
  }
  if (figures.empty()) return summary;
  summary.inside_share /= static_cast<double>(summary.figures);
  std::sort(factors.begin(), factors.end());
  std::sort(widths.begin(), widths.end());
  summary.median_error_factor = quantile(factors, 0.5);
  summary.median_width = quantile(widths, 0.5);
  return summary;
}

const LawValidation& ForceValidation::better() const {
  return *std::min_element(laws.begin(), laws.end(), [](const LawValidation& a, const LawValidation& b) {
    return summary_of(a.left_out).median_error_factor < summary_of(b.left_out).median_error_factor;
  });
}

std::string_view name_of(CuttingLaw law) { return law == CuttingLaw::power ? "power" : "mechanistic"; }

ForceValidation validate_forces(const Measurements& measurements, const Material& given, const OpenConditions& open,
                                const Progress& progress) {
  check_material(given);
  const Figures figures = figures_of(measurements, open);
  ForceValidation validation;
  validation.unpredicted = figures.unpredicted;
  for (const CuttingLaw law : {CuttingLaw::power, CuttingLaw::mechanistic}) {
    validation.laws.push_back(validate(figures, law, progress));
  }
  validation.given = by_given(figures, given);
  validation.given_spreads = spreads_of(figures, given);
  return validation;
}

ForceSpreads spreads_of(const Measurements& measurements, const Material& material, const OpenConditions& open) {
  check_material(material);
  return spreads_of(figures_of(measurements, open), material);
}

}  // namespace spinaltap
