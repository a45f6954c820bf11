#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "core/ct/ct_noise.h"
#include "core/phantom/scanner.h"
#include "tests/support/release_only.h"
#include "tests/support/surface_distance.h"
#include "tests/support/test_kind.h"
#include "vdb/sim/bake_ct.h"
#include "vdb/sim/bone.h"

namespace spinaltap {
namespace {

/// An egg of bone of one CT number: its surface lies to all sides.
class Egg final : public Solid {
 public:
  Egg(double inside_hu, const Vec3& half_mm) : inside_hu_(inside_hu), half_mm_(half_mm) {}

  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm,
                std::span<Vec3> gradients) const override {
    for (std::size_t n = 0; n < points_mm.size(); ++n) {
      const Vec3 scaled = points_mm[n].cwiseQuotient(half_mm_);
      const double length = std::max(scaled.norm(), 1e-6);
      const Vec3 slope = scaled.cwiseQuotient(half_mm_) / length;
      values_mm[n] = (length - 1.0) / std::max(slope.norm(), 1.0 / half_mm_.maxCoeff());
      if (!gradients.empty()) gradients[n] = slope.normalized();
    }
  }
  Box3 bounds_mm() const override { return {-half_mm_, half_mm_}; }
  double hu(const Vec3&, double, double) const override { return inside_hu_; }

 private:
  double inside_hu_;
  Vec3 half_mm_;
};

struct Case {
  double pixel_mm, step_mm, blur_mm, noise_hu, inside_hu;
};

/// Root mean square distance of the baked surface from the true one.
double measured_mm(const Bone& bone, const Egg& egg) {
  const std::vector<Vec3> points_mm = test::true_surface_points(egg, 0.5, 0.001);
  double squares = 0.0;
  for (const float one : bone.distance(points_mm)) squares += static_cast<double>(one) * static_cast<double>(one);
  return std::sqrt(squares / static_cast<double>(points_mm.size()));
}

Bone baked(const Egg& egg, const Case& one, std::uint64_t seed) {
  ScanOptions options;
  options.pixel_mm = one.pixel_mm;
  options.slice_step_mm = one.step_mm;
  options.slice_width_mm = one.step_mm;
  options.blur_mm = one.blur_mm;
  options.noise_hu = one.noise_hu;
  options.seed = seed;
  const Box3 box_mm = egg.bounds_mm();
  const CtVolume ct =
      scan(egg, scan_of_box({box_mm.min() - Vec3::Constant(12.0), box_mm.max() + Vec3::Constant(12.0)}, options));
  MaskStage stage;
  stage.mask.geometry = ct.geometry;
  for (int k = 0; k < ct.geometry.size[2]; ++k) {
    for (int j = 0; j < ct.geometry.size[1]; ++j) {
      for (int i = 0; i < ct.geometry.size[0]; ++i) {
        const Vec3 p_mm = ct.geometry.to_patient(Vec3(i, j, k));
        double value_mm = 0.0;
        egg.evaluate({&p_mm, 1}, {&value_mm, 1}, {});
        stage.mask.inside.push_back(value_mm < 0.0 ? 1 : 0);
      }
    }
  }
  return Bone(bake_mask(ct, stage, {}).bone);
}

/// Prints and returns how far the told error is from the measured one, as a factor.
double told_over_measured(const Egg& egg, const Case& one) {
  const Bone bone = baked(egg, one, 5);
  const CtSurfaceError told = bone.surface_error().value();
  const double found_mm = measured_mm(bone, egg);
  std::printf(
      "%.2f x %.2f mm, blur %.2f, noise %.0f HU (%.1f), bone %.0f HU, slope %.0f: measured %.3f mm, told %.3f (%.3f, "
      "%.3f, %.3f)\n",
      one.pixel_mm, one.step_mm, one.blur_mm, one.noise_hu, told.noise_hu, one.inside_hu, told.edge_hu_per_mm, found_mm,
      told.standard_error_mm(), told.noise_part_mm, told.sampling_part_mm, told.curved_part_mm);
  EXPECT_NEAR(told.noise_hu, one.noise_hu, 0.15 * one.noise_hu + 1.0);
  return told.standard_error_mm() / found_mm;
}

const Vec3 kRoundMm(13.0, 10.0, 11.0);       // half across; as curved as a body
const Vec3 kSlenderMm(12.0, 6.0, 7.0);       // as a wide pedicle
const Vec3 kOtherSlenderMm(11.0, 4.5, 7.5);  // as a thoracic one

WHOLE_RUNS("CtSurfaceErrorOfScans.TellsTheBakedSurfacesDistanceFromTheTruth");

TEST(CtSurfaceErrorOfScans, TellsTheBakedSurfacesDistanceFromTheTruth) {
  RELEASE_ONLY();
  for (const Case& one : {Case{0.4, 0.6, 0.35, 0.0, 700.0},
                          {0.4, 0.6, 0.35, 15.0, 700.0},
                          {0.4, 0.6, 0.35, 40.0, 700.0},
                          {0.4, 0.6, 0.35, 80.0, 700.0},
                          {0.4, 0.6, 0.35, 40.0, 400.0},
                          {0.8, 1.25, 0.5, 15.0, 700.0},
                          {0.8, 1.25, 0.5, 60.0, 700.0}}) {
    const double factor = told_over_measured(Egg(one.inside_hu, kRoundMm), one);
    EXPECT_GT(factor, 0.5);
    EXPECT_LT(factor, 2.0);
  }
}

TEST(CtSurfaceErrorOfScans, GrowsWithTheSlices) {
  RELEASE_ONLY();
  for (const Vec3& half_mm : {kSlenderMm, kOtherSlenderMm}) {
    for (const Case& one : {Case{0.8, 1.25, 0.5, 15.0, 700.0},
                            {0.7, 2.0, 0.5, 15.0, 700.0},
                            {0.7, 2.5, 0.5, 60.0, 700.0},
                            {0.7, 3.0, 0.5, 15.0, 400.0},
                            {0.7, 4.0, 0.5, 15.0, 700.0},
                            {0.7, 5.0, 0.5, 15.0, 700.0},
                            {1.5, 1.5, 0.5, 15.0, 700.0},
                            {3.0, 3.0, 0.5, 15.0, 700.0}}) {
      const double factor = told_over_measured(Egg(one.inside_hu, half_mm), one);
      EXPECT_GT(factor, 0.5);
      EXPECT_LT(factor, 2.0);
    }
  }
}

}  // namespace
}  // namespace spinaltap
