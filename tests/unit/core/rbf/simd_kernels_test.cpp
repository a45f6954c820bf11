#include "core/rbf/detail/simd_kernels.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <bit>
#include <complex>

#include "core/rbf/detail/lagrange_grid.h"
#include "tests/unit/core/rbf/plain_sum.h"
#include "tests/unit/core/rbf/point_sets.h"

namespace spinaltap::detail {
namespace {

using test::plain_sum;
using test::random_points;
using test::random_weights;

constexpr std::uint64_t kSimdSeed = 41;

/// Numbers as their bits, so that -0 differs from 0 and NaN equals itself.
std::vector<std::uint64_t> bits_of(const std::vector<double>& numbers) {
  std::vector<std::uint64_t> result;
  result.reserve(numbers.size());
  for (const double number : numbers) result.push_back(std::bit_cast<std::uint64_t>(number));
  return result;
}

std::vector<double> numbers_of(const LaneSums& sums) {
  std::vector<double> numbers(sums.value, sums.value + kLanes);
  for (const auto& axis : sums.gradient) numbers.insert(numbers.end(), axis, axis + kLanes);
  return numbers;
}

/// Runs `work` with each instruction set's kernels; all must give the bits that the portable ones give.
template <class Work>
std::vector<double> same_on_all(const Work& work) {
  std::vector<double> portable = work(simd_kernels().front());
  for (const SimdKernels& simd : simd_kernels()) {
    EXPECT_EQ(bits_of(work(simd)), bits_of(portable)) << "instruction set " << simd.name;
  }
  return portable;
}

TEST(SimdKernels, BeginWithPortableOnes) {
  EXPECT_STREQ(simd_kernels().front().name, "portable");
  EXPECT_EQ(&best_simd_kernels(), &simd_kernels().back());
}

TEST(SimdKernels, SumSourcesAsTheFormulaSays) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSimdSeed);
  constexpr std::size_t kBegin = 3;
  constexpr std::size_t kEnd = 35;
  std::vector<Vec3> sources_mm = random_points(37, kSimdSeed);
  const std::vector<double> weights = random_weights(37, kSimdSeed + 1);
  std::vector<Vec3> targets_mm = random_points(kLanes, kSimdSeed + 2);
  targets_mm[0] = sources_mm[5];  // at sources of the range
  targets_mm[6] = sources_mm[34];
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> z;
  for (const Vec3& p : sources_mm) {
    x.push_back(p.x());
    y.push_back(p.y());
    z.push_back(p.z());
  }
  double targets[3 * kLanes];
  for (std::size_t l = 0; l < kLanes; ++l) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      targets[axis * kLanes + l] = targets_mm[l][static_cast<Eigen::Index>(axis)];
    }
  }
  for (const int power : {1, 3}) {
    for (const bool gradient : {false, true}) {
      for (const double width_mm : {0.0, 0.7}) {
        SCOPED_TRACE(::testing::Message() << "power " << power << " gradient " << gradient << " width " << width_mm);
        const std::vector<double> found = same_on_all([&](const SimdKernels& simd) {
          LaneSums sums{};
          std::fill(sums.value, sums.value + kLanes, 2.0);  // to be added to
          std::fill(sums.gradient[1], sums.gradient[1] + kLanes, -3.0);
          simd.near_sum(power, gradient, targets, {x.data(), y.data(), z.data(), weights.data()}, kBegin, kEnd,
                        width_mm * width_mm, sums);
          return numbers_of(sums);
        });
        for (std::size_t l = 0; l < kLanes; ++l) {
          const auto kernel = power == 1 ? RadialKernel::biharmonic : RadialKernel::triharmonic;
          const auto sum = plain_sum(kernel, width_mm, std::span(sources_mm).subspan(kBegin, kEnd - kBegin),
                                     std::span(weights).subspan(kBegin, kEnd - kBegin), targets_mm[l]);
          // 32 terms round to 2^-53 of their running sum each.
          EXPECT_NEAR(found[l], 2.0 + sum.value, 1e-14 * (sum.size + 2.0)) << l;
          const Vec3 expected = gradient ? Vec3(sum.gradient + Vec3(0, -3, 0)) : Vec3(0, -3, 0);
          const Vec3 slope(found[kLanes + l], found[2 * kLanes + l], found[3 * kLanes + l]);
          EXPECT_LT((slope - expected).norm(), 1e-14 * (sum.gradient_size + 3.0)) << l;
        }
      }
    }
  }
}

