#include "core/phantom/vertebra.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/phantom/vertebra_ground_truth.h"

namespace spinaltap {
namespace {

double value_at(const Solid& solid, const Vec3& p) {
  double value = 0.0;
  solid.evaluate({&p, 1}, {&value, 1}, {});
  return value;
}

Vec3 random_point(const Box3& box, std::uint64_t seed, std::uint64_t n) {
  return box.min() + box.sizes().cwiseProduct(Vec3(random_uniform(seed, 3 * n), random_uniform(seed, 3 * n + 1),
                                                   random_uniform(seed, 3 * n + 2)));
}

/// Where the value passes 0 between p (inside) and p + reach * direction (outside).
double crossing_mm(const Solid& solid, const Vec3& p, const Vec3& direction, double reach) {
  double inside = 0.0, outside = reach;
  EXPECT_LT(value_at(solid, p), 0.0);
  EXPECT_GT(value_at(solid, p + reach * direction), 0.0);
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (inside + outside);
    (value_at(solid, p + middle * direction) > 0.0 ? outside : inside) = middle;
  }
  return inside;
}

VertebraAnatomy placed() {
  VertebraAnatomy anatomy;
  anatomy.placement.position_mm = Vec3(12.0, -30.0, 400.0);
  anatomy.placement.rotation_deg = Vec3(7.0, -5.0, 11.0);
  return anatomy;
}

TEST(Vertebra, ChangesByAtMostOneMillimetrePerMillimetreBetweenRandomPoints) {
  const Vertebra vertebra;
  constexpr std::uint64_t kSeed = 20;
  Box3 box = vertebra.bounds_mm();
  box.extend(box.min() - Vec3::Constant(40.0)).extend(box.max() + Vec3::Constant(40.0));
  for (std::uint64_t n = 0; n < 200000; ++n) {
    const Vec3 p = random_point(box, kSeed, 2 * n);
    // Pairs from 0.5 mm, the smallest block that a scan skips, to across the box.
    const Vec3 direction = (random_point(box, kSeed, 2 * n + 1) - p).normalized();
    const double step = 0.5 * std::pow(200.0, random_uniform(kSeed + 1, n));
    const Vec3 q = p + step * direction;
    ASSERT_LE(std::fabs(value_at(vertebra, p) - value_at(vertebra, q)), step * (1.0 + 1e-9))
        << "seed " << kSeed << ", p " << p.transpose() << ", q " << q.transpose();
  }
}

TEST(Vertebra, IsNowhereSteeperThanOneMillimetrePerMillimetre) {
  const Vertebra vertebra;
  constexpr std::uint64_t kSeed = 25;
  for (std::uint64_t n = 0; n < 100000; ++n) {
    const Vec3 p = random_point(vertebra.bounds_mm(), kSeed, n);
    double value = 0.0;
    Vec3 gradient;
    vertebra.evaluate({&p, 1}, {&value, 1}, {&gradient, 1});
    // Central differences over 1e-5 mm carry rounding of about 1e-9.
    ASSERT_LE(gradient.norm(), 1.0 + 1e-6) << "seed " << kSeed << ", p " << p.transpose() << ", value " << value;
  }
}

TEST(Vertebra, IsADistanceToFirstOrderAtItsSurface) {
  const Vertebra vertebra(placed());
  constexpr std::uint64_t kSeed = 21;
  int checked = 0;
  for (std::uint64_t n = 0; checked < 3000; ++n) {
    // Random points pulled onto the surface along the gradient.
    Vec3 p = random_point(vertebra.bounds_mm(), kSeed, n), gradient;
    double value = value_at(vertebra, p);
    if (std::fabs(value) > 1.0) continue;
    for (int step = 0; step < 20; ++step) {
      vertebra.evaluate({&p, 1}, {&value, 1}, {&gradient, 1});
      p -= value * gradient / std::max(gradient.squaredNorm(), 0.1);
    }
    if (std::fabs(value) > 1e-9) continue;
    vertebra.evaluate({&p, 1}, {&value, 1}, {&gradient, 1});
    // Central differences over 1e-5 mm: rounding of 1e-11 and, in creases, the bend within the step.
    ASSERT_NEAR(gradient.norm(), 1.0, 1e-4) << "seed " << kSeed << ", p " << p.transpose();
    ++checked;
  }
}

TEST(Vertebra, HasItsPediclesExactlyAsWideAndHighAsItsGroundTruthSays) {
  const Vertebra vertebra(placed());
  const VertebraGroundTruth ground_truth = vertebra_ground_truth(vertebra);
  for (const PedicleGroundTruth& side : {ground_truth.left, ground_truth.right}) {
    EXPECT_DOUBLE_EQ(side.width_mm, 9.0);
    EXPECT_DOUBLE_EQ(side.height_mm, 14.5);
    const double width = crossing_mm(vertebra, side.isthmus_mm, side.width_axis, 7.0) +
                         crossing_mm(vertebra, side.isthmus_mm, -side.width_axis, 7.0);
    const double height = crossing_mm(vertebra, side.isthmus_mm, side.height_axis, 10.0) +
                          crossing_mm(vertebra, side.isthmus_mm, -side.height_axis, 10.0);
    EXPECT_NEAR(width, side.width_mm, 1e-6);
    EXPECT_NEAR(height, side.height_mm, 1e-6);
    // Nothing along the axis is narrower.
    for (double t = -4.0; t <= 4.0; t += 0.5) {
      const Vec3 p = side.isthmus_mm + t * side.axis;
      EXPECT_GE(crossing_mm(vertebra, p, side.width_axis, 12.0) + crossing_mm(vertebra, p, -side.width_axis, 12.0),
                side.width_mm - 1e-6);
    }
  }
}

TEST(Vertebra, HasDrillPathsThatEnterOnTheSurfaceAndEndInTheBody) {
  const Vertebra vertebra(placed());
  const VertebraGroundTruth ground_truth = vertebra_ground_truth(vertebra);
  for (const PedicleGroundTruth& side : {ground_truth.left, ground_truth.right}) {
    EXPECT_NEAR(value_at(vertebra, side.entry_mm), 0.0, 1e-9);
    const Vec3 direction = (side.target_mm - side.entry_mm).normalized();
    EXPECT_NEAR((direction - side.axis).norm(), 0.0, 1e-9);
    EXPECT_LT(vertebra.to_own(side.target_mm).y(), 0.0);
    for (double beyond = 0.0; beyond <= 5.0; beyond += 0.1) {
      EXPECT_LT(value_at(vertebra, side.target_mm + beyond * direction), 0.0);
    }
    const double length = (side.target_mm - side.entry_mm).norm();
    for (double t = 0.1; t < length; t += 0.1) EXPECT_LT(value_at(vertebra, side.entry_mm + t * direction), 0.0);
  }
  EXPECT_GT(vertebra.to_own(ground_truth.left.isthmus_mm).x(), 0.0);
  EXPECT_LT(vertebra.to_own(ground_truth.right.isthmus_mm).x(), 0.0);
}

TEST(Vertebra, MirrorsItsLeftSideOntoItsRight) {
  const Vertebra vertebra;
  for (std::uint64_t n = 0; n < 1000; ++n) {
    const Vec3 p = random_point(vertebra.bounds_mm(), 22, n);
    ASSERT_EQ(value_at(vertebra, p), value_at(vertebra, Vec3(-p.x(), p.y(), p.z())));
  }
}

/// Where its right pedicle differs.
VertebraAnatomy asymmetric() {
  VertebraAnatomy anatomy;
  anatomy.right_pedicle = anatomy.pedicle;
  anatomy.right_pedicle->width_mm = 7.5;
  anatomy.right_pedicle->height_mm = 13.0;
  anatomy.right_pedicle->isthmus_mm += Vec3(0.4, -0.2, -0.3);
  anatomy.right_pedicle->convergence_deg = 17.0;
  anatomy.right_pedicle->tilt_deg = 3.0;
  return anatomy;
}

TEST(Vertebra, MayHaveADifferentRightPedicle) {
  const Vertebra vertebra(asymmetric());
  const VertebraGroundTruth ground_truth = vertebra_ground_truth(vertebra);
  EXPECT_EQ(ground_truth.left.width_mm, 9.0);
  EXPECT_EQ(ground_truth.right.width_mm, 7.5);
  EXPECT_LE((ground_truth.right.isthmus_mm - Vec3(-16.4, 20.3, 2.3)).norm(), 1e-12);
  // Inward, to the left, and upward.
  EXPECT_NEAR(std::atan2(ground_truth.right.axis.x(), -ground_truth.right.axis.y()) * 180.0 / std::numbers::pi, 17.0,
              1e-9);
  EXPECT_NEAR(std::asin(ground_truth.right.axis.z()) * 180.0 / std::numbers::pi, 3.0, 1e-9);
  for (const PedicleGroundTruth& side : {ground_truth.left, ground_truth.right}) {
    for (const auto& [axis, size_mm] :
         {std::pair(side.width_axis, side.width_mm), {side.height_axis, side.height_mm}}) {
      EXPECT_NEAR(crossing_mm(vertebra, side.isthmus_mm, axis, 10.0), 0.5 * size_mm, 1e-6);
      EXPECT_NEAR(crossing_mm(vertebra, side.isthmus_mm, -axis, 10.0), 0.5 * size_mm, 1e-6);
    }
  }
}

TEST(Vertebra, DoesNotChangeWhereItsRightPedicleIsGivenAsTheLeftOne) {
  VertebraAnatomy anatomy;
  anatomy.right_pedicle = anatomy.pedicle;
  const Vertebra same(anatomy), plain;
  for (std::uint64_t n = 0; n < 2000; ++n) {
    const Vec3 p = random_point(plain.bounds_mm(), 25, n);
    const double value = value_at(plain, p);
    // Further away, in the canal's middle, the fillets of both pedicles meet, of which each side has but its own else.
    if (std::abs(value) > 2.0) continue;
    ASSERT_NEAR(value_at(same, p), value, 1e-12) << p.transpose();
    ASSERT_EQ(same.hu(p, value, 0.1), plain.hu(p, value, 0.1));
  }
}

TEST(Vertebra, RejectsARightPedicleWithTheNameOfItsValue) {
  VertebraAnatomy anatomy = asymmetric();
  anatomy.right_pedicle->width_mm = -1.0;
  try {
    check_anatomy(anatomy);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("right_pedicle.width_mm"), std::string::npos) << error.what();
  }
  anatomy = asymmetric();
  anatomy.right_pedicle->isthmus_mm.y() = 17.0;
  EXPECT_THROW(Vertebra{anatomy}, Error);
}

