#include "core/phantom/scanner.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "core/base/error.h"
#include "core/phantom/vertebra.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

/// A ball of one material.
class EvenBall : public Solid {
 public:
  EvenBall(const Vec3& centre, double radius, double hu) : centre_(centre), radius_(radius), hu_(hu) {}
  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm, std::span<Vec3>) const override {
    for (std::size_t n = 0; n < points_mm.size(); ++n) values_mm[n] = (points_mm[n] - centre_).norm() - radius_;
  }
  Box3 bounds_mm() const override { return Box3(centre_.array() - radius_, centre_.array() + radius_); }
  double hu(const Vec3&, double, double) const override { return hu_; }

 private:
  Vec3 centre_;
  double radius_, hu_;
};

/// All that lies above z = 0, to the scanner's eye: bounds hold the field of view.
class UpperHalf : public Solid {
 public:
  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm, std::span<Vec3>) const override {
    for (std::size_t n = 0; n < points_mm.size(); ++n) values_mm[n] = -points_mm[n].z();
  }
  Box3 bounds_mm() const override { return Box3(Vec3(-20.0, -20.0, -5.0), Vec3(20.0, 20.0, 5.0)); }
  double hu(const Vec3&, double, double) const override { return 1000.0; }
};

ScanOptions small_scan() {
  ScanOptions options;
  options.columns = options.rows = 96;
  options.slices = 60;
  return options;
}

SLOW_TESTS("Scanner.GivesTheSameVoxelsAtAnyNumberOfThreadsAndOthersForAnotherSeed");

TEST(Scanner, GivesTheExactNumberInsideAHomogeneousBallAndOutside) {
  ScanOptions options = small_scan();
  options.noise_hu = 0.0;
  const CtVolume ct = scan(EvenBall(Vec3(3.0, -2.0, 7.0), 10.0, 800.0), options);
  EXPECT_EQ(ct.at(48, 48, 30), 800);
  EXPECT_EQ(ct.at(40, 52, 35), 800);
  EXPECT_EQ(ct.at(1, 1, 1), 40);
}

TEST(Scanner, PutsTheHalfValueAtTheTrueRadius) {
  ScanOptions options = small_scan();
  options.noise_hu = 0.0;
  const Vec3 centre(3.0, -2.0, 7.0);
  const CtVolume ct = scan(EvenBall(centre, 10.0, 1040.0), options);
  for (const Vec3& direction :
       {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0.6, -0.8, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)}) {
    double inside = 5.0, outside = 14.0;
    for (int halving = 0; halving < 40; ++halving) {
      const double middle = 0.5 * (inside + outside);
      (sample_hu(ct, centre + middle * direction) < 540.0 ? outside : inside) = middle;
    }
    EXPECT_NEAR(inside, 10.0, 0.05) << direction.transpose();
  }
}

TEST(Scanner, PlacesSlicesAtMultiplesOfTheStepAroundTheMiddleOfTheBounds) {
  const CtVolume ct = scan(EvenBall(Vec3(3.0, -2.0, 7.0), 4.0, 800.0), small_scan());
  EXPECT_EQ(ct.geometry.spacing_mm, Vec3(0.352, 0.352, 0.5));
  EXPECT_NEAR(ct.geometry.origin_mm.z(), 7.0 - 0.5 * 59 * 0.5, 5e-4);
  EXPECT_NEAR(ct.geometry.origin_mm.x(), 3.0 - 0.5 * 95 * 0.352, 5e-4);
}

TEST(Scanner, AveragesOverTheSliceWidth) {
  ScanOptions options = small_scan();
  options.noise_hu = options.surroundings_hu = 0.0;
  options.slice_width_mm = 1.1;
  options.slice_step_mm = 0.05;
  options.samples_per_step = 1;
  const CtVolume ct = scan(UpperHalf(), options);
  // The step's edge, seen through a box, is a ramp as long as the box: between 10% and 90% lie 80% of it.
  std::vector<double> crossings;
  for (const double level : {100.0, 500.0, 900.0}) {
    for (int k = 1; k < options.slices; ++k) {
      const double low = ct.at(48, 48, k - 1), high = ct.at(48, 48, k);
      if (low < level && high >= level) {
        crossings.push_back(ct.geometry.origin_mm.z() + 0.05 * (k - 1 + (level - low) / (high - low)));
      }
    }
  }
  ASSERT_EQ(crossings.size(), 3U);
  EXPECT_NEAR((crossings[2] - crossings[0]) / 0.8, 1.1, 0.02);
  EXPECT_NEAR(crossings[1], 0.0, 0.01);
}

