#include "core/ct/detail/label_colour.h"

#include <algorithm>
#include <cmath>

namespace spinaltap::detail {

Vec3 label_colour(int number) {
  constexpr double kGoldenSection = 0.6180339887498949;
  constexpr double kPale = 0.35;
  const double hue = 6.0 * std::fmod(kGoldenSection * number, 1.0);
  Vec3 colour;
  Eigen::Index n = 0;
  for (const double shift : {0.0, 4.0, 2.0}) {  // red, green, blue: of HSV, value 0.95
    const double x = std::fmod(hue + shift, 6.0);
    const double ramp = std::clamp(std::abs(x - 3.0) - 1.0, 0.0, 1.0);
    colour[n++] = 0.95 * (kPale + (1.0 - kPale) * ramp);
  }
  return colour;
}

}  // namespace spinaltap::detail
