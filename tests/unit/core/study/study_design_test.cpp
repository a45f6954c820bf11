#include "core/study/study_design.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "tests/support/nan.h"

namespace spinaltap {
namespace {

using test::kNan;
using testing::HasSubstr;
using testing::ThrowsMessage;
using Kind = FactorDistribution::Kind;

double of(const FactorValues& values, StudyFactor factor) { return values[static_cast<std::size_t>(factor)]; }

std::vector<double> column(const StudyRuns& runs, StudyFactor factor) {
  std::vector<double> values;
  for (std::size_t n = 0; n < runs.count(); ++n) values.push_back(of(runs.values(n, {}), factor));
  return values;
}

/// 2 x 3 levels, and one factor of each distribution.
StudyDesign mixed(bool is_latin) {
  return {{{StudyFactor::bit_diameter_mm, Kind::levels, {3.0, 4.0}},
           {StudyFactor::density_scale, Kind::levels, {0.6, 0.8, 1.0}},
           {StudyFactor::entry_left_mm, Kind::normal, {}, 0.5, 2.0},
           {StudyFactor::angle_head_deg, Kind::uniform, {}, -3.0, 5.0}},
          50,
          is_latin ? StudySampling::latin_hypercube : StudySampling::random,
          7};
}

TEST(StudyDesign, CrossesEveryLevelWithEveryOther) {
  const StudyRuns runs(mixed(false));
  ASSERT_EQ(runs.count(), 300U);
  std::map<std::pair<double, double>, int> met;
  for (std::size_t n = 0; n < runs.count(); ++n) {
    const FactorValues values = runs.values(n, {});
    ++met[{of(values, StudyFactor::bit_diameter_mm), of(values, StudyFactor::density_scale)}];
  }
  ASSERT_EQ(met.size(), 6U);
  for (const auto& [levels, count] : met) EXPECT_EQ(count, 50) << levels.first << " mm, " << levels.second;
}

TEST(StudyDesign, LeavesFactorsThatDoNotDifferAsTheyAre) {
  FactorValues base{};
  base[static_cast<std::size_t>(StudyFactor::push_n)] = 25.0;
  base[static_cast<std::size_t>(StudyFactor::feed_mm_s)] = std::numeric_limits<double>::quiet_NaN();
  const FactorValues values = StudyRuns(mixed(false)).values(17, base);
  EXPECT_EQ(of(values, StudyFactor::push_n), 25.0);
  EXPECT_TRUE(std::isnan(of(values, StudyFactor::feed_mm_s)));
}

TEST(StudyDesign, GivesRunNTheSameNumbersWhoeverAsksInWhateverOrder) {
  for (const bool is_latin : {false, true}) {
    const StudyRuns all(mixed(is_latin));
    const StudyRuns again(mixed(is_latin));
    std::vector<FactorValues> forward;
    for (std::size_t n = 0; n < all.count(); ++n) forward.push_back(all.values(n, {}));
    for (std::size_t n = again.count(); n-- > 0;) {
      EXPECT_EQ(again.values(n, {}), forward[n]) << n;
      EXPECT_EQ(again.seed_of(n), all.seed_of(n)) << n;
    }
  }
}

TEST(StudyDesign, LatinHypercubeMeetsEveryStratumOnce) {
  StudyDesign design = mixed(true);
  design.distributions.erase(design.distributions.begin(), design.distributions.begin() + 2);
  design.runs = 400;
  const StudyRuns runs(design);
  std::vector<double> uniform = column(runs, StudyFactor::angle_head_deg);
  std::vector<double> normal = column(runs, StudyFactor::entry_left_mm);
  // Strata are of equal probability: Φ of the value tells which.
  const auto strata = [](const std::vector<double>& values, const auto& probability) {
    std::set<int> met;
    for (const double value : values) met.insert(static_cast<int>(400.0 * probability(value)));
    return met.size();
  };
  EXPECT_EQ(strata(uniform, [](double value) { return (value + 3.0) / 8.0; }), 400U);
  EXPECT_EQ(strata(normal, [](double value) { return 0.5 * std::erfc(-(value - 0.5) / (2.0 * std::sqrt(2.0))); }),
            400U);
  // The factors are shuffled apart: 400 pairs of independent numbers correlate by 0.05 (one deviation).
  double sum = 0.0;
  for (std::size_t n = 0; n < 400; ++n) sum += (uniform[n] - 1.0) / (8.0 / std::sqrt(12.0)) * (normal[n] - 0.5) / 2.0;
  EXPECT_LT(std::abs(sum / 400.0), 0.2);
  // They do not come in order.
  EXPECT_FALSE(std::is_sorted(uniform.begin(), uniform.end()));
}

TEST(StudyDesign, DrawsTheMomentsAskedFor) {
  for (const bool is_latin : {false, true}) {
    StudyDesign design = mixed(is_latin);
    design.runs = 20000 / 6;
    const StudyRuns runs(design);
    const auto n = static_cast<double>(runs.count());
    const std::vector<double> normal = column(runs, StudyFactor::entry_left_mm);
    double mean = 0.0, square = 0.0, cube = 0.0, fourth = 0.0;
    for (const double value : normal) mean += value / n;
    for (const double value : normal) {
      const double z = (value - mean) / 2.0;
      square += z * z / n;
      cube += z * z * z / n;
      fourth += z * z * z * z / n;
    }
    // Five times the standard errors of independent draws: 1, sqrt 2, sqrt 6 and sqrt 24 over sqrt n, as z is taken.
    const double error = 5.0 / std::sqrt(n);
    EXPECT_NEAR(mean, 0.5, 2.0 * error);
    EXPECT_NEAR(square, 1.0, 1.42 * error);
    EXPECT_NEAR(cube, 0.0, 3.9 * error);
    EXPECT_NEAR(fourth, 3.0, 9.8 * error);
    const std::vector<double> uniform = column(runs, StudyFactor::angle_head_deg);
    double middle = 0.0;
    for (const double value : uniform) middle += value / n;
    EXPECT_NEAR(middle, 1.0, 8.0 / std::sqrt(12.0) * error);
    EXPECT_GE(*std::min_element(uniform.begin(), uniform.end()), -3.0);
    EXPECT_LE(*std::max_element(uniform.begin(), uniform.end()), 5.0);
  }
}

TEST(StudyDesign, DrawsOtherNumbersFromAnotherSeedAndForAnotherFactor) {
  StudyDesign design = mixed(false);
  const std::vector<double> first = column(StudyRuns(design), StudyFactor::entry_left_mm);
  const std::uint64_t tremor = StudyRuns(design).seed_of(3);
  design.seed = 8;
  EXPECT_NE(column(StudyRuns(design), StudyFactor::entry_left_mm), first);
  EXPECT_NE(StudyRuns(design).seed_of(3), tremor);
  design.seed = 7;
  design.distributions[2].factor = StudyFactor::entry_head_mm;
  EXPECT_NE(column(StudyRuns(design), StudyFactor::entry_head_mm), first);
}

TEST(StudyDesign, RejectsWhatMakesNoSense) {
  const auto rejects = [](const auto& change, const char* words) {
    StudyDesign design = mixed(false);
    change(design);
    EXPECT_THAT([&] { StudyRuns{design}; }, ThrowsMessage<Error>(HasSubstr(words))) << words;
  };
  rejects([](StudyDesign& d) { d.distributions[1].factor = d.distributions[0].factor; }, "bit_diameter_mm twice");
  rejects([](StudyDesign& d) { d.distributions[0].levels.clear(); }, "bit_diameter_mm: expected one level");
  rejects([](StudyDesign& d) { d.distributions[0].levels[1] = kNan; }, "bit_diameter_mm: expected finite");
  rejects([](StudyDesign& d) { d.distributions[2].b = -1.0; }, "entry_left_mm");
  rejects([](StudyDesign& d) { d.distributions[2].a = kNan; }, "entry_left_mm");
  rejects([](StudyDesign& d) { d.distributions[3].b = -4.0; }, "angle_head_deg");
  rejects([](StudyDesign& d) { d.distributions[3].b = kNan; }, "angle_head_deg");
  rejects([](StudyDesign& d) { d.distributions[2].b = 5e-324; }, "entry_left_mm");  // a report of it did not end
  rejects([](StudyDesign& d) { d.distributions[2].a = 1e300; }, "entry_left_mm");
  rejects([](StudyDesign& d) { d.distributions[3].b = std::nextafter(d.distributions[3].a, 1e3); }, "angle_head_deg");
  rejects([](StudyDesign& d) { d.distributions[0].levels = {0.0, 5e-324}; }, "bit_diameter_mm: expected levels within");
  rejects([](StudyDesign& d) { d.runs = 0; }, "none");
  rejects([](StudyDesign& d) { d.runs = StudyRuns::kMaxRuns; }, "more");
  rejects([](StudyDesign& d) { d.runs = std::numeric_limits<std::size_t>::max(); }, "more");
}

/// Two screws of one patient and one of another.
StudyGround three_screws() { return {.patients = {0, 0, 1}, .has_errors = true, .has_registration = true}; }

TEST(StudyDesign, GivesEachScrewAsManyRunsAndPatientsWhatTheyHaveInCommon) {
  StudyDesign design;
  design.runs = 40;
  design.distributions = {
      {.factor = StudyFactor::density_scale, .kind = Kind::uniform, .a = 0.6, .b = 1.0, .per = DrawnPer::patient},
      {.factor = StudyFactor::bit_diameter_mm, .kind = Kind::uniform, .a = 2.0, .b = 4.0, .per = DrawnPer::screw},
      {.factor = StudyFactor::entry_left_mm, .kind = Kind::normal, .a = 0.0, .b = 1.0}};
  StudyGround ground = three_screws();
  ground.registration_per = DrawnPer::patient;
  const StudyRuns runs(design, ground);
  ASSERT_EQ(runs.count(), 120U);
  std::map<std::size_t, std::set<double>> densities, diameters;
  std::map<std::size_t, std::set<std::array<double, 6>>> registrations;
  std::set<double> entries;
  std::set<std::array<double, 6>> placements;
  for (std::size_t n = 0; n < runs.count(); ++n) {
    EXPECT_EQ(runs.screw_of(n), n / 40);
    const FactorValues values = runs.values(n, {});
    densities[runs.patient_of(n)].insert(of(values, StudyFactor::density_scale));
    diameters[runs.screw_of(n)].insert(of(values, StudyFactor::bit_diameter_mm));
    registrations[runs.patient_of(n)].insert(runs.registration_normals(n));
    entries.insert(of(values, StudyFactor::entry_left_mm));
    placements.insert(runs.placement_normals(n));
  }
  ASSERT_EQ(densities.size(), 2U);
  for (const auto& [patient, met] : densities) EXPECT_EQ(met.size(), 1U);
  EXPECT_NE(densities[0], densities[1]);
  ASSERT_EQ(diameters.size(), 3U);
  for (const auto& [screw, met] : diameters) EXPECT_EQ(met.size(), 1U);
  EXPECT_NE(diameters[0], diameters[1]);
  for (const auto& [patient, met] : registrations) EXPECT_EQ(met.size(), 1U);
  EXPECT_NE(registrations[0], registrations[1]);
  EXPECT_EQ(entries.size(), 120U);
  EXPECT_EQ(placements.size(), 120U);
}

TEST(StudyDesign, OfSaltelliTakesOneInputOfAnotherDrawAtATime) {
  StudyDesign design;
  design.runs = 50;
  design.sampling = StudySampling::saltelli;
  design.distributions = {{.factor = StudyFactor::density_scale, .kind = Kind::uniform, .a = 0.6, .b = 1.0},
                          {.factor = StudyFactor::entry_left_mm, .kind = Kind::normal, .a = 0.0, .b = 1.0}};
  const StudyRuns runs(design, three_screws());
  const std::vector<std::string> inputs{"density_scale", "entry_left_mm", "entry", "direction",
                                        "along",         "registration",  "screw"};
  ASSERT_EQ(runs.inputs(), inputs);
  ASSERT_EQ(runs.count(), 50U * 9U);
  // What each input is of, run by run.
  const auto seen = [&](std::size_t n) {
    const FactorValues values = runs.values(n, {});
    const std::array<double, 6> placement = runs.placement_normals(n);
    return std::array<std::vector<double>, 7>{{{of(values, StudyFactor::density_scale)},
                                               {of(values, StudyFactor::entry_left_mm)},
                                               {placement[0], placement[1]},
                                               {placement[2], placement[3]},
                                               {placement[4], placement[5]},
                                               {runs.registration_normals(n)[0], runs.registration_normals(n)[5]},
                                               {static_cast<double>(runs.screw_of(n))}}};
  };
  std::set<std::size_t> screws;
  for (std::size_t block = 0; block < 50; ++block) {
    const auto a = seen(9 * block), b = seen(9 * block + 1);
    for (std::size_t k = 0; k + 1 < inputs.size(); ++k) EXPECT_NE(a[k], b[k]) << inputs[k];
    for (std::size_t k = 0; k < inputs.size(); ++k) {
      const auto mixed_run = seen(9 * block + 2 + k);
      for (std::size_t other = 0; other < inputs.size(); ++other) {
        EXPECT_EQ(mixed_run[other], other == k ? b[other] : a[other]) << inputs[k] << ", " << inputs[other];
      }
      EXPECT_EQ(runs.seed_of(9 * block), runs.seed_of(9 * block + 2 + k));
    }
    screws.insert(runs.screw_of(9 * block));
  }
  EXPECT_EQ(screws.size(), 3U);
}

TEST(StudyDesign, RejectsDesignsThatDoNotFitTheirSampling) {
  const auto rejects = [](StudyDesign design, const StudyGround& ground, const char* words) {
    EXPECT_THAT([&] { StudyRuns(std::move(design), ground); }, ThrowsMessage<Error>(HasSubstr(words))) << words;
  };
  const FactorDistribution levels{StudyFactor::bit_diameter_mm, Kind::levels, {3.0, 4.0}};
  FactorDistribution of_patients{.factor = StudyFactor::density_scale, .kind = Kind::uniform, .a = 0.6, .b = 1.0};
  of_patients.per = DrawnPer::patient;
  rejects({{levels}, 10, StudySampling::saltelli}, {}, "found levels");
  rejects({{}, 10, StudySampling::saltelli}, {}, "found nothing");
  rejects({{of_patients}, 10, StudySampling::latin_hypercube}, {}, "\"per\": \"patient\"");
  rejects({{}, 10}, {.patients = {}}, "found none");
  rejects({{}, StudyRuns::kMaxRuns / 2}, three_screws(), "more");
}

}  // namespace
}  // namespace spinaltap