/// The basis polynomial k of an even grid at t, its derivative, and the size of what that is summed from.
struct Basis {
  double value = 1.0;
  double slope = 0.0;
  double slope_size = 0.0;
};
Basis basis_at(int order, int k, double t) {
  const auto node = [&](int i) { return -1.0 + 2.0 * i / (order - 1); };
  Basis basis;
  for (int m = 0; m < order; ++m) {
    if (m == k) continue;
    basis.value *= (t - node(m)) / (node(k) - node(m));
    double product = 1.0 / (node(k) - node(m));
    for (int i = 0; i < order; ++i) {
      if (i != k && i != m) product *= (t - node(i)) / (node(k) - node(i));
    }
    basis.slope += product;
    basis.slope_size += std::abs(product);
  }
  return basis;
}

TEST(SimdKernels, InterpolateAsLagrangeDoes) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSimdSeed);
  for (int order = 3; order <= kMaxOrder; ++order) {
    SCOPED_TRACE(::testing::Message() << "order " << order);
    const LagrangeGrid grid(order);
    const std::vector<double> nodes = random_weights(grid.node_count(), kSimdSeed + 3);
    std::vector<Vec3> places = random_points(kLanes, kSimdSeed + 4, 1.0);
    places[0] = Vec3(-1.0, 1.0, grid.node(1));  // at nodes, where products vanish
    double lanes[3 * kLanes];
    for (std::size_t l = 0; l < kLanes; ++l) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        lanes[axis * kLanes + l] = places[l][static_cast<Eigen::Index>(axis)];
    }
    constexpr double kScale = 0.25;
    for (const bool gradient : {false, true}) {
      const std::vector<double> found = same_on_all([&](const SimdKernels& simd) {
        LaneSums sums{};
        std::fill(sums.value, sums.value + kLanes, 2.0);
        simd.interpolate(order, gradient, lanes, nodes.data(), grid.inverse(), kScale, sums);
        return numbers_of(sums);
      });
      for (std::size_t l = 0; l < kLanes; ++l) {
        std::vector<Basis> x;
        std::vector<Basis> y;
        std::vector<Basis> z;
        for (int k = 0; k < order; ++k) {
          x.push_back(basis_at(order, k, places[l].x()));
          y.push_back(basis_at(order, k, places[l].y()));
          z.push_back(basis_at(order, k, places[l].z()));
        }
        double value = 0.0;
        double size = 0.0;
        Vec3 slope = Vec3::Zero();
        double slope_size = 0.0;
        std::size_t at = 0;
        for (const Basis& c : z) {
          for (const Basis& b : y) {
            for (const Basis& a : x) {
              const double w = nodes[at++];
              value += w * a.value * b.value * c.value;
              size += std::abs(w * a.value * b.value * c.value);
              slope += w * Vec3(a.slope * b.value * c.value, a.value * b.slope * c.value, a.value * b.value * c.slope);
              slope_size += std::abs(w) *
                            (a.slope_size * std::abs(b.value * c.value) + b.slope_size * std::abs(a.value * c.value) +
                             c.slope_size * std::abs(a.value * b.value));
            }
          }
        }
        // Some 40 roundings in each product, 2^-53 each, on both sides.
        EXPECT_NEAR(found[l], 2.0 + value, 2e-14 * (size + 2.0));
        const Vec3 got(found[kLanes + l], found[2 * kLanes + l], found[3 * kLanes + l]);
        EXPECT_LT((got - (gradient ? kScale : 0.0) * slope).norm(), 2e-14 * kScale * slope_size);
      }
    }
  }
}

