#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "core/base/hu_colour.h"
#include "core/points/point_splats.h"

namespace spinaltap {
namespace {

template <class Number>
void append(std::string& bytes, const Number& number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

}  // namespace

std::string splats_ply(std::span<const PointSplat> splats) {
  const auto shown =
      std::count_if(splats.begin(), splats.end(), [](const PointSplat& splat) { return splat.alpha > 0.0F; });
  std::ostringstream head;
  head << "ply\nformat binary_little_endian 1.0\ncomment SpinalTap: points that show, patient LPS, mm\nelement vertex "
       << shown << "\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "radius"}) head << "property float " << name << "\n";
  for (const char* name : {"red", "green", "blue", "alpha"}) head << "property uchar " << name << "\n";
  head << "property short hu\nend_header\n";
  std::string ply = head.str();
  for (const PointSplat& splat : splats) {
    if (!(splat.alpha > 0.0F)) continue;
    for (int axis = 0; axis < 3; ++axis) append(ply, splat.position_mm[axis]);
    for (int axis = 0; axis < 3; ++axis) append(ply, splat.normal[axis]);
    append(ply, splat.radius_mm);
    for (const double part : hu_colour(splat.hu)) append(ply, static_cast<std::uint8_t>(std::lround(255.0 * part)));
    append(ply, static_cast<std::uint8_t>(std::lround(255.0F * splat.alpha)));
    append(ply, splat.hu);
  }
  return ply;
}

}  // namespace spinaltap
