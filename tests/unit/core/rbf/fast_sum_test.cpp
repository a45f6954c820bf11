// Compiled with optimisation: long loops of its own.

#include "core/rbf/detail/fast_sum.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>

#include "tests/support/release_only.h"
#include "tests/support/test_kind.h"
#include "tests/unit/core/rbf/kernels.h"
#include "tests/unit/core/rbf/plain_sum.h"
#include "tests/unit/core/rbf/point_sets.h"

namespace spinaltap::detail {
namespace {

using test::kKernels;
using test::plain_sum;
using test::PlainSum;

constexpr std::uint64_t kSumSeed = 71;
constexpr std::size_t kSummed = 1500;
constexpr std::size_t kNowhere = Octree::kNone;  // no box is divided for its neighbours' sake

struct CentreSet {
  const char* name;
  std::vector<Vec3> centres_mm;
};

std::vector<CentreSet> centre_sets() {
  return {{"even", test::random_points(kSummed, kSumSeed)},
          {"surface", test::ball_points(kSummed)},
          {"clusters", test::clustered_points(kSummed, kSumSeed)}};
}

/// Places at centres, beside them, all over their cube, on its faces, and outside it, near and far.
std::vector<Vec3> places(const std::vector<Vec3>& centres_mm) {
  Box3 bounds;
  for (const Vec3& c : centres_mm) bounds.extend(c);
  const double reach_mm = 0.5 * bounds.sizes().maxCoeff();
  std::vector<Vec3> places_mm;
  for (std::size_t i = 0; i < centres_mm.size(); i += 25) {
    places_mm.push_back(centres_mm[i]);
    places_mm.push_back(centres_mm[i] + test::random_place(kSumSeed + 5, i, 0.01 * reach_mm));
  }
  for (std::uint64_t n = 0; n < 100; ++n) {
    places_mm.emplace_back(bounds.center() + test::random_place(kSumSeed + 6, n, reach_mm));
    Vec3 on_face = test::random_place(kSumSeed + 7, n, 1.1 * reach_mm);
    on_face[static_cast<Eigen::Index>(n % 3)] = n % 2 == 0 ? 1.1 * reach_mm : -1.1 * reach_mm;
    places_mm.emplace_back(bounds.center() + on_face);
    places_mm.emplace_back(bounds.center() + test::random_place(kSumSeed + 8, n, 3.0 * reach_mm));
  }
  for (const double times : {10.0, 1e3, 1e6}) places_mm.emplace_back(bounds.center() + Vec3(times * reach_mm, 1, 2));
  return places_mm;
}

struct Found {
  std::vector<double> values;
  std::vector<Vec3> gradients;
  bool operator==(const Found&) const = default;
};

Found evaluate(const FastSum& sum, const std::vector<Vec3>& places_mm) {
  Found found{std::vector<double>(places_mm.size()), std::vector<Vec3>(places_mm.size())};
  sum.evaluate(places_mm, found.values, found.gradients);
  return found;
}

TEST(DirectSums, AreTheFormula) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSumSeed);
  const std::vector<Vec3> centres_mm = test::random_points(301, kSumSeed);
  const std::vector<double> weights = test::random_weights(301, kSumSeed + 1);
  std::vector<Vec3> places_mm = test::random_points(21, kSumSeed + 2);  // no multiple of eight
  places_mm[3] = centres_mm[100];
  for (const RadialKernel kernel : kKernels) {
    for (const double width_mm : {0.0, 0.5}) {
      std::vector<double> values(21);
      std::vector<double> alone(21);
      std::vector<Vec3> gradients(21);
      direct_sums(kernel, width_mm, centres_mm, weights, places_mm, values, gradients);
      direct_sums(kernel, width_mm, centres_mm, weights, places_mm, alone, {});
      EXPECT_EQ(values, alone);
      for (std::size_t i = 0; i < 21; ++i) {
        const PlainSum sum = plain_sum(kernel, width_mm, centres_mm, weights, places_mm[i]);
        // 301 roundings of 2^-53, in another order of the terms' factors.
        EXPECT_NEAR(values[i], sum.value, 3e-14 * sum.size);
        EXPECT_LT((gradients[i] - sum.gradient).norm(), 3e-14 * sum.gradient_size);
      }
    }
  }
}

SLOW_TESTS("FastSum.GivesTheSameBitsAtAnyNumberOfThreadsAndWithAnyInstructionSet",
           "FastSum.GivesALatticeTheBitsOfItsPlaces");

