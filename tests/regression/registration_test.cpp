// Registration by touched points against known poses, on bones whose surface is known apart from the grid that is
// registered to: the phantom's formula, real vertebrae's meshes. See tests/support/test_data.h for where those lie.
//
// The method was tuned on those bones that are not marked unseen; the others were read when it was done.

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "core/base/random.h"
#include "core/phantom/vertebra.h"
#include "core/registration/register_surface.h"
#include "tests/support/real_meshes.h"
#include "tests/support/test_kind.h"
#include "vdb/bake/bake.h"
#include "vdb/grid/mesh_solid.h"
#include "vdb/sim/bone.h"

namespace spinaltap {
namespace {

constexpr double kNoiseMm = 0.3;  ///< of a touched point, to each side
constexpr std::size_t kTouched = 40;
constexpr double kRightMm = 2.0;  ///< at both pedicles: nearer is the right place

struct RegisteredBone {
  const char* name;
  const char* file;  ///< nullptr: the phantom
  const char* axes;
  bool unseen;
};

std::vector<RegisteredBone> registered_bones() {
  return {{"phantom", nullptr, "", false},
          {"L1 of 013", "L1_meshes/sub-verse013_segment_20.ply", "LPS", false},
          {"L1 of 018", "L1_meshes/sub-verse018_segment_20.ply", "LPS", false},
          {"L1 of 022", "L1_meshes/sub-verse022_segment_20.ply", "LPS", false},
          {"L1 of 010", "L1_meshes/sub-verse010_segment_20.ply", "LPS", true},
          {"L1 of 016", "L1_meshes/sub-verse016_segment_20.ply", "LPS", true},
          {"L2 of VHM", "lumbar_meshes/L2_vhm_mm.stl", "ALS", true},
          {"L3 of VHM", "L3_mesh/L3_vhm_remus_mm.stl", "ALS", true},
          {"L4 of VHM", "lumbar_meshes/L4_vhm_mm.stl", "ALS", true},
          {"L5 of VHM", "lumbar_meshes/L5_vhm_mm.stl", "ALS", true}};
}

/// A stream of random numbers of its own.
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : seed_(seed) {}
  double uniform() { return random_uniform(seed_, n_++); }
  double normal() { return random_normal(seed_, n_++); }
  Vec3 normals() {
    const double x = normal(), y = normal(), z = normal();
    return Vec3(x, y, z);
  }
  /// In a ball, evenly.
  Vec3 in_ball(double radius) { return radius * std::cbrt(uniform()) * normals().normalized(); }

 private:
  std::uint64_t seed_, n_ = 0;
};

class RegistrationBench {
 public:
  explicit RegistrationBench(const RegisteredBone& which) {
    std::unique_ptr<Solid> solid;
    if (which.file == nullptr) {
      solid = std::make_unique<Vertebra>();
    } else {
      mesh_ = turn_axes(read_mesh(test::test_data_folder() / which.file), which.axes);
      solid = make_mesh_solid(mesh_, {.voxel_mm = 0.25});
    }
    bone_ = std::make_unique<Bone>(bake_solid(*solid, {}, 40.0));
    if (which.file == nullptr) {
      // The grid's triangles, moved onto the formula's own zero set.
      mesh_ = bone_->surface();
      for (int round = 0; round < 3; ++round) {
        for (Eigen::Vector3f& vertex : mesh_.vertices_mm) {
          const Vec3 p_mm = vertex.cast<double>();
          double value_mm = 0.0;
          Vec3 gradient = Vec3::Zero();
          solid->evaluate({&p_mm, 1}, {&value_mm, 1}, {&gradient, 1});
          vertex = Vec3(p_mm - value_mm / gradient.squaredNorm() * gradient).cast<float>();
        }
      }
    }
    find_exposed();
  }

  const Bone& bone() const { return *bone_; }
  Vec3 pedicle_mm(bool left) const {
    const Landmarks& marks = bone_->landmarks();
    return left ? marks.left_pedicle.isthmus_mm : marks.right_pedicle.isthmus_mm;
  }