TEST(Scanner, BlursAnEdgeByTheGaussianAskedFor) {
  ScanOptions options = small_scan();
  options.noise_hu = options.surroundings_hu = 0.0;
  options.blur_mm = 0.5;
  options.pixel_mm = 0.1;
  options.slices = 3;
  class Wall : public UpperHalf {
   public:
    void evaluate(std::span<const Vec3> p, std::span<double> v, std::span<Vec3>) const override {
      for (std::size_t n = 0; n < p.size(); ++n) v[n] = -p[n].x();
    }
  };
  const CtVolume ct = scan(Wall(), options);
  for (const double x : {-1.0, -0.5, -0.2, 0.1, 0.3, 0.8}) {
    const double expected = 500.0 * (1.0 + std::erf(x / (0.5 * std::sqrt(2.0))));
    // Linear interpolation and rounding to whole HU: 2 HU; the lattice cells widen the edge by 0.4%.
    EXPECT_NEAR(sample_hu(ct, Vec3(x, 0.0, 0.0)), expected, 5.0) << x;
  }
}

TEST(Scanner, MakesNoiseOfTheDeviationAskedForEverywhere) {
  ScanOptions options = small_scan();
  options.slices = 40;
  const CtVolume ct = scan(EvenBall(Vec3::Zero(), 1.0, 40.0), options);
  double sum = 0.0, squares = 0.0, edge = 0.0;
  int edge_count = 0;
  for (int k = 0; k < 40; ++k) {
    for (int j = 0; j < 96; ++j) {
      for (int i = 0; i < 96; ++i) {
        const double noise = ct.at(i, j, k) - 40.0;
        sum += noise;
        squares += noise * noise;
        if (i == 0 || j == 0) {
          edge += noise * noise;
          ++edge_count;
        }
      }
    }
  }
  const double count = static_cast<double>(ct.hu.size());
  EXPECT_NEAR(sum / count, 0.0, 0.3);
  EXPECT_NEAR(std::sqrt(squares / count), 12.0, 0.36);
  EXPECT_NEAR(std::sqrt(edge / edge_count), 12.0, 0.9);
}

TEST(Scanner, GivesTheSameVoxelsAtAnyNumberOfThreadsAndOthersForAnotherSeed) {
  ScanOptions options = small_scan();
  options.pixel_mm = 0.9;
  const Vertebra vertebra;
  std::string one;
  {
    const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
    one = scan(vertebra, options).source_hash;
  }
  const tbb::global_control parallel(tbb::global_control::max_allowed_parallelism, 2);
  EXPECT_EQ(scan(vertebra, options).source_hash, one);
  options.seed = 2;
  EXPECT_NE(scan(vertebra, options).source_hash, one);
}

TEST(Scanner, StopsWhenItIsCancelled) {
  Progress progress([&](std::string_view, double) {});
  progress.cancel();
  EXPECT_THROW(scan(EvenBall(Vec3::Zero(), 5.0, 100.0), small_scan(), progress), Cancelled);
}

TEST(Scanner, RejectsOptionsWithoutSense) {
  ScanOptions options = small_scan();
  options.pixel_mm = std::nan("");
  EXPECT_THROW(scan(EvenBall(Vec3::Zero(), 5.0, 100.0), options), Error);
  options = small_scan();
  options.samples_per_pixel = 0;
  EXPECT_THROW(scan(EvenBall(Vec3::Zero(), 5.0, 100.0), options), Error);
}

}  // namespace
}  // namespace spinaltap