TEST(Vertebra, LeavesItsCanalOpen) {
  const Vertebra vertebra;
  for (double z = -40.0; z <= 40.0; z += 0.1) EXPECT_GT(value_at(vertebra, Vec3(0.0, 22.0, z)), 0.0) << "z " << z;
}

/// Euler number of the union of closed cubes around the inside samples, counted by cells (Serra 1982), and how many
/// pieces inside and outside have.
TEST(Vertebra, IsOnePieceWithOneHole) {
  const Vertebra vertebra;
  const double step = 0.75;
  const Box3 box = vertebra.bounds_mm();
  const Eigen::Vector3i size = (box.sizes() / step).array().ceil().cast<int>().matrix() + Eigen::Vector3i::Constant(3);
  const auto at = [&](int i, int j, int k) { return static_cast<std::size_t>((k * size.y() + j) * size.x() + i); };
  std::vector<char> inside(static_cast<std::size_t>(size.prod()), 0);
  for (int k = 0; k < size.z(); ++k)
    for (int j = 0; j < size.y(); ++j)
      for (int i = 0; i < size.x(); ++i)
        inside[at(i, j, k)] = value_at(vertebra, box.min() + step * Vec3(i - 1.0, j - 1.0, k - 1.0)) < 0.0;
  long euler = 0;
  const auto any = [&](int i, int j, int k, int di, int dj, int dk) {
    for (int c = 0; c <= dk; ++c)
      for (int b = 0; b <= dj; ++b)
        for (int a = 0; a <= di; ++a)
          if (inside[at(i - a, j - b, k - c)] != 0) return 1L;
    return 0L;
  };
  for (int k = 1; k < size.z(); ++k)
    for (int j = 1; j < size.y(); ++j)
      for (int i = 1; i < size.x(); ++i)
        euler += any(i, j, k, 1, 1, 1) - any(i, j, k, 0, 1, 1) - any(i, j, k, 1, 0, 1) - any(i, j, k, 1, 1, 0) +
                 any(i, j, k, 1, 0, 0) + any(i, j, k, 0, 1, 0) + any(i, j, k, 0, 0, 1) - any(i, j, k, 0, 0, 0);
  std::vector<char> seen(inside.size(), 0);
  std::array<int, 2> pieces{0, 0};
  for (int start = 0; start < size.prod(); ++start) {
    if (seen[static_cast<std::size_t>(start)] != 0) continue;
    const char kind = inside[static_cast<std::size_t>(start)];
    ++pieces[static_cast<std::size_t>(kind)];
    std::vector<int> stack{start};
    seen[static_cast<std::size_t>(start)] = 1;
    while (!stack.empty()) {
      const int cell = stack.back();
      stack.pop_back();
      const int i = cell % size.x(), j = cell / size.x() % size.y(), k = cell / (size.x() * size.y());
      const std::array<Eigen::Vector3i, 6> next{Eigen::Vector3i(i - 1, j, k), Eigen::Vector3i(i + 1, j, k),
                                                Eigen::Vector3i(i, j - 1, k), Eigen::Vector3i(i, j + 1, k),
                                                Eigen::Vector3i(i, j, k - 1), Eigen::Vector3i(i, j, k + 1)};
      for (const Eigen::Vector3i& n : next) {
        if (n.minCoeff() < 0 || (n.array() >= size.array()).any()) continue;
        const std::size_t to = at(n.x(), n.y(), n.z());
        if (seen[to] != 0 || inside[to] != kind) continue;
        seen[to] = 1;
        stack.push_back(static_cast<int>(to));
      }
    }
  }
  EXPECT_EQ(pieces[1], 1) << "pieces of bone";
  EXPECT_EQ(pieces[0], 1) << "pieces outside: more than one means a cavity";
  // Pieces less holes plus cavities.
  EXPECT_EQ(euler, 0);
}

