#pragma once

#include <limits>

namespace spinaltap::test {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace spinaltap::test