TEST(FastSum, AgreesWithTheSumTermByTerm) {
  RELEASE_ONLY();
  SCOPED_TRACE(::testing::Message() << "seed " << kSumSeed);
  for (const CentreSet& one : centre_sets()) {
    const std::vector<double> weights = test::random_weights(kSummed, kSumSeed + 1);
    const std::vector<Vec3> places_mm = places(one.centres_mm);
    for (const RadialKernel kernel : kKernels) {
      for (const double width_mm : {0.0, 0.8}) {
        SCOPED_TRACE(::testing::Message() << one.name << ", " << (kernel == RadialKernel::biharmonic ? "bi" : "tri")
                                          << "harmonic, low pass " << width_mm << " mm");
        for (const std::size_t beside_size : {std::size_t{20}, std::size_t{60}, kNowhere}) {
          SCOPED_TRACE(beside_size);
          FastSum fast(kernel, width_mm, one.centres_mm, {.order = 8, .leaf_size = 20, .beside_size = beside_size});
          fast.set_weights(weights);
          const Found found = evaluate(fast, places_mm);
          for (std::size_t i = 0; i < places_mm.size(); ++i) {
            const PlainSum sum = plain_sum(kernel, width_mm, one.centres_mm, weights, places_mm[i]);
            // Half a digit for each of 8 nodes, of the terms' magnitudes; gradients lose one of the nodes.
            EXPECT_NEAR(found.values[i], sum.value, 1e-4 * sum.size) << i << " at " << places_mm[i].transpose();
            EXPECT_LT((found.gradients[i] - sum.gradient).norm(), 3e-4 * sum.gradient_size)
                << i << " at " << places_mm[i].transpose();
          }
        }
      }
    }
  }
}

/// Root mean square differences from the sum term by term, of its terms' size.
struct SumErrors {
  double value = 0.0;
  double gradient = 0.0;
};
SumErrors sum_errors(const Found& found, const std::vector<PlainSum>& sums) {
  SumErrors errors;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    errors.value += std::pow((found.values[i] - sums[i].value) / sums[i].size, 2) / static_cast<double>(sums.size());
    errors.gradient += ((found.gradients[i] - sums[i].gradient) / sums[i].gradient_size).squaredNorm() /
                       static_cast<double>(sums.size());
  }
  return {std::sqrt(errors.value), std::sqrt(errors.gradient)};
}

TEST(FastSum, ComesNearerTheMoreNodesABoxHas) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSumSeed);
  for (const CentreSet& one : centre_sets()) {
    const std::vector<double> weights = test::random_weights(kSummed, kSumSeed + 1);
    const std::vector<Vec3> places_mm = places(one.centres_mm);
    for (const RadialKernel kernel : kKernels) {
      SCOPED_TRACE(::testing::Message() << one.name << ", " << (kernel == RadialKernel::biharmonic ? "bi" : "tri")
                                        << "harmonic");
      std::vector<PlainSum> sums;
      sums.reserve(places_mm.size());
      for (const Vec3& p : places_mm) sums.push_back(plain_sum(kernel, 0.0, one.centres_mm, weights, p));
      SumErrors last{1.0, 1.0};
      for (const int order : {4, 6, 8, 10}) {
        FastSum fast(kernel, 0.0, one.centres_mm, {.order = order, .leaf_size = 20});
        fast.set_weights(weights);
        const SumErrors errors = sum_errors(evaluate(fast, places_mm), sums);
        // Half a digit a node is a factor of ten for two; gradients, and sets where many terms are summed directly,
        // may gain a little less. Beyond ten nodes rounding shows: even grids blow it up.
        EXPECT_LT(errors.value, last.value / 5.0) << "order " << order;
        EXPECT_LT(errors.gradient, last.gradient / 5.0) << "order " << order;
        last = errors;
      }
    }
  }
}

TEST(FastSum, GivesTheSumsAtItsCentresInTheirOrder) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSumSeed);
  for (const CentreSet& one : centre_sets()) {
    SCOPED_TRACE(one.name);
    FastSum fast(RadialKernel::biharmonic, 0.0, one.centres_mm, {.order = 8, .leaf_size = 20, .anywhere = false});
    for (const std::uint64_t seed : {kSumSeed + 1, kSumSeed + 2}) {  // nothing of the first weights may stay
      const std::vector<double> weights = test::random_weights(kSummed, seed);
      fast.set_weights(weights);
      std::vector<double> values(kSummed);
      fast.at_centres(values);
      for (std::size_t i = 0; i < kSummed; i += 10) {
        const PlainSum sum = plain_sum(RadialKernel::biharmonic, 0.0, one.centres_mm, weights, one.centres_mm[i]);
        EXPECT_NEAR(values[i], sum.value, 1e-4 * sum.size) << i;  // see AgreesWithTheSumTermByTerm
      }
    }
  }
}

