// The outlines of masks, as structure sets have them.

#include "core/ct/detail/mask_contours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/random.h"

namespace spinaltap::detail {
namespace {

using Outline = std::vector<ContourPoint>;

double twice_area(const Outline& outline) {
  double sum = 0.0;
  for (std::size_t n = 0; n < outline.size(); ++n) {
    const ContourPoint& p = outline[n];
    const ContourPoint& q = outline[(n + 1) % outline.size()];
    sum += p.a * q.b - q.a * p.b;
  }
  return sum;
}

/// How an outline lies around a point.
struct Around {
  int turns = 0;
  bool is_odd = false;                                   ///< the number of lines crossed on the way out
  double gap = std::numeric_limits<double>::infinity();  ///< to the nearest line
};

Around around(const Outline& outline, double a, double b) {
  Around found;
  for (std::size_t n = 0; n < outline.size(); ++n) {
    const ContourPoint& p = outline[n];
    const ContourPoint& q = outline[(n + 1) % outline.size()];
    const double da = q.a - p.a, db = q.b - p.b;
    const double t = std::clamp(((a - p.a) * da + (b - p.b) * db) / (da * da + db * db), 0.0, 1.0);
    found.gap = std::min(found.gap, std::hypot(p.a + t * da - a, p.b + t * db - b));
    if ((p.b <= b) == (q.b <= b) || p.a + (b - p.b) / db * da <= a) continue;
    found.turns += q.b > p.b ? 1 : -1;
    found.is_odd = !found.is_odd;
  }
  return found;
}

TEST(OutlinesOf, JoinHolesToWhatIsAroundThemAndPartPixelsThatTouchAtACorner) {
  const std::vector<std::uint8_t> slice{1, 1, 1, 0, 0,   //
                                        1, 0, 1, 0, 1,   //
                                        1, 1, 1, 1, 0};  //
  const auto outlines = outlines_of(slice, 5, 3, 1);
  ASSERT_EQ(outlines.size(), 2U);  // around all but one pixel, and around that pixel: a square on its corner
  EXPECT_EQ(outlines[1].size(), 4U);
  EXPECT_EQ(twice_area(outlines[1]), 1.0);
  // A square of 3 x 3 without its four corners of an eighth and without the hole's square on its corner; the pixel that
  // sticks out adds one.
  EXPECT_EQ(twice_area(outlines[0]), 2.0 * (9.0 - 4.0 / 8.0 - 0.5 + 1.0));
}

// Readers differ: some add closed outlines up, some count crossings or turns, over all outlines or one by one, and a
// centre on a line is in for some and out for others. None of it matters where each centre is a quarter of a pixel off
// all lines, and is gone around once by one outline or by none.
TEST(OutlinesOf, MeanTheSamePixelsByAnyRule) {
  constexpr std::uint64_t kSeed = 44;
  constexpr int kColumns = 23, kRows = 19;
  for (const double share : {0.2, 0.5, 0.7, 0.9}) {
    for (std::uint64_t round = 0; round < 10; ++round) {
      std::vector<std::uint8_t> slice;
      for (std::uint64_t n = 0; n < kColumns * kRows; ++n) {
        slice.push_back(random_uniform(kSeed + round, n) < share ? 7 : 3);
      }
      const auto outlines = outlines_of(slice, kColumns, kRows, 7);
      for (int b = 0; b < kRows; ++b) {
        for (int a = 0; a < kColumns; ++a) {
          int outside = 0, inside = 0;
          for (const Outline& outline : outlines) {
            const Around found = around(outline, a, b);
            ASSERT_GE(found.gap, 0.25);
            outside += found.turns == 0 && !found.is_odd ? 1 : 0;
            inside += found.turns == 1 && found.is_odd ? 1 : 0;
          }
          ASSERT_EQ(inside, slice[static_cast<std::size_t>(b * kColumns + a)] == 7 ? 1 : 0) << a << " " << b;
          ASSERT_EQ(static_cast<std::size_t>(outside + inside), outlines.size()) << a << " " << b;
        }
      }
    }
  }
}

TEST(OutlinesOf, LeaveIslandsInHolesAlone) {
  // Rings around rings: the hole of each is joined to it, and what stands in the hole is an outline of its own.
  constexpr int kSize = 15;
  std::vector<std::uint8_t> slice;
  for (int b = 0; b < kSize; ++b) {
    for (int a = 0; a < kSize; ++a) slice.push_back(std::max(std::abs(a - 7), std::abs(b - 7)) % 2 == 1 ? 1 : 0);
  }
  const auto outlines = outlines_of(slice, kSize, kSize, 1);
  ASSERT_EQ(outlines.size(), 4U);
  for (const Outline& outline : outlines) EXPECT_GT(twice_area(outline), 0.0);
  EXPECT_TRUE(outlines_of(slice, kSize, kSize, 2).empty());
}

}  // namespace
}  // namespace spinaltap::detail
