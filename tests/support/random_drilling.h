#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <random>

#include "core/base/geometry.h"
#include "core/engine/drill_engine.h"

namespace spinaltap::test {

/// Numbers and directions that a seed repeats, with any library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : generator_(seed) {}
  double operator()(double low, double high) {
    return low + (high - low) * static_cast<double>(generator_() >> 11) * 0x1.0p-53;
  }
  Vec3 direction() { return Vec3((*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1)).normalized(); }

 private:
  std::mt19937_64 generator_;
};

/// All that a step removed, bit for bit; not what it looked at.
inline void expect_same_removal(const StepResult& a, const StepResult& b) {
  EXPECT_EQ(a.removed, b.removed);
  EXPECT_EQ(a.removed_hu, b.removed_hu);
  EXPECT_EQ(a.work_n_mm, b.work_n_mm);
  EXPECT_EQ(a.removed_mm3, b.removed_mm3);
  EXPECT_EQ(a.moment_n_mm2, b.moment_n_mm2);
}

}  // namespace spinaltap::test
