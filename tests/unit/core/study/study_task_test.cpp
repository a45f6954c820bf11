#include "core/study/study_task.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"

namespace spinaltap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;
using Kind = FactorDistribution::Kind;

/// A path to the front, as through a pedicle.
StudySpec spec_of(std::vector<FactorDistribution> distributions) {
  StudySpec spec;
  spec.bones = {{.paths = {{"left", Vec3(20, 30, 5), Vec3(20, -10, 5), {3.0, 60.0, 2.0, BitShape::drill, 0.5}}}}};
  spec.design.distributions = std::move(distributions);
  return spec;
}

StudyTask only_task(const StudySpec& spec) { return study_task(spec, StudyRuns(spec.design), 0); }

TEST(StudyTask, IsThePlannedPathWithoutErrors) {
  const StudySpec spec = spec_of({});
  const StudyTask task = only_task(spec);
  EXPECT_EQ(task.path.entry_mm, spec.bones[0].paths[0].entry_mm);
  EXPECT_LT((task.path.target_mm - spec.bones[0].paths[0].target_mm).norm(), 1e-12);
  EXPECT_EQ(task.path.bit.diameter_mm, 3.0);
  EXPECT_EQ(task.material.density.per_hu, spec.material.density.per_hu);
}

TEST(StudyTask, SidesAreThePatientsLeftAndHead) {
  for (const Vec3& direction : {Vec3(0, -1, 0), Vec3(0, 1, 0), Vec3(-0.4, -1, 0.3), Vec3(0.5, -0.2, 1.0)}) {
    DrillPath path = spec_of({}).bones[0].paths[0];
    path.target_mm = path.entry_mm + 40.0 * direction.normalized();
    const AcrossPath sides = across(path);
    EXPECT_GT(sides.left.x(), 0.0);
    EXPECT_GT(sides.head.z(), 0.0);
    EXPECT_NEAR(sides.left.norm(), 1.0, 1e-12);
    EXPECT_NEAR(sides.head.norm(), 1.0, 1e-12);
    EXPECT_NEAR(sides.left.dot(path.direction()), 0.0, 1e-12);
    EXPECT_NEAR(sides.head.dot(path.direction()), 0.0, 1e-12);
    EXPECT_NEAR(sides.left.dot(sides.head), 0.0, 1e-12);
  }
  DrillPath down = spec_of({}).bones[0].paths[0];
  down.target_mm = down.entry_mm - Vec3(0, 0, 30);
  EXPECT_GT(across(down).head.y(), 0.9);
}

TEST(StudyTask, IsOfToolsThatTurn) {
  StudySpec spec = spec_of({});
  spec.bones[0].paths[0].bit = plate_bit(10.0, 1.0, 60.0);
  EXPECT_THAT([&] { only_task(spec); }, ThrowsMessage<Error>(HasSubstr("a study, found a plate")));
}

TEST(StudyTask, ShiftsTheEntryAndLeansAboutIt) {
  const StudyTask task = only_task(spec_of({{StudyFactor::entry_left_mm, Kind::levels, {1.5}},
                                            {StudyFactor::entry_head_mm, Kind::levels, {-0.5}},
                                            {StudyFactor::angle_head_deg, Kind::levels, {4.0}}}));
  EXPECT_LT((task.path.entry_mm - Vec3(21.5, 30.0, 4.5)).norm(), 1e-12);
  EXPECT_NEAR(task.path.length_mm(), 40.0, 1e-12);
  const Vec3 direction = task.path.direction();
  EXPECT_NEAR(std::asin(direction.z()) * 180.0 / std::numbers::pi, 4.0, 1e-9);
  EXPECT_NEAR(direction.x(), 0.0, 1e-12);
  const Vec3 to_left = only_task(spec_of({{StudyFactor::angle_left_deg, Kind::levels, {10.0}}})).path.direction();
  EXPECT_NEAR(std::asin(to_left.x()) * 180.0 / std::numbers::pi, 10.0, 1e-9);
}