TEST(SimdKernels, InterpolateOnALatticeWithTheBitsOfItsPlaces) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSimdSeed);
  constexpr std::size_t kCounts[3] = {11, 3, 9};
  for (int order = 3; order <= kMaxOrder; ++order) {
    SCOPED_TRACE(::testing::Message() << "order " << order);
    const LagrangeGrid grid(order);
    const std::vector<double> nodes = random_weights(grid.node_count(), kSimdSeed + 3);
    const std::vector<double> axes[3] = {random_weights(16, 1), random_weights(8, 2), random_weights(16, 3)};
    const double* const places[3] = {axes[0].data(), axes[1].data(), axes[2].data()};
    const std::vector<double> found = same_on_all([&](const SimdKernels& simd) {
      std::vector<double> work(static_cast<std::size_t>(order) * (8 + 16));
      std::vector<double> out(16 * kCounts[1] * kCounts[2], 99.0);
      simd.interpolate_lattice(order, kCounts, places, nodes.data(), grid.inverse(), work.data(), out.data());
      std::vector<double> rows;  // without what fills them up
      for (std::size_t row = 0; row < kCounts[1] * kCounts[2]; ++row) {
        rows.insert(rows.end(), out.data() + row * 16, out.data() + row * 16 + kCounts[0]);
      }
      return rows;
    });
    for (std::size_t k = 0; k < kCounts[2]; ++k) {
      for (std::size_t j = 0; j < kCounts[1]; ++j) {
        for (std::size_t i = 0; i < kCounts[0]; ++i) {
          double place[3 * kLanes];
          std::fill_n(place, kLanes, axes[0][i]);
          std::fill_n(place + kLanes, kLanes, axes[1][j]);
          std::fill_n(place + 2 * kLanes, kLanes, axes[2][k]);
          LaneSums sums{};
          simd_kernels().front().interpolate(order, false, place, nodes.data(), grid.inverse(), 1.0, sums);
          ASSERT_EQ(found[(k * kCounts[1] + j) * kCounts[0] + i], sums.value[0]);
        }
      }
    }
  }
}

TEST(SimdKernels, MultiplySpectraAsComplexNumbers) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSimdSeed);
  constexpr std::size_t kChunk = 2 * kLanes;
  const std::vector<double> table = random_weights(4 * kChunk, kSimdSeed + 5);
  const std::vector<double> source = random_weights(6 * kChunk, kSimdSeed + 6);
  const std::vector<SpectrumPair> all{{0, 5}, {3, 1}, {2, 2}, {3, 0}, {1, 4}, {0, 3}, {2, 5}};
  for (std::size_t count = 0; count <= all.size(); ++count) {
    const std::vector<double> found = same_on_all([&](const SimdKernels& simd) {
      std::vector<double> out(kChunk, 99.0);
      simd.multiply_spectra(all.data(), count, table.data(), source.data(), out.data());
      return out;
    });
    for (std::size_t l = 0; l < kLanes; ++l) {
      std::complex<double> sum = 0.0;
      for (std::size_t p = 0; p < count; ++p) {
        const double* a = table.data() + all[p].table * kChunk + l;
        const double* b = source.data() + all[p].source * kChunk + l;
        sum += std::complex<double>(a[0], a[kLanes]) * std::complex<double>(b[0], b[kLanes]);
      }
      // Up to 28 products of about 1.
      EXPECT_NEAR(found[l], sum.real(), 1e-13);
      EXPECT_NEAR(found[kLanes + l], sum.imag(), 1e-13);
    }
  }
}

TEST(SimdKernels, MultiplyComplexMatrices) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSimdSeed);
  for (const std::size_t rows : {1U, 5U, 13U}) {
    for (const std::size_t inner : {1U, 7U}) {
      for (const std::size_t columns : {8U, 24U}) {
        const auto matrix = [](std::size_t r, std::size_t c, std::uint64_t seed) {
          return random_weights(r * c, seed);
        };
        const std::vector<double> a_re = matrix(rows, inner, 1);
        const std::vector<double> a_im = matrix(rows, inner, 2);
        const std::vector<double> in_re = matrix(inner, columns, 3);
        const std::vector<double> in_im = matrix(inner, columns, 4);
        const std::size_t size = rows * columns;
        const std::vector<double> found = same_on_all([&](const SimdKernels& simd) {
          std::vector<double> out(2 * size, 99.0);
          simd.multiply_complex(rows, inner, columns, a_re.data(), a_im.data(), in_re.data(), in_im.data(), out.data(),
                                out.data() + size);
          return out;
        });
        for (std::size_t r = 0; r < rows; ++r) {
          for (std::size_t c = 0; c < columns; ++c) {
            std::complex<double> sum = 0.0;
            for (std::size_t k = 0; k < inner; ++k) {
              sum += std::complex<double>(a_re[r * inner + k], a_im[r * inner + k]) *
                     std::complex<double>(in_re[k * columns + c], in_im[k * columns + c]);
            }
            // Up to 14 products of about 1.
            EXPECT_NEAR(found[r * columns + c], sum.real(), 1e-13);
            EXPECT_NEAR(found[size + r * columns + c], sum.imag(), 1e-13);
          }
        }
      }
    }
  }
}

/// Eight local systems as local_functions() takes them.
struct LocalSystems {
  std::size_t count;
  std::vector<double> points;
  std::vector<double> diagonal;

