#include "core/study/study_summary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/base/random.h"
#include "core/files/study_summary_json.h"
#include "tests/support/nan.h"

namespace spinaltap {
namespace {

using test::kNan;

/// 60 runs at two diameters with entry errors of -2.95, -2.85, ... mm: beyond 2 mm to the left the canal is breached,
/// by what is beyond; thrust is 10 N times the diameter; only wide bits plunge.
std::vector<StudyRow> counted_rows() {
  std::vector<StudyRow> rows;
  for (std::size_t n = 0; n < 60; ++n) {
    StudyRow row;
    const double left_mm = -2.95 + 0.1 * static_cast<double>(n);
    const double diameter_mm = n % 2 == 0 ? 3.0 : 4.0;
    const double breach_mm = std::max(0.0, left_mm - 2.0);
    row[StudyColumn::run] = static_cast<double>(n);
    row[StudyFactor::entry_left_mm] = left_mm;
    row[StudyFactor::bit_diameter_mm] = diameter_mm;
    row[StudyColumn::contact] = 1.0;
    row[StudyColumn::breach] = breach_mm > 0.0 ? 1.0 : 0.0;
    row[StudyColumn::breach_canal_mm] = breach_mm;
    row[StudyColumn::grade] = breach_mm > 0.0 ? 1.0 : 0.0;
    row[StudyColumn::max_thrust_n] = 10.0 * diameter_mm;
    row[StudyColumn::plunge_depth_mm] = diameter_mm > 3.5 ? 1.0 : kNan;
    row[StudyColumn::min_clearance_outer_mm] = std::numeric_limits<double>::infinity();
    row[StudyColumn::breakthrough_mm] = n < 15 ? 40.0 : kNan;
    row[StudyColumn::stop_mm] = kNan;
    rows.push_back(row);
  }
  return rows;
}

const StudyDesign kOffsetDesign{{{StudyFactor::entry_left_mm, FactorDistribution::Kind::uniform, {}, -3.0, 3.0},
                                 {StudyFactor::bit_diameter_mm, FactorDistribution::Kind::levels, {3.0, 4.0}},
                                 {StudyFactor::density_scale, FactorDistribution::Kind::levels, {1.0}}},
                                30};

TEST(StudySummary, CountsWhatCameAbout) {
  const StudySummary summary = summarise_study(counted_rows(), StudyRuns(kOffsetDesign));
  EXPECT_EQ(summary.runs, 60U);
  EXPECT_EQ(summary.breach.count, 10U);
  EXPECT_EQ(summary.canal.count, 10U);
  EXPECT_EQ(summary.outer.count, 0U);
  EXPECT_EQ(summary.grades[0].count, 50U);
  EXPECT_EQ(summary.grades[1].count, 10U);
  EXPECT_EQ(summary.grades[4].count, 0U);
  EXPECT_EQ(summary.contact.count, 60U);
  EXPECT_EQ(summary.breakthrough.count, 15U);
  EXPECT_EQ(summary.stopped.count, 0U);
  EXPECT_EQ(summary.outside_volume.count, 0U);
  EXPECT_DOUBLE_EQ(summary.breach.probability(), 1.0 / 6.0);
  EXPECT_EQ(summary.breach.interval.low, wilson_interval(10, 60).low);
  EXPECT_EQ(summary.breach.interval.high, wilson_interval(10, 60).high);
}

TEST(StudySummary, TellsHowValuesAreSpreadOfTheRunsThatHaveOne) {
  const StudySummary summary = summarise_study(counted_rows(), StudyRuns(kOffsetDesign));
  for (const StudySpread& spread : summary.spreads) {
    if (spread.column == StudyColumn::max_thrust_n) {
      EXPECT_EQ(spread.runs, 60U);
      EXPECT_NEAR(spread.mean, 35.0, 1e-12);
      EXPECT_EQ(spread.quantiles.front(), 30.0);
      EXPECT_EQ(spread.quantiles.back(), 40.0);
    } else if (spread.column == StudyColumn::plunge_depth_mm) {
      EXPECT_EQ(spread.runs, 30U);
      EXPECT_NEAR(spread.mean, 1.0, 1e-12);
    } else if (spread.column == StudyColumn::min_clearance_outer_mm) {
      EXPECT_EQ(spread.runs, 0U);
      EXPECT_TRUE(std::isnan(spread.mean));
      EXPECT_TRUE(std::isnan(spread.quantiles[3]));
    }
  }
}

TEST(StudySummary, PartsTheRunsByEachFactorThatDiffers) {
  const StudySummary summary = summarise_study(counted_rows(), StudyRuns(kOffsetDesign));
  ASSERT_EQ(summary.factors.size(), 2U);
  const auto& by_entry = summary.factors[0];
  EXPECT_EQ(by_entry.factor, StudyFactor::entry_left_mm);
  std::size_t runs = 0, breaches = 0;
  for (const StudyBin& bin : by_entry.bins) {
    runs += bin.breach.runs;
    breaches += bin.breach.count;
    EXPECT_EQ(bin.breach.runs, 6U);
    EXPECT_GE(bin.middle, bin.low);
    EXPECT_LE(bin.middle, bin.high);
    // Ten bins of six runs: breaches are in the runs beyond 2 mm only.
    if (bin.high < 2.0) {
      EXPECT_EQ(bin.breach.count, 0U) << bin.high;
    }
    if (bin.low > 2.0) {
      EXPECT_EQ(bin.canal.count, 6U) << bin.low;
    }
  }
  EXPECT_EQ(runs, 60U);
  EXPECT_EQ(breaches, 10U);
  const auto& by_diameter = summary.factors[1];
  ASSERT_EQ(by_diameter.bins.size(), 2U);
  EXPECT_EQ(by_diameter.bins[0].middle, 3.0);
  EXPECT_EQ(by_diameter.bins[1].middle, 4.0);
  for (const StudyBin& bin : by_diameter.bins) {
    EXPECT_EQ(bin.breach.runs, 30U);
    EXPECT_EQ(bin.breach.count, 5U);
  }
}

TEST(StudySummary, JsonHoldsWhatWasFound) {
  const Json json = to_json(summarise_study(counted_rows(), StudyRuns(kOffsetDesign)));
  EXPECT_EQ(json["breach"]["count"], 10);
  EXPECT_EQ(json["canal_breach"]["runs"], 60);
  EXPECT_EQ(json["grades"]["B"]["count"], 10);
  EXPECT_EQ(json["distributions"]["max_thrust_n"]["p50"], 35.0);
  EXPECT_EQ(json["breach_by_factor"]["entry_left_mm"].size(), 10U);
  EXPECT_EQ(json["interval"], "Wilson, 95 %");
  // What there is not is null, as JSON has no other word for it.
  EXPECT_NE(json.dump().find("\"mean\":null"), std::string::npos);
}

/// 20 screws a patient, of which as many as the patient's number have grade C, into the canal; left and right in turn.
std::vector<StudyRow> graded_rows(std::size_t patients) {
  std::vector<StudyRow> rows;
  for (std::size_t patient = 0; patient < patients; ++patient) {
    for (std::size_t n = 0; n < 20; ++n) {
      StudyRow row;
      const bool is_bad = n < patient;
      row[StudyColumn::run] = static_cast<double>(rows.size());
      row[StudyColumn::patient] = static_cast<double>(patient + 1);
      row[StudyColumn::level] = patient % 2 == 0 ? 22.0 : 23.0;
      row[StudyColumn::side] = static_cast<double>(n % 2);
      row[StudyColumn::screw_grade] = is_bad ? 2.0 : 0.0;
      row[StudyColumn::screw_canal_mm] = is_bad ? 3.0 : 0.0;
      row[StudyColumn::breach] = kNan;
      row[StudyFactor::entry_error_scale] = n < 10 ? 1.0 : 0.5;
      rows.push_back(row);
    }
  }
  return rows;
}

TEST(StudySummary, TellsScrewsByPatientLevelAndSideWithIntervalsForPatients) {
  const StudyDesign design{{}, 20};
  const StudySummary summary = summarise_study(graded_rows(5), StudyRuns(design, {.patients = {0, 1, 2, 3, 4}}));
  EXPECT_FALSE(summary.has_drilled);
  ASSERT_EQ(summary.screws.size(), 1U + 5U + 2U + 2U);
  const StudyScrews& all = summary.screws[0];
  EXPECT_EQ(all.runs, 100U);
  EXPECT_EQ(all.patients, 5U);
  EXPECT_EQ(all.grades[2].count, 10U);
  EXPECT_EQ(all.acceptable.count, 90U);
  EXPECT_EQ(all.canal.count, 10U);
  EXPECT_EQ(all.anterior.count, 0U);
  // Patients differ, so that the interval is wider than that of 100 screws of 100 patients.
  EXPECT_LT(all.grades[2].interval.low, wilson_interval(10, 100).low);
  EXPECT_GT(all.grades[2].interval.high, wilson_interval(10, 100).high);
  EXPECT_EQ(summary.screws[5].what, "patient 5");
  EXPECT_EQ(summary.screws[5].grades[2].count, 4U);
  EXPECT_EQ(summary.screws[6].what, "L3");
  EXPECT_EQ(summary.screws[6].runs, 60U);
  EXPECT_EQ(summary.screws[6].grades[2].count, 0U + 2U + 4U);
  EXPECT_EQ(summary.screws[8].what, "left");
  EXPECT_EQ(summary.screws[8].grades[2].count, 0U + 1U + 1U + 2U + 2U);
}

TEST(StudySummary, MapsBreachesOverWhereScrewsLie) {
  // Entries on a lattice of 0.25 mm; from 1.25 mm medial on there is a breach, from 3 mm on one of grade C.
  std::vector<StudyRow> rows;
  for (int medial = -16; medial <= 16; ++medial) {
    for (int cranial = -8; cranial <= 8; ++cranial) {
      StudyRow row;
      const double medial_mm = 0.25 * medial;
      row[StudyColumn::run] = static_cast<double>(rows.size());
      row[StudyColumn::patient] = 1.0 + static_cast<double>(rows.size() % 3);
      row[StudyColumn::level] = kNan;
      row[StudyColumn::side] = cranial < 0 ? 0.0 : 1.0;
      row[StudyColumn::off_medial_mm] = medial_mm;
      row[StudyColumn::off_cranial_mm] = 0.25 * cranial;
      row[StudyColumn::off_medial_deg] = row[StudyColumn::off_cranial_deg] = kNan;
      row[StudyColumn::screw_grade] = medial_mm >= 3.0 ? 2.0 : medial_mm >= 1.25 ? 1.0 : 0.0;
      rows.push_back(row);
    }
  }
  rows.push_back(rows.front());
  rows.back()[StudyColumn::screw_grade] = kNan;  // graded by nobody
  const StudySummary summary = summarise_study(rows, StudyRuns(StudyDesign{{}, rows.size()}, {.patients = {0, 1, 2}}));
  ASSERT_EQ(summary.maps.size(), 3U) << "of all, left and right; nothing is known of directions";
  EXPECT_EQ(summary.maps[0].what, "all");
  EXPECT_EQ(summary.maps[1].what, "left");
  std::size_t runs = 0;
  std::pair<int, int> last{-99, -99};
  for (const StudyMap::Cell& cell : summary.maps[0].cells) {
    runs += cell.beyond_a.runs;
    EXPECT_LT(last, (std::pair{cell.cranial, cell.medial}));
    last = {cell.cranial, cell.medial};
    // Halves go away from 0: the cell at 1 holds 0.5 to 1.25, that at 2 holds 1.5 to 2.25, that at 3 2.5 to 3.25.
    const double share = cell.beyond_a.probability(), beyond_b = cell.beyond_b.probability();
    if (cell.medial < 1) {
      EXPECT_EQ(share, 0.0);
    }
    if (cell.medial == 1) {
      EXPECT_NEAR(share, 0.25, 1e-12);
    }
    if (cell.medial > 1) {
      EXPECT_EQ(share, 1.0);
    }
    if (cell.medial == 3) {
      EXPECT_NEAR(beyond_b, 0.5, 1e-12);
    }
    if (cell.medial > 3) {
      EXPECT_EQ(beyond_b, 1.0);
    }
    EXPECT_LE(cell.beyond_a.interval.low, share);
    EXPECT_GE(cell.beyond_a.interval.high, share);
  }
  EXPECT_EQ(runs, rows.size() - 1);

  const std::string csv = study_map_csv(summary.maps);
  std::size_t lines = 1;
  for (const StudyMap& map : summary.maps) lines += map.cells.size();
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), lines);
  EXPECT_NE(csv.find("\nright,entry_mm,1,"), std::string::npos);
  // Beyond what any screw is off by there is nothing to draw.
  rows.front()[StudyColumn::off_medial_mm] = 1e30;
  EXPECT_NO_THROW(summarise_study(rows, StudyRuns(StudyDesign{{}, rows.size()}, {.patients = {0, 1, 2}})));
}