TEST(StudyTask, AWiderDrillKeepsItsPointAngle) {
  const StudyTask task = only_task(spec_of({{StudyFactor::bit_diameter_mm, Kind::levels, {4.5}}}));
  EXPECT_EQ(task.path.bit.diameter_mm, 4.5);
  EXPECT_NEAR(task.path.bit.tip_length_mm / task.path.bit.diameter_mm, 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(task.path.bit.tip_diameter_mm, 0.75, 1e-12);
  EXPECT_EQ(task.path.bit.length_mm, 60.0);
}

TEST(StudyTask, AWiderProfileIsTheSameToolInAnotherSize) {
  StudySpec spec = spec_of({{StudyFactor::bit_diameter_mm, Kind::levels, {4.5}}});
  spec.bones[0].paths[0].bit = profile_bit({{0.0, 0.0}, {1.5, 1.5, true}, {4.0, 1.5}, {5.0, 1.0}, {60.0, 1.0}});
  EXPECT_EQ(only_task(spec).path.bit, resized(spec.bones[0].paths[0].bit, 4.5, 60.0));
  spec = spec_of({});
  spec.bones[0].paths[0].bit = profile_bit({{0.0, 0.0}, {1.5, 1.5, true}, {4.0, 1.5}, {5.0, 1.0}, {60.0, 1.0}});
  EXPECT_EQ(only_task(spec).path.bit, spec.bones[0].paths[0].bit);
}

TEST(StudyTask, ScalesTheDensityBeforeTheModel) {
  const StudySpec spec = spec_of({{StudyFactor::density_scale, Kind::levels, {0.6}}});
  const StudyTask task = only_task(spec);
  for (const double hu : {0.0, 300.0, 1500.0}) {
    EXPECT_NEAR(task.material.density.density_g_cm3(hu), 0.6 * spec.material.density.density_g_cm3(hu), 1e-12);
    // The cutting model is a power of the density.
    EXPECT_NEAR(task.material.cutting_energy_mpa(hu) / spec.material.cutting_energy_mpa(hu),
                std::pow(0.6, spec.material.cutting_exponent), 1e-9);
  }
}

TEST(StudyTask, ScalesTheForcesOfTheModel) {
  const StudySpec spec = spec_of({{StudyFactor::force_scale, Kind::levels, {0.4}}});
  const StudyTask task = only_task(spec);
  for (const double hu : {300.0, 1500.0}) {
    EXPECT_NEAR(task.material.cutting_energy_mpa(hu), 0.4 * spec.material.cutting_energy_mpa(hu), 1e-9);
    EXPECT_NEAR(task.material.chisel_pressure_mpa(hu), 0.4 * spec.material.chisel_pressure_mpa(hu), 1e-9);
  }
  EXPECT_EQ(task.material.density.per_hu, spec.material.density.per_hu);
}

TEST(StudyTask, DrawsTheForcesFromTheSpreadBetweenSources) {
  const ForceSpread spread{0.5, 0.8, 9.0};
  StudySpec spec = spec_of({{StudyFactor::force_scale, Kind::spread, {}, spread.median, spread.log_scale, 9}});
  spec.design.runs = 1001;
  spec.design.sampling = StudySampling::latin_hypercube;
  const StudyRuns runs(spec.design);
  std::vector<double> drawn;
  for (std::size_t n = 0; n < runs.count(); ++n) {
    drawn.push_back(
        runs.values(n, base_values(spec, spec.bones[0].paths[0]))[static_cast<std::size_t>(StudyFactor::force_scale)]);
  }
  std::sort(drawn.begin(), drawn.end());
  EXPECT_NEAR(drawn[500], spread.median, 0.01 * spread.median);
  // Student's t of 9 degrees: 1.833113 at 95 %, which is 95.45 % of what lies between 0.5 % and 99.5 %.
  EXPECT_NEAR(drawn[955], 0.5 * std::exp(0.8 * 1.833113), 0.01 * drawn[955]);
  EXPECT_LT(drawn.back(), 0.5 * std::exp(0.8 * 3.2499));  // 99.5 %
  EXPECT_GT(drawn.front(), 0.5 * std::exp(-0.8 * 3.2499));
  for (const double bad : {0.0, -1.0}) {
    spec.design.distributions[0].a = bad;
    EXPECT_THROW(StudyRuns{spec.design}, Error);
  }
}

TEST(StudyTask, CylinderHoldsTheWidestRunAndNoMore) {
  StudySpec spec = spec_of({{StudyFactor::entry_left_mm, Kind::levels, {-2.0, 1.0}},
                            {StudyFactor::bit_diameter_mm, Kind::levels, {3.0, 4.0}}});
  spec.volume.lead_in_mm = 3.0;
  EXPECT_NEAR(radius_of_all_runs_mm(spec, StudyRuns(spec.design), 5.0), 2.0 + 2.0 + 0.2, 1e-9);
  // 5 degrees about the entry, over 40 mm and 5 mm more; the section of the leaning bit is an ellipse.
  spec = spec_of({{StudyFactor::angle_left_deg, Kind::levels, {5.0}}});
  const double lean = 5.0 * std::numbers::pi / 180.0;
  EXPECT_NEAR(radius_of_all_runs_mm(spec, StudyRuns(spec.design), 5.0),
              45.0 * std::tan(lean) + 1.5 / std::cos(lean) + 0.2, 1e-9);
}

TEST(StudyTask, IsMovedByTheRegistrationsErrorAsItsCovarianceSays) {
  constexpr std::size_t kRuns = 4000;
  StudySpec spec = spec_of({});
  spec.design.runs = kRuns;
  PoseCovariance covariance;
  covariance.centre_mm = Vec3(20, 10, 5);
  covariance.turn_rad2 = Vec3(1e-4, 4e-4, 2.25e-4).asDiagonal();
  covariance.shift_mm2 = Vec3(0.25, 0.09, 1.0).asDiagonal();
  spec.registration = StudyRegistration{covariance, DrawnPer::run};
  const StudyRuns runs(spec.design);
  Mat3 scatter = Mat3::Zero();
  for (std::size_t n = 0; n < kRuns; ++n) {
    const DrillPath path = study_task(spec, runs, n).path;
    EXPECT_NEAR(path.length_mm(), spec.bones[0].paths[0].length_mm(), 1e-9);
    const Vec3 error_mm = path.target_mm - spec.bones[0].paths[0].target_mm;
    scatter += error_mm * error_mm.transpose() / kRuns;
  }
  const Mat3 known = target_covariance_mm2(covariance, spec.bones[0].paths[0].target_mm);
  // A variance of 4,000 normal numbers scatters by 2.2 %; the turn's second order adds less.
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(scatter(axis, axis) / known(axis, axis), 1.0, 0.1) << axis;

  spec.registration->per = DrawnPer::patient;
  const StudyRuns of_one(spec.design, ground_of(spec));
  const DrillPath first = study_task(spec, of_one, 0).path, other = study_task(spec, of_one, 77).path;
  EXPECT_NE(first.entry_mm, spec.bones[0].paths[0].entry_mm);
  EXPECT_EQ(first.entry_mm, other.entry_mm);
  EXPECT_EQ(first.target_mm, other.target_mm);
}

TEST(StudyTask, NamesTheRunAndTheFactorThatMakeNoSense) {
  const auto rejects = [](StudyFactor factor, double level, StudyOperator::Kind kind = StudyOperator::Kind::feed) {
    StudySpec spec = spec_of({{factor, Kind::levels, {1.0, level}}});
    spec.tool_operator.kind = kind;
    EXPECT_THAT([&] { radius_of_all_runs_mm(spec, StudyRuns(spec.design), 0.0); },
                ThrowsMessage<Error>(AllOf(HasSubstr("run 1 "), HasSubstr(std::string(name_of(factor))))));
  };
  rejects(StudyFactor::angle_left_deg, 80.0);
  rejects(StudyFactor::angle_head_deg, -80.0);
  rejects(StudyFactor::bit_diameter_mm, 0.0);
  rejects(StudyFactor::feed_mm_s, -1.0);
  rejects(StudyFactor::push_n, 0.0, StudyOperator::Kind::push);
  rejects(StudyFactor::tremor_mm, -0.1);
  rejects(StudyFactor::density_scale, 0.0);
  rejects(StudyFactor::force_scale, 0.0);
}

TEST(StudyTask, ErrsAsItsModelOfPlacementSaysInTheVertebrasFrame) {
  StudySpec spec = spec_of({{StudyFactor::entry_error_scale, Kind::levels, {1.0, 2.0}},
                            {StudyFactor::direction_error_scale, Kind::levels, {1.0, 0.5}}});
  spec.errors.emplace();
  spec.errors->measured = {{1.5, -0.5, 2.0, 3.0, -4.0}};
  EXPECT_THROW(study_task(spec, StudyRuns(spec.design, ground_of(spec)), 0), Error) << "frames are not known";
  // Medial is the patient's right, cranial the head, along the path forwards.
  spec.bones[0].frames = {{-Vec3::UnitX(), Vec3::UnitZ(), -Vec3::UnitY()}};
  const StudyRuns runs(spec.design, ground_of(spec));
  ASSERT_EQ(runs.count(), 4U);
  for (std::size_t n = 0; n < 4; ++n) {
    const StudyTask task = study_task(spec, runs, n);
    const double entry = n % 2 == 0 ? 1.0 : 2.0, turn = n < 2 ? 1.0 : 0.5;
    const DrillPath& planned = spec.bones[0].paths[0];
    EXPECT_LT((task.path.entry_mm - planned.entry_mm - Vec3(-1.5 * entry, -2.0, -0.5 * entry)).norm(), 1e-12) << n;
    const double lean = std::acos(task.path.direction().dot(planned.direction())) * 180.0 / std::numbers::pi;
    EXPECT_NEAR(lean, 5.0 * turn, 1e-9) << n;
    EXPECT_LT(task.path.direction().x(), 0.0);
    EXPECT_LT(task.path.direction().z(), 0.0);
    EXPECT_EQ(task.error.medial_mm, 1.5 * entry);
    EXPECT_EQ(task.error.cranial_deg, -4.0 * turn);
  }
}

}  // namespace
}  // namespace spinaltap
