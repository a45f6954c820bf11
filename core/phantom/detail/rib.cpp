#include "core/phantom/detail/rib.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace spinaltap {
namespace {

/// Half the width of the chest at each rib, and how far each falls on its way round, mm; drawn after textbooks.
constexpr std::array<double, 12> kHalfChestMm{64, 76, 86, 93, 98, 102, 105, 107, 107, 105, 102, 98};
constexpr std::array<double, 12> kFallMm{10, 16, 22, 26, 30, 33, 35, 36, 38, 40, 42, 40};

/// Points on a smooth curve through `through` (Catmull & Rom 1974), `parts` to each piece.
std::vector<Vec3> smooth_curve(const std::vector<Vec3>& through, int parts) {
  std::vector<Vec3> curve;
  const std::size_t last = through.size() - 1;
  for (std::size_t n = 0; n < last; ++n) {
    const Vec3& b = through[n];
    const Vec3& c = through[n + 1];
    const Vec3 a = n > 0 ? through[n - 1] : Vec3(2.0 * b - c);
    const Vec3 d = n + 2 <= last ? through[n + 2] : Vec3(2.0 * c - b);
    for (int part = 0; part < parts; ++part) {
      const double t = static_cast<double>(part) / parts;
      curve.push_back(0.5 * (2.0 * b + t * (c - a) + t * t * (2.0 * a - 5.0 * b + 4.0 * c - d) +
                             t * t * t * (3.0 * b - a - 3.0 * c + d)));
    }
  }
  curve.push_back(through.back());
  return curve;
}

/// The first `length_mm` of a line.
std::vector<Vec3> cut_to_length(const std::vector<Vec3>& line, double length_mm) {
  std::vector<Vec3> cut{line.front()};
  double left_mm = length_mm;
  for (std::size_t n = 1; n < line.size(); ++n) {
    const double step = (line[n] - line[n - 1]).norm();
    if (step >= left_mm) {
      // A last piece that is hardly there would have no direction.
      const Vec3 end = line[n - 1] + left_mm / step * (line[n] - line[n - 1]);
      if (left_mm < 0.5 && cut.size() > 1) {
        cut.back() = end;
      } else {
        cut.push_back(end);
      }
      break;
    }
    left_mm -= step;
    cut.push_back(line[n]);
  }
  return cut;
}

}  // namespace

std::vector<Vec3> rib_axis(int number, const LevelMeasures& m, const VertebraAnatomy& anatomy, double disc_above_mm,
                           double length_mm) {
  const auto index = static_cast<std::size_t>(number - 1);
  const bool floats = number >= 11;
  const double half_width = 0.5 * m.body_width_mm, half_depth = 0.5 * m.body_depth_mm;
  const double half_height = 0.5 * m.body_height_mm;
  const bool own_body = number == 1 || number >= 10;
  const double head_z = own_body ? half_height - (floats ? 6.0 : 3.0) : half_height + 0.5 * disc_above_mm - 0.5;
  const Vec3 head(0.86 * half_width + 3.2, 0.55 * half_depth + 2.5, head_z);
  std::vector<Vec3> through{head};
  const double chest = kHalfChestMm[index], fall = kFallMm[index];
  if (floats) {
    through.push_back(head + Vec3(14.0, 15.0, -4.0));
    through.push_back(head + Vec3(36.0, 24.0, -14.0));
    through.push_back(Vec3(0.86 * chest, 14.0, -0.8 * fall - 6.0));
    through.push_back(Vec3(chest, -22.0, -1.6 * fall - 10.0));
  } else {
    const VertebraAnatomy::Process& process = anatomy.transverse;
    const Vec3 along = (process.tip_mm - process.root_mm).normalized();
    const Vec3 front = Vec3(along.y(), -along.x(), 0.0).normalized();
    const Vec3 tubercle =
        process.tip_mm - 1.0 * along + (0.5 * process.tip_thickness_mm + 4.2) * front + Vec3(0, 0, 1.0);
    through.push_back(tubercle);
    through.push_back(tubercle + Vec3(13.0, 5.0, -0.18 * fall));
    const double angle_y = tubercle.y() + 5.0;
    through.push_back(Vec3(0.86 * chest, angle_y - 16.0, tubercle.z() - 0.5 * fall));
    through.push_back(Vec3(chest, angle_y - 48.0, tubercle.z() - 1.1 * fall));
    through.push_back(Vec3(0.93 * chest, angle_y - 85.0, tubercle.z() - 1.7 * fall));
  }
  return cut_to_length(smooth_curve(through, 4), length_mm);
}

namespace shapes {

RibShape::RibShape(const std::vector<Vec3>& axis_mm, int number, double scale) {
  const bool first = number == 1;  // flat like a lid, the others like staves
  double run_mm = 0.0;
  const auto thickness_at = [&](double at_mm) {
    // Head, neck, body.
    const double neck = smooth_step(3.0, 10.0, at_mm), body = smooth_step(18.0, 32.0, at_mm);
    return scale * (7.0 - 1.4 * neck + 0.6 * body);
  };
  const auto flatness_at = [&](double at_mm) { return 1.25 + 0.65 * smooth_step(4.0, 30.0, at_mm); };
  for (std::size_t n = 1; n < axis_mm.size(); ++n) {
    const Vec3& a = axis_mm[n - 1];
    const Vec3& b = axis_mm[n];
    const Vec3 along = b - a;
    const double step = along.norm();
    const Vec3 hint = first ? Vec3(Vec3::UnitZ()) : Vec3(along.cross(Vec3::UnitZ()));
    const FlatBar bar(a, b, hint, thickness_at(run_mm), thickness_at(run_mm + step), flatness_at(run_mm + 0.5 * step));
    run_mm += step;
    const Box3 box = bar.bounds();
    constexpr double kRoom = 5.0;  // for the blend and the band in which values become distances
    bars_.push_back({bar, box.center(), 0.5 * box.diagonal().norm() + kRoom});
    bounds_.extend(Box3(box.min() - Vec3::Constant(0.25 * kReach), box.max() + Vec3::Constant(0.25 * kReach)));
  }
}

}  // namespace shapes
}  // namespace spinaltap