TEST(StudySummary, FindsHowSmallErrorsMustBe) {
  StudyDesign design;
  design.distributions = {{StudyFactor::entry_error_scale, FactorDistribution::Kind::levels, {0.5, 1.0}}};
  design.runs = 10;
  // At 0.5 all are A, at 1 40 of 50: between them 95 % are A at a quarter of the way.
  const StudySummary summary = summarise_study(graded_rows(5), StudyRuns(design, {.patients = {0, 1, 2, 3, 4}}));
  ASSERT_EQ(summary.tolerances.size(), 1U);
  ASSERT_EQ(summary.tolerances[0].scales, (std::vector<double>{0.5, 1.0}));
  EXPECT_EQ(summary.tolerances[0].a[0].count, 50U);
  EXPECT_EQ(summary.tolerances[0].a[1].count, 40U);
  ASSERT_TRUE(summary.tolerances[0].up_to.has_value());
  EXPECT_NEAR(*summary.tolerances[0].up_to, 0.5 + 0.25 * 0.5, 1e-12);
}

TEST(StudySummary, FindsHowSmallAllErrorsMustBeTogether) {
  // Errors e of the entry and f of the direction are even from 0 to 1; a screw is A where their scaled sum is 1.5 at
  // most. What is beyond is a corner of their square, of area (2 - 1.5 / s)^2 / 2 where both are scaled by s, and of
  // (s - 0.5)^2 / (2 s) where one is: 5 % at s = 1.5 / (2 - sqrt(0.1)), and at s^2 - 1.1 s + 0.25 = 0.
  constexpr double kTogether = 0.8909, kAlone = 0.7791;
  const std::vector<double> levels{0.7, 0.75, 0.8, 0.85, 0.9, 0.95, 1.0};
  constexpr std::size_t kRuns = 1000;
  std::vector<StudyRow> rows;
  for (const double entry : levels) {
    for (const double direction : levels) {
      for (std::size_t n = 0; n < kRuns; ++n) {
        // Points that fill a square evenly: Roberts's sequence, by the powers of the plastic number.
        const auto k = static_cast<double>(n);
        const double e = std::fmod(0.5 + 0.7548776662466927 * k, 1.0), f = std::fmod(0.5 + 0.5698402909980532 * k, 1.0);
        StudyRow row;
        row[StudyColumn::run] = static_cast<double>(rows.size());
        row[StudyColumn::patient] = 1.0;
        row[StudyColumn::screw_grade] = entry * e + direction * f <= 1.5 ? 0.0 : 2.0;
        row[StudyFactor::entry_error_scale] = entry;
        row[StudyFactor::direction_error_scale] = direction;
        row[StudyFactor::registration_scale] = kNan;
        rows.push_back(row);
      }
    }
  }
  StudyDesign design;
  design.distributions = {{StudyFactor::entry_error_scale, FactorDistribution::Kind::levels, levels},
                          {StudyFactor::direction_error_scale, FactorDistribution::Kind::levels, levels}};
  design.runs = kRuns;
  const StudySummary summary = summarise_study(rows, StudyRuns(design, {.has_errors = true}));
  ASSERT_EQ(summary.tolerances.size(), 3U);
  // Points of a thousand miss an area by some 0.002, and lines between levels a scale by some 0.003.
  for (const std::size_t one : {0U, 1U}) {
    ASSERT_TRUE(summary.tolerances[one].up_to.has_value());
    EXPECT_NEAR(*summary.tolerances[one].up_to, kAlone, 0.01);
    EXPECT_EQ(summary.tolerances[one].factors.size(), 1U);
  }
  const StudyTolerance& together = summary.tolerances[2];
  EXPECT_EQ(together.factors,
            (std::vector<StudyFactor>{StudyFactor::entry_error_scale, StudyFactor::direction_error_scale}));
  EXPECT_EQ(together.scales, levels);
  EXPECT_EQ(together.a[0].runs, kRuns);
  ASSERT_TRUE(together.up_to.has_value());
  EXPECT_NEAR(*together.up_to, kTogether, 0.01);
}