TEST(FastSum, GivesAPlaceTheSameBitsWhateverElseIsAskedFor) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSumSeed);
  for (const CentreSet& one : centre_sets()) {
    FastSum fast(RadialKernel::biharmonic, 0.0, one.centres_mm, {.order = 6, .leaf_size = 20, .beside_size = 20});
    fast.set_weights(test::random_weights(kSummed, kSumSeed + 1));
    std::vector<Vec3> places_mm = places(one.centres_mm);
    const Found together = evaluate(fast, places_mm);
    for (std::size_t i = 0; i < places_mm.size(); ++i) {
      const Found alone = evaluate(fast, {places_mm[i]});
      EXPECT_EQ(alone.values[0], together.values[i]);
      EXPECT_EQ(alone.gradients[0], together.gradients[i]);
    }
    std::vector<double> values(places_mm.size());
    fast.evaluate(places_mm, values, {});
    EXPECT_EQ(values, together.values);
    std::reverse(places_mm.begin(), places_mm.end());
    Found turned = evaluate(fast, places_mm);
    std::reverse(turned.values.begin(), turned.values.end());
    std::reverse(turned.gradients.begin(), turned.gradients.end());
    EXPECT_EQ(turned, together);
  }
}

TEST(FastSum, GivesALatticeTheBitsOfItsPlaces) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSumSeed);
  for (const CentreSet& one : centre_sets()) {
    const Box3 bounds = bounds_of(one.centres_mm);
    // Sparser and denser than leaves; across the cube and beyond its sides, or beside all of it; one place; none.
    const auto axis = [&](int a, double begin, double end, std::size_t count) {
      std::vector<double> list;
      for (std::size_t i = 0; i < count; ++i) {
        const double part = begin + (end - begin) * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
        list.push_back(bounds.min()[a] + part * bounds.sizes()[a]);
      }
      return list;
    };
    const std::array<std::vector<double>, 3> lattices[] = {
        {axis(0, 0.0, 1.0, 23), axis(1, 0.0, 1.0, 9), axis(2, 0.0, 1.0, 14)},
        {axis(0, 0.4, 0.5, 40), axis(1, 0.4, 0.5, 31), axis(2, 0.3, 0.5, 25)},
        {axis(0, -0.5, 1.5, 11), axis(1, -0.5, 1.5, 12), axis(2, 0.2, 1.5, 10)},
        {axis(0, 2.0, 3.0, 3), axis(1, 0.0, 1.0, 3), axis(2, 0.0, 1.0, 3)},
        {axis(0, 0.2, 0.3, 1), axis(1, 0.2, 0.3, 1), axis(2, 0.9, 1.0, 1)},
        {axis(0, 0.0, 1.0, 3), {}, axis(2, 0.0, 1.0, 3)}};
    for (const std::size_t beside_size : {std::size_t{20}, kNowhere}) {
      for (const SimdKernels& simd : simd_kernels()) {
        FastSum fast(RadialKernel::biharmonic, 0.0, one.centres_mm,
                     {.order = 7, .leaf_size = 20, .beside_size = beside_size, .simd = &simd});
        fast.set_weights(test::random_weights(kSummed, kSumSeed + 1));
        for (const auto& [x_mm, y_mm, z_mm] : lattices) {
          std::vector<Vec3> places_mm;
          for (const double z : z_mm) {
            for (const double y : y_mm) {
              for (const double x : x_mm) places_mm.emplace_back(x, y, z);
            }
          }
          std::vector<double> values(places_mm.size(), std::nan(""));
          fast.evaluate_lattice({x_mm, y_mm, z_mm}, values);
          EXPECT_EQ(values, evaluate(fast, places_mm).values) << one.name << " " << simd.name;
        }
      }
    }
  }
}

