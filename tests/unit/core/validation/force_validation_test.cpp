// Compiled with optimisation: long loops of its own.
// Laws against published forces: what is left out stays out, and the band is that of the sources.

#include "core/validation/force_validation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/files/data_files.h"
#include "core/files/material_file.h"
#include "core/files/measurements_file.h"
#include "core/validation/detail/source_fit.h"
#include "tests/support/release_only.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const Measurements& all_measurements() {
  static const Measurements all = shipped_measurements();
  return all;
}

constexpr OpenConditions kFewSamples{.samples = 8};

/// Sources that lie about a law's one level as they were drawn.
TEST(FitOverSources, FindsTheLevelAndTheSpreadThatDataWereMadeWith) {
  constexpr int kSources = 60, kEach = 3;
  constexpr double kLevel = 1.5, kBetween = 0.6, kWithin = 0.15;
  std::vector<FitFigure> figures;
  for (int source = 0; source < kSources; ++source) {
    const double of_source = kBetween * random_normal(7, static_cast<std::uint64_t>(source));
    for (int n = 0; n < kEach; ++n) {
      const auto index = static_cast<std::uint64_t>(1000 + source * kEach + n);
      figures.push_back({source, 0, kLevel + of_source + kWithin * random_normal(7, index)});
    }
  }
  FitModel model;
  model.prior_mean = Eigen::VectorXd::Zero(1);
  model.prior_sd = Eigen::VectorXd::Constant(1, 10.0);
  model.predict = [&](const Eigen::VectorXd& level) {
    const auto count = static_cast<Eigen::Index>(figures.size());
    return LogPredictions{Eigen::VectorXd::Constant(count, level[0]), Eigen::VectorXd::Zero(count)};
  };
  const SourceFit fit = fit_over_sources(figures, std::vector<bool>(figures.size(), true), model);
  // Three standard errors of each.
  EXPECT_NEAR(fit.numbers[0], kLevel, 3.0 * kBetween / std::sqrt(kSources));
  EXPECT_NEAR(fit.between[0], kBetween, 3.0 * kBetween / std::sqrt(2.0 * kSources));
  EXPECT_NEAR(fit.within, kWithin, 3.0 * kWithin / std::sqrt(2.0 * kSources * (kEach - 1)));
  EXPECT_EQ(fit.sources[0], kSources);
  const NewSource next = predict_new_source(fit, figures, model);
  EXPECT_EQ(next.degrees[0], kSources - 1);
  EXPECT_NEAR(next.scale[0], std::sqrt(kBetween * kBetween + kWithin * kWithin), 0.2);
}

TEST(FitOverSources, NeedsAFigure) { EXPECT_THROW(fit_over_sources({{0, 0, 1.0}}, {false}, {}), Error); }

TEST(OpenConditions, AreWhatARowStatesAndSpreadWhereItStatesNothing) {
  for (const DrillingMeasurement& row : all_measurements().drilling) {
    if (!why_not_predicted(row).empty()) {
      EXPECT_THROW(conditions_of(row), Error);
      continue;
    }
    const std::vector<DrillingCondition> conditions = conditions_of(row);
    std::set<double> diameters, feeds;
    for (const DrillingCondition& one : conditions) {
      EXPECT_NO_THROW(check_bit(one.bit));
      EXPECT_EQ(one.bit.diameter_mm, row.diameter_mm.value_or(one.bit.diameter_mm));
      if (row.rpm) {
        EXPECT_GE(one.rpm, row.rpm->low * (1.0 - 1e-12));
        EXPECT_LE(one.rpm, row.rpm->high * (1.0 + 1e-12));
      }
      const bool is_stated =
          row.rpm && row.feed_mm_min && row.rpm->low == row.rpm->high && row.feed_mm_min->low == row.feed_mm_min->high;
      if (is_stated) {
        EXPECT_NEAR(one.feed_mm_per_turn, row.feed_mm_min->low / row.rpm->low, 1e-12);
      }
      diameters.insert(one.bit.diameter_mm);
      feeds.insert(one.feed_mm_per_turn);
    }
    EXPECT_EQ(diameters.size() > 1, !row.diameter_mm.has_value()) << row.source;
    EXPECT_TRUE(row.feed_mm_min || feeds.size() == conditions.size()) << row.source;
  }
}