  /// Places of the bone's own surface that a surgeon reaches from behind, evenly over their area. Within `within_mm` of
  /// one of them, where that is given.
  std::vector<Vec3> places_mm(Draws& draws, std::size_t count, double within_mm = 0.0) const {
    std::vector<Vec3> places;
    Vec3 middle_mm = Vec3::Zero();
    while (places.size() < count) {
      const double share = draws.uniform() * areas_.back();
      const auto found = std::lower_bound(areas_.begin(), areas_.end(), share);
      const auto& triangle = exposed_[static_cast<std::size_t>(found - areas_.begin())];
      double u = draws.uniform(), v = draws.uniform();
      if (u + v > 1.0) {
        u = 1.0 - u;
        v = 1.0 - v;
      }
      const Vec3 p_mm = triangle[0] + u * (triangle[1] - triangle[0]) + v * (triangle[2] - triangle[0]);
      if (places.empty()) middle_mm = p_mm;
      if (within_mm > 0.0 && (p_mm - middle_mm).norm() > within_mm) continue;
      places.push_back(p_mm);
    }
    return places;
  }

 private:
  /// Faces towards the back, behind the canal's middle, with no bone behind them.
  void find_exposed() {
    const Landmarks& marks = bone_->landmarks();
    double area_mm2 = 0.0;
    for (const auto& triangle : mesh_.triangles) {
      std::array<Vec3, 3> corners;
      for (std::size_t n = 0; n < 3; ++n) corners[n] = mesh_.vertices_mm[triangle[n]].cast<double>();
      const Vec3 across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
      const Vec3 middle_mm = (corners[0] + corners[1] + corners[2]) / 3.0;
      if (!(across.norm() > 0.0) || across.normalized().dot(marks.posterior()) < 0.3) continue;
      if (marks.to_own(middle_mm).y() < 0.0) continue;
      bool hidden = false;
      for (double way_mm = 1.5; way_mm < 60.0 && !hidden; way_mm += 0.75) {
        hidden = bone_->shape().lattice_mm(middle_mm + way_mm * marks.posterior()) < 0.0;
      }
      if (hidden) continue;
      area_mm2 += 0.5 * across.norm();
      exposed_.push_back(corners);
      areas_.push_back(area_mm2);
    }
  }