TEST(FastSum, GivesTheSameBitsAtAnyNumberOfThreadsAndWithAnyInstructionSet) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSumSeed);
  for (const CentreSet& one : centre_sets()) {
    const std::vector<Vec3> places_mm = places(one.centres_mm);
    const auto all = [&](std::size_t threads, const SimdKernels& simd) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      FastSum fast(RadialKernel::triharmonic, 0.3, one.centres_mm,
                   {.order = 5, .leaf_size = 20, .beside_size = 20, .simd = &simd});
      fast.set_weights(test::random_weights(kSummed, kSumSeed + 1));
      Found found = evaluate(fast, places_mm);
      found.values.resize(places_mm.size() + kSummed);
      fast.at_centres(std::span(found.values).subspan(places_mm.size()));
      // Two thirds of a lattice's places lie in the cube.
      std::vector<double> axis(20);
      for (std::size_t i = 0; i < axis.size(); ++i) axis[i] = static_cast<double>(i) - 12.0;
      const std::size_t before = found.values.size();
      found.values.resize(before + axis.size() * axis.size() * axis.size());
      fast.evaluate_lattice({axis, axis, axis}, std::span(found.values).subspan(before));
      return found;
    };
    const Found expected = all(1, simd_kernels().front());
    for (const SimdKernels& simd : simd_kernels()) {
      EXPECT_EQ(all(1, simd), expected) << one.name << " " << simd.name;
      EXPECT_EQ(all(2, simd), expected) << one.name << " " << simd.name;
    }
  }
}

TEST(FastSum, HasTheGradientThatDifferencesOfItsValuesGive) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSumSeed);
  const std::vector<Vec3> centres_mm = test::ball_points(kSummed);
  for (const RadialKernel kernel : kKernels) {
    FastSum fast(kernel, 0.2, centres_mm, {.order = 8, .leaf_size = 20});
    fast.set_weights(test::random_weights(kSummed, kSumSeed + 1));
    constexpr double kStepMm = 1e-4;
    for (std::uint64_t n = 0; n < 60; ++n) {
      const Vec3 p = test::random_place(kSumSeed + 3, n, n < 40 ? 10.0 : 30.0);
      const Vec3 gradient = evaluate(fast, {p}).gradients[0];
      Vec3 slope;
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 step = kStepMm * Vec3::Unit(axis);
        const std::vector<double> ends = evaluate(fast, {p - step, p + step}).values;
        slope[axis] = (ends[1] - ends[0]) / (2.0 * kStepMm);
      }
      const PlainSum sum = plain_sum(kernel, 0.2, centres_mm, test::random_weights(kSummed, kSumSeed + 1), p);
      // Rounding, 1e-13 of the terms over 2e-4 mm; the third derivative, near 1 / (0.2 mm)^2 of a few terms, is less.
      EXPECT_LT((gradient - slope).norm(), 1e-9 * sum.size + 1e-6 * sum.gradient_size) << p.transpose();
    }
  }
}

TEST(FastSum, TakesCentresThatAreFewOrTheSame) {
  const std::vector<Vec3> few_mm{Vec3(1, 2, 3)};
  const std::vector<Vec3> same_mm(200, Vec3(1, 2, 3));
  for (const std::vector<Vec3>& centres_mm : {few_mm, same_mm}) {
    FastSum fast(RadialKernel::biharmonic, 0.0, centres_mm, {.order = 5, .leaf_size = 20});
    fast.set_weights(std::vector<double>(centres_mm.size(), 2.0));
    const auto count = static_cast<double>(centres_mm.size());
    const Found found = evaluate(fast, {Vec3(1, 2, 3), Vec3(4, 6, 3), Vec3(1, 2, 3 + 1e-9)});
    EXPECT_NEAR(found.values[0], 0.0, 1e-12 * count);  // rounding of the place within boxes of 1e-9 mm
    EXPECT_NEAR(found.values[1], 10.0 * count, 1e-12 * count);
    EXPECT_LT((found.gradients[1] - 2.0 * count * Vec3(0.6, 0.8, 0.0)).norm(), 1e-12 * count);
    EXPECT_TRUE(found.gradients[0].allFinite());
  }
}

TEST(FastSum, SaysNotANumberOnlyWhereAPlaceIsNone) {
  FastSum fast(RadialKernel::biharmonic, 0.0, test::random_points(300, kSumSeed), {.order = 4, .leaf_size = 10});
  fast.set_weights(test::random_weights(300, kSumSeed + 1));
  const Found found = evaluate(fast, {Vec3(1, 2, 3), Vec3(1, std::nan(""), 3), Vec3(1, 2, 3)});
  EXPECT_TRUE(std::isnan(found.values[1]));
  EXPECT_TRUE(std::isfinite(found.values[0]));
  EXPECT_EQ(found.values[0], found.values[2]);
}

}  // namespace
}  // namespace spinaltap::detail