TEST(Vertebra, FitsNinetyFiveSlicesAndItsBounds) {
  const Vertebra vertebra;
  Box3 extent;
  const Box3 box = vertebra.bounds_mm();
  for (std::uint64_t n = 0; n < 1000000; ++n) {
    const Vec3 p = random_point(Box3(box.min() - Vec3::Ones(), box.max() + Vec3::Ones()), 23, n);
    if (value_at(vertebra, p) < 0.0) extent.extend(p);
  }
  EXPECT_TRUE(box.contains(extent));
  EXPECT_GT(extent.sizes().x(), 74.0);
  EXPECT_LE(extent.sizes().x(), 79.0);
  EXPECT_LE(extent.sizes().y(), 75.0);
  EXPECT_LE(extent.sizes().z(), 44.5);
}

TEST(Vertebra, HasACortexOfTheStatedThicknessAroundACoreOfTheStatedMean) {
  const Vertebra vertebra;
  // Through the front wall of the body, at mid height: 0.5 mm of cortex, then trabeculae.
  EXPECT_EQ(vertebra.hu(Vec3(0.0, -14.0, 0.0), -0.3, 0.0), 1300.0);
  EXPECT_LT(vertebra.hu(Vec3(0.0, -14.0, 0.0), -0.6, 0.0), 500.0);
  double sum = 0.0, squares = 0.0;
  constexpr int kCount = 200000;
  for (std::uint64_t n = 0; n < kCount; ++n) {
    const Vec3 p = random_point(Box3(Vec3(-12.0, -10.0, -9.0), Vec3(12.0, 8.0, 9.0)), 24, n);
    const double hu = vertebra.hu(p, -5.0, 0.0);
    sum += hu;
    squares += hu * hu;
  }
  const double mean = sum / kCount, deviation = std::sqrt(squares / kCount - mean * mean);
  // About 4000 grains of 55 HU: the mean of a region wanders by 1 HU.
  EXPECT_NEAR(mean, 150.0, 4.0);
  EXPECT_NEAR(deviation, 55.0, 3.0);
}

TEST(Vertebra, RejectsAnIsthmusThatAFilletReaches) {
  VertebraAnatomy anatomy;
  anatomy.pedicle.isthmus_mm.y() = 17.0;
  EXPECT_THROW(Vertebra{anatomy}, Error);
}

TEST(Vertebra, RejectsANumberThatIsNotFinite) {
  VertebraAnatomy anatomy;
  anatomy.lamina.lean_deg = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Vertebra{anatomy}, Error);
}

}  // namespace
}  // namespace spinaltap
