#include "vdb/engine/detail/move_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "tests/unit/core/engine/askew_block.h"

namespace spinaltap {
namespace {

constexpr std::uint64_t kMoveSeed = 99;
constexpr std::size_t kColumns = 19;
constexpr std::size_t kBoxes = 131;

TEST(MoveKernels, LeaveTheSameToTheLastBitWithAnyInstructions) {
  SCOPED_TRACE(::testing::Message() << "seed " << kMoveSeed);
  const auto& sets = detail::move_kernels();
  test::Draw draw(kMoveSeed);
  std::size_t held = 0, ran_out = 0;
  for (int run = 0; run < 400; ++run) {
    std::array<std::array<float, kBoxes + detail::kMoveBlock>, kColumns> columns{};
    const auto fill = [&](std::size_t first, std::size_t count, double low, double high) {
      for (std::size_t n = first; n < first + count; ++n) {
        for (float& number : columns[n]) number = static_cast<float>(draw(low, high));
      }
    };
    fill(0, 3, -20.0, 20.0);     // centres
    fill(3, 3, -0.5, 0.5);       // feet
    fill(6, 3, -0.02, 0.02);     // turns
    fill(9, 1, -0.5, 0.5);       // back
    fill(10, 1, -0.2, 3.0);      // free
    fill(11, 2, 0.0, 1.0);       // forward, backward
    fill(13, 3, -0.577, 0.577);  // side
    fill(16, 1, 0.0, 1.4);       // sine: to 1, or 2
    fill(17, 1, 0.0, 2.0);       // axial: 0 or 1
    fill(18, 1, 0.0, 5.0);       // rest
    for (float& sine : columns[16]) sine = sine > 1.2F ? 2.0F : std::min(sine, 1.0F);
    for (float& axial : columns[17]) axial = axial > 1.0F ? 1.0F : 0.0F;
    const auto& c = columns;
    const detail::MoveColumns at_hand{c[0].data(),  c[1].data(),  c[2].data(),  c[3].data(),  c[4].data(),
                                      c[5].data(),  c[6].data(),  c[7].data(),  c[8].data(),  c[9].data(),
                                      c[10].data(), c[11].data(), c[12].data(), c[13].data(), c[14].data(),
                                      c[15].data(), c[16].data(), c[17].data(), c[18].data()};
    const auto f = [&](double low, double high) { return static_cast<float>(draw(low, high)); };
    const detail::MoveLine line{f(-0.1, 0.1),   f(-0.1, 0.1), -0.99F,         f(-0.5, 0.5),
                                f(-0.5, 0.5),   f(-0.5, 0.5), f(-0.02, 0.02), f(-0.02, 0.02),
                                f(-0.02, 0.02), f(-0.5, 0.5), f(0.0, 0.01),   f(0.1, 1.0),
                                f(0.0, 1e-3),   f(0.0, 0.1),  f(0.0, 1e-5),   f(0.0, 1e-5)};
    // Counts that fill vectors, and that do not.
    const std::size_t begin = draw.bits() % 20, count = 1 + draw.bits() % (kBoxes - 20);
    std::array<float, kBoxes> expected{};
    sets.front().check(at_hand, line, begin, count, expected.data());
    for (std::size_t n = 0; n < count; ++n) (expected[n] > 0.0F ? held : ran_out) += 1;
    for (const detail::MoveKernels& set : sets) {
      std::array<float, kBoxes> left{};
      set.check(at_hand, line, begin, count, left.data());
      for (std::size_t n = 0; n < kBoxes; ++n) {
        ASSERT_EQ(std::bit_cast<std::uint32_t>(left[n]), std::bit_cast<std::uint32_t>(expected[n]))
            << set.name << ", run " << run << ", box " << n;
      }
    }
  }
  EXPECT_GT(held, 3'000U);
  EXPECT_GT(ran_out, 3'000U);
}

}  // namespace
}  // namespace spinaltap