TEST(StudySummary, BlamesTheInputThatMakesTheDifference) {
  StudyDesign design;
  design.sampling = StudySampling::saltelli;
  design.runs = 400;
  design.distributions = {
      {.factor = StudyFactor::entry_left_mm, .kind = FactorDistribution::Kind::normal, .a = 0.0, .b = 2.0},
      {.factor = StudyFactor::entry_head_mm, .kind = FactorDistribution::Kind::normal, .a = 0.0, .b = 1.0}};
  const StudyRuns runs(design);
  std::vector<StudyRow> rows;
  for (std::size_t n = 0; n < runs.count(); ++n) {
    const FactorValues values = runs.values(n, {});
    StudyRow row;
    row[StudyColumn::run] = static_cast<double>(n);
    row[StudyColumn::max_thrust_n] = 50.0 + values[0] + values[1];
    row[StudyColumn::screw_pullout_n] = kNan;
    rows.push_back(row);
  }
  const StudySummary summary = summarise_study(rows, runs);
  const auto thrust = std::find_if(summary.sensitivities.begin(), summary.sensitivities.end(),
                                   [](const StudySensitivity& one) { return one.result == "max_thrust_n"; });
  ASSERT_NE(thrust, summary.sensitivities.end());
  // Variances of 4 and 1 add up.
  EXPECT_NEAR(thrust->indices.groups[0].first_order, 0.8, 0.1);
  EXPECT_NEAR(thrust->indices.groups[1].total, 0.2, 0.05);
  for (const StudySensitivity& one : summary.sensitivities) EXPECT_NE(one.result, "screw_pullout_n");
}

}  // namespace
}  // namespace spinaltap