  Vec3 point(std::size_t i, std::size_t lane) const {
    return {points[3 * i * kLanes + lane], points[(3 * i + 1) * kLanes + lane], points[(3 * i + 2) * kLanes + lane]};
  }
};

std::vector<double> local_functions(const SimdKernels& simd, int power, const LocalSystems& systems) {
  const std::size_t terms = power == 1 ? 4 : 10;
  const std::size_t count = systems.count;
  std::vector<double> work((terms * count + count * (count + 1) / 2) * kLanes);
  std::vector<double> out(count * kLanes);
  simd.local_functions(power, count, terms, systems.points.data(), systems.diagonal.data(), work.data(), out.data());
  return out;
}

TEST(SimdKernels, SolveLocalSystemsAsADenseSolverDoes) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSimdSeed);
  for (const int power : {1, 3}) {
    const std::size_t terms = power == 1 ? 4 : 10;
    for (const std::size_t count : {terms + 1, std::size_t{20}, std::size_t{41}}) {
      for (const double smoothing : {0.0, 0.2}) {
        SCOPED_TRACE(::testing::Message() << "power " << power << " count " << count << " smoothing " << smoothing);
        LocalSystems systems{count, {}, std::vector<double>(count * kLanes, smoothing)};
        for (std::size_t k = 0; k < 3 * count * kLanes; ++k) {
          systems.points.push_back(2.0 * random_uniform(kSimdSeed + 7, k) - 1.0);
        }
        const std::vector<double> found =
            same_on_all([&](const SimdKernels& simd) { return local_functions(simd, power, systems); });
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
          // [-+phi + diagonal, P; P', 0] [w; a] = [e_last; 0]; scaled to w' (-+phi + diagonal) w = w_last = 1.
          const auto n = static_cast<Eigen::Index>(count);
          const auto q = static_cast<Eigen::Index>(terms);
          Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n + q, n + q);
          for (std::size_t i = 0; i < count; ++i) {
            const Vec3 p = systems.point(i, lane);
            const double row[10] = {1.0,           p.x(),         p.y(),         p.z(),         p.x() * p.x(),
                                    p.x() * p.y(), p.x() * p.z(), p.y() * p.y(), p.y() * p.z(), p.z() * p.z()};
            for (Eigen::Index k = 0; k < q; ++k) {
              matrix(static_cast<Eigen::Index>(i), n + k) = matrix(n + k, static_cast<Eigen::Index>(i)) = row[k];
            }
            for (std::size_t j = 0; j < count; ++j) {
              const double r = (p - systems.point(j, lane)).norm();
              matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
                  (power == 1 ? -r : r * r * r) + (i == j ? smoothing : 0.0);
            }
          }
          Eigen::VectorXd right = Eigen::VectorXd::Zero(n + q);
          right[n - 1] = 1.0;
          const Eigen::VectorXd w = matrix.fullPivLu().solve(right).head(n);
          ASSERT_GT(w[n - 1], 0.0);
          Eigen::VectorXd got(n);
          for (Eigen::Index i = 0; i < n; ++i) got[i] = found[static_cast<std::size_t>(i) * kLanes + lane];
          const Eigen::VectorXd expected = w / std::sqrt(w[n - 1]);
          // The penalty, 1e5 a point, lets polynomials through by 1e-5 of what the kernel asks of them.
          EXPECT_LT((got - expected).norm(), 1e-4 * expected.norm()) << "lane " << lane;
        }
      }
    }
  }
}

TEST(SimdKernels, TakeLocalPointsInAPlane) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSimdSeed);
  for (const int power : {1, 3}) {
    LocalSystems systems{41, {}, std::vector<double>(41 * kLanes, 0.0)};
    for (std::size_t i = 0; i < 41; ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
          systems.points.push_back(axis == 2 ? 0.0 : 2.0 * random_uniform(kSimdSeed + axis, i * kLanes + lane) - 1.0);
        }
      }
    }
    const std::vector<double> found =
        same_on_all([&](const SimdKernels& simd) { return local_functions(simd, power, systems); });
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      double sum = 0.0;
      for (std::size_t i = 0; i < 41; ++i) sum += found[i * kLanes + lane];
      EXPECT_TRUE(std::isfinite(sum));
      // Constants are still taken out, by the penalty: see above.
      EXPECT_LT(std::abs(sum), 1e-4 * found[40 * kLanes + lane]);
    }
  }
}

}  // namespace
}  // namespace spinaltap::detail