  TriangleMesh mesh_;
  std::unique_ptr<Bone> bone_;
  std::vector<std::array<Vec3, 3>> exposed_;
  std::vector<double> areas_;
};

/// Touched points as a tracker gives them: with noise, and in a frame of its own.
std::vector<Vec3> touched_of(const std::vector<Vec3>& places_mm, const RigidPose& ct_from_patient, Draws& draws) {
  const RigidPose patient_from_ct = ct_from_patient.inverse();
  std::vector<Vec3> touched;
  for (const Vec3& p_mm : places_mm) touched.push_back(patient_from_ct.apply(p_mm + kNoiseMm * draws.normals()));
  return touched;
}

RigidPose any_pose(Draws& draws) {
  const Vec3 turn = draws.in_ball(3.0);
  return small_motion(turn, draws.in_ball(300.0), Vec3(20.0, -30.0, 10.0));
}

/// A start that is off by so much, about the touched places' middle.
RigidPose off_by(const RigidPose& pose, const std::vector<Vec3>& places_mm, Draws& draws, double shift_mm, double deg) {
  Vec3 middle_mm = Vec3::Zero();
  for (const Vec3& p_mm : places_mm) middle_mm += p_mm / static_cast<double>(places_mm.size());
  const Vec3 shift = draws.in_ball(shift_mm);
  return small_motion(draws.in_ball(deg * kDegree), shift, middle_mm).after(pose);
}

class RegistrationOfBones : public testing::TestWithParam<std::size_t> {
 protected:
  static std::unique_ptr<RegistrationBench> bench() {
    return std::make_unique<RegistrationBench>(registered_bones()[GetParam()]);
  }
  static const char* name() { return registered_bones()[GetParam()].name; }
};

#define SPINALTAP_NEED_REGISTERED_BONE()                                \
  if (registered_bones()[GetParam()].file != nullptr) {                 \
    SPINALTAP_NEED_TEST_DATA(file, registered_bones()[GetParam()].file) \
  }

WHOLE_RUNS("RegistrationOfBones.*");

TEST_P(RegistrationOfBones, PredictTheErrorAtThePediclesOf1000Trials) {
  SPINALTAP_NEED_REGISTERED_BONE()
  const auto made = bench();
  constexpr std::size_t kTrials = 1000;
  constexpr double kWithin = 0.2;
  for (const std::uint64_t seed : {101U, 102U, 103U}) {
    Draws design(seed);
    const std::vector<Vec3> places_mm = made->places_mm(design, kTouched);
    struct Trial {
      std::array<Vec3, 2> error_mm;
      std::array<double, 2> predicted_mm;      ///< with the noise told
      std::array<double, 2> predicted_own_mm;  ///< from the residuals
      std::array<Mat3, 2> covariance_mm2;
    };
    std::vector<Trial> trials(kTrials);
    tbb::parallel_for(std::size_t{0}, kTrials, [&](std::size_t n) {
      Draws draws(mix_bits(1000 * seed + n));
      const RigidPose truth = any_pose(draws);
      const std::vector<Vec3> touched = touched_of(places_mm, truth, draws);
      TouchedOptions options;
      options.start = off_by(truth, places_mm, draws, 1.0, 1.0);
      options.starts = 1;
      options.noise_mm = kNoiseMm;
      const Registration told = register_surface(made->bone().shape(), touched, options);
      options.noise_mm = 0.0;
      const Registration own = register_surface(made->bone().shape(), touched, options);
      for (const std::size_t side : {0U, 1U}) {
        const Vec3 pedicle_mm = made->pedicle_mm(side == 0);
        trials[n].error_mm[side] = told.ct_from_patient.apply(truth.inverse().apply(pedicle_mm)) - pedicle_mm;
        trials[n].predicted_mm[side] = target_error_mm(told.covariance, pedicle_mm);
        trials[n].predicted_own_mm[side] = target_error_mm(own.covariance, pedicle_mm);
        trials[n].covariance_mm2[side] = target_covariance_mm2(told.covariance, pedicle_mm);
      }
    });
    for (const std::size_t side : {0U, 1U}) {
      const PedicleLandmarks& pedicle =
          side == 0 ? made->bone().landmarks().left_pedicle : made->bone().landmarks().right_pedicle;
      double squares = 0.0;
      std::vector<double> own;
      for (const Trial& trial : trials) {
        squares += trial.error_mm[side].squaredNorm() / kTrials;
        own.push_back(trial.predicted_own_mm[side]);
      }
      const double measured_mm = std::sqrt(squares);
      std::sort(own.begin(), own.end());
      const auto near = static_cast<double>(std::count_if(
          own.begin(), own.end(), [&](double mm) { return std::abs(mm / measured_mm - 1.0) <= kWithin; }));
      // What the first trial says: whoever registers has one.
      const double predicted_mm = trials[0].predicted_mm[side];
      std::printf(
          "%s, places %d, %s pedicle: predicted %.3f mm (from residuals, median of trials: %.3f; %.0f %% of trials "
          "within 20 %%), measured %.3f mm;",
          name(), static_cast<int>(seed), side == 0 ? "left" : "right", predicted_mm, own[kTrials / 2],
          100.0 * near / kTrials, measured_mm);
      EXPECT_NEAR(predicted_mm / measured_mm, 1.0, kWithin) << seed << " " << side;
      EXPECT_NEAR(own[kTrials / 2] / measured_mm, 1.0, kWithin) << seed << " " << side;
      for (const Vec3& direction : {pedicle.axis, pedicle.width_axis, pedicle.height_axis}) {
        double along = 0.0;
        for (const Trial& trial : trials) along += std::pow(trial.error_mm[side].dot(direction), 2) / kTrials;
        const double predicted_along_mm = std::sqrt(direction.dot(trials[0].covariance_mm2[side] * direction));
        std::printf(" %.3f / %.3f", predicted_along_mm, std::sqrt(along));
        EXPECT_NEAR(predicted_along_mm / std::sqrt(along), 1.0, kWithin) << seed << " " << side;
      }
      std::printf("\n");
    }
  }
}

/// At the pedicle that is further off.
double worst_error_mm(const RegistrationBench& bench, const Registration& found, const RigidPose& truth) {
  double error_mm = 0.0;
  for (const bool left : {true, false}) {
    const Vec3 pedicle_mm = bench.pedicle_mm(left);
    error_mm = std::max(error_mm, (found.ct_from_patient.apply(truth.inverse().apply(pedicle_mm)) - pedicle_mm).norm());
  }
  return error_mm;
}

TEST_P(RegistrationOfBones, EndInTheRightPlaceFrom500StartsOrSayThatTheyDoNot) {
  SPINALTAP_NEED_REGISTERED_BONE()
  const auto made = bench();
  constexpr std::size_t kStarts = 500;
  int right = 0, told = 0, silent = 0, false_alarms = 0;
  for (std::size_t n = 0; n < kStarts; ++n) {
    Draws draws(mix_bits(900'000 + n));
    const std::vector<Vec3> places_mm = made->places_mm(draws, kTouched);
    const RigidPose truth = any_pose(draws);
    const std::vector<Vec3> touched = touched_of(places_mm, truth, draws);
    TouchedOptions options;
    options.start = off_by(truth, places_mm, draws, 20.0, 20.0);
    options.noise_mm = kNoiseMm;
    const Registration found = register_surface(made->bone().shape(), touched, options);
    const double error_mm = worst_error_mm(*made, found, truth);
    const bool is_right = error_mm < kRightMm;
    right += is_right ? 1 : 0;
    told += !is_right && !found.warnings.empty() ? 1 : 0;
    silent += !is_right && found.warnings.empty() ? 1 : 0;
    false_alarms += is_right && !found.warnings.empty() ? 1 : 0;
    if (!is_right || !found.warnings.empty()) {
      std::printf("  start %d: %.2f mm, %s\n", static_cast<int>(n), error_mm,
                  found.warnings.empty() ? "silent" : found.warnings.front().c_str());
    }
  }
  std::printf("%s: of %d starts %d right, %d wrong and told, %d wrong and silent; %d right with a warning\n", name(),
              static_cast<int>(kStarts), right, told, silent, false_alarms);
  EXPECT_GE(right, 490);
  EXPECT_EQ(silent, 0);
  EXPECT_LE(false_alarms, 25);
}

// Points of one small patch hold no pose: whoever is further off than 3 mm then must be told.
TEST_P(RegistrationOfBones, SayWhereTouchedPointsDoNotHoldThePose) {
  SPINALTAP_NEED_REGISTERED_BONE()
  const auto made = bench();
  int wrong = 0, silent = 0, wide_of_patch = 0;
  constexpr std::size_t kPatches = 100;
  for (std::size_t n = 0; n < kPatches; ++n) {
    Draws draws(mix_bits(700'000 + n));
    const std::vector<Vec3> places_mm = made->places_mm(draws, kTouched, 8.0);
    const RigidPose truth = any_pose(draws);
    const std::vector<Vec3> touched = touched_of(places_mm, truth, draws);
    TouchedOptions options;
    options.start = off_by(truth, places_mm, draws, 10.0, 10.0);
    options.noise_mm = kNoiseMm;
    const Registration found = register_surface(made->bone().shape(), touched, options);
    const double error_mm = worst_error_mm(*made, found, truth);
    wrong += error_mm > 3.0 ? 1 : 0;
    silent += error_mm > 3.0 && found.warnings.empty() ? 1 : 0;
    wide_of_patch += found.warnings.empty() ? 0 : 1;
    if (error_mm > 3.0 && found.warnings.empty()) {
      std::printf("  patch %d: silent, %.2f mm off, %.2f mm predicted, residuals %.2f mm, %d rejected\n",
                  static_cast<int>(n), error_mm, target_error_mm(found.covariance, made->pedicle_mm(true)),
                  found.residual_rms_mm, static_cast<int>(found.rejected.size()));
    }
  }
  std::printf("%s: of %d patches %d over 3 mm off, %d of them silent; %d told\n", name(), static_cast<int>(kPatches),
              wrong, silent, wide_of_patch);
  EXPECT_GT(wrong, 20);  // that they hold none, or there would be nothing to tell
  EXPECT_LE(silent, 2);
}

std::string name_of_bone(const testing::TestParamInfo<std::size_t>& bone) {
  std::string name = registered_bones()[bone.param].name;
  std::erase(name, ' ');
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, RegistrationOfBones, testing::Range(std::size_t{0}, registered_bones().size()),
                         name_of_bone);

}  // namespace
}  // namespace spinaltap