TEST(ForceValidation, HoldsEveryRowAgainstBothLawsOrSaysWhyNot) {
  const ForceValidation validation = validate_forces(all_measurements(), {}, kFewSamples);
  ASSERT_EQ(validation.laws.size(), 2U);
  EXPECT_EQ(validation.laws[0].law, CuttingLaw::power);
  EXPECT_EQ(validation.laws[1].law, CuttingLaw::mechanistic);
  std::set<std::size_t> rows;
  for (const UnpredictedRow& one : validation.unpredicted) {
    EXPECT_FALSE(one.why.empty());
    EXPECT_TRUE(rows.insert(one.row).second);
  }
  std::size_t figures = 0;
  for (const DrillingMeasurement& row : all_measurements().drilling) {
    if (!why_not_predicted(row).empty()) continue;
    figures += (row.thrust_n || row.thrust_range_n) ? 1U : 0U;
    figures += (row.torque_n_mm || row.torque_range_n_mm) ? 1U : 0U;
  }
  for (const LawValidation& law : validation.laws) {
    EXPECT_EQ(law.left_out.size(), figures);
    for (const PredictedFigure& figure : law.left_out) {
      rows.insert(figure.row);
      EXPECT_GT(figure.p05, 0.0);
      EXPECT_LT(figure.p05, figure.predicted);
      EXPECT_LT(figure.predicted, figure.p95);
      EXPECT_GE(figure.error_factor(), 1.0);
      EXPECT_TRUE(std::isfinite(figure.p95));
    }
    // Issue of the law: at least 85 % of the figures inside.
    EXPECT_GE(summary_of(law.left_out).inside_share, 0.85);
  }
  EXPECT_EQ(rows.size(), all_measurements().drilling.size());
}

TEST(ForceValidation, PredictsASourceWithoutAnyOfItsFigures) {
  RELEASE_ONLY();
  const ForceValidation before = validate_forces(all_measurements(), {}, kFewSamples);
  Measurements other = all_measurements();
  for (DrillingMeasurement& row : other.drilling) {
    if (row.source == "macavelia2012" && row.thrust_n) row.thrust_n = 7.0 * *row.thrust_n;
  }
  const ForceValidation after = validate_forces(other, {}, kFewSamples);
  int same = 0, moved = 0;
  for (std::size_t law = 0; law < 2; ++law) {
    for (std::size_t n = 0; n < before.laws[law].left_out.size(); ++n) {
      const PredictedFigure& was = before.laws[law].left_out[n];
      const PredictedFigure& is = after.laws[law].left_out[n];
      if (other.drilling[was.row].source == "macavelia2012") {
        EXPECT_EQ(was.predicted, is.predicted);
        EXPECT_EQ(was.p95, is.p95);
        ++same;
      } else {
        moved += was.predicted != is.predicted ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(same, 12);
  EXPECT_GT(moved, 20);
}

TEST(ForceValidation, ShippedMaterialsCarryTheSpreadOfTheMeasurements) {
  for (const char* name : {"vertebra.json", "mechanistic.json"}) {
    const Material shipped = read_material(data_file(std::string("materials/") + name), {});
    const ForceSpreads spreads = spreads_of(all_measurements(), shipped);
    // As the files round them.
    EXPECT_NEAR(shipped.thrust_spread.median, spreads.thrust.median, 0.002) << name;
    EXPECT_NEAR(shipped.thrust_spread.log_scale, spreads.thrust.log_scale, 0.002) << name;
    EXPECT_EQ(shipped.thrust_spread.degrees, spreads.thrust.degrees) << name;
    EXPECT_NEAR(shipped.torque_spread.median, spreads.torque.median, 0.002) << name;
    EXPECT_NEAR(shipped.torque_spread.log_scale, spreads.torque.log_scale, 0.002) << name;
    EXPECT_EQ(shipped.torque_spread.degrees, spreads.torque.degrees) << name;
  }
}

TEST(ForceValidation, NeedsARowThatALawSpeaksOf) {
  Measurements none = all_measurements();
  std::erase_if(none.drilling, [](const DrillingMeasurement& row) { return why_not_predicted(row).empty(); });
  EXPECT_THAT([&] { validate_forces(none, {}); }, ThrowsMessage<Error>(HasSubstr("found none")));
}

TEST(FigureSummaries, AreSharesAndMedians) {
  const std::vector<PredictedFigure> figures{{.measured = 10.0, .predicted = 20.0, .p05 = 5.0, .p95 = 50.0},
                                             {.measured = 10.0, .predicted = 5.0, .p05 = 1.0, .p95 = 8.0},
                                             {.measured = 10.0, .predicted = 40.0, .p05 = 4.0, .p95 = 400.0}};
  const FigureSummary summary = summary_of(figures);
  EXPECT_NEAR(summary.inside_share, 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(summary.median_error_factor, 2.0, 1e-12);
  EXPECT_NEAR(summary.median_width, 10.0, 1e-12);
  EXPECT_EQ(summary_of({}).figures, 0U);
}

}  // namespace
}  // namespace spinaltap
