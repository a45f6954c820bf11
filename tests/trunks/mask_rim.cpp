// Compiled with optimisation: whole CTs are gone through.
#include "tests/trunks/mask_rim.h"

#include <array>
#include <cmath>

#include "core/segment/detail/median.h"

namespace spinaltap::test {

MaskRim measure_rim(const CtVolume& ct, const LabelVolume& labels, const LevelReport& level) {
  constexpr double kBeyondMm = 1.0, kMiddle = 0.7;  // of the body's size
  const GridGeometry& geometry = ct.geometry;
  std::array<int, 3> beyond{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double spacing_mm = geometry.spacing_mm[static_cast<Eigen::Index>(axis)];
    beyond[axis] = static_cast<int>(std::ceil(kBeyondMm / spacing_mm));
  }
  const auto offset_of = [&](const std::array<int, 3>& at) { return geometry.offset(at[0], at[1], at[2]); };
  const auto is_in_ct = [&](const std::array<int, 3>& at) { return geometry.contains(at[0], at[1], at[2]); };
  const auto is_inside = [&](const std::array<int, 3>& at) {
    return is_in_ct(at) && labels.labels[offset_of(at)] == level.label;
  };
  std::vector<std::int16_t> in_hu, out_hu;
  double sum_hu = 0.0, count = 0.0;
  std::array<int, 3> at{};
  for (at[2] = 0; at[2] < geometry.size[2]; ++at[2]) {
    for (at[1] = 0; at[1] < geometry.size[1]; ++at[1]) {
      for (at[0] = 0; at[0] < geometry.size[0]; ++at[0]) {
        if (!is_inside(at)) continue;
        const std::int16_t hu = ct.hu[offset_of(at)];
        const Vec3 p =
            level.body_axes.transpose() * (geometry.to_patient(Vec3(at[0], at[1], at[2])) - level.body_centre_mm);
        if ((2.0 * p).cwiseQuotient(level.body_size_mm).cwiseAbs().maxCoeff() < kMiddle) {
          sum_hu += hu;
          count += 1.0;
          continue;
        }
        bool on_surface = false;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          for (const int side : {-1, 1}) {
            std::array<int, 3> next = at, far = at;
            next[axis] += side;
            far[axis] += side * beyond[axis];
            if (is_inside(next) || is_inside(far) || !is_in_ct(far)) continue;
            on_surface = true;
            out_hu.push_back(ct.hu[offset_of(far)]);
          }
        }
        if (on_surface) in_hu.push_back(hu);
      }
    }
  }
  MaskRim rim;
  if (!in_hu.empty()) rim.inside_hu = detail::upper_median(std::move(in_hu));
  if (!out_hu.empty()) rim.outside_hu = detail::upper_median(std::move(out_hu));
  if (count > 0.0) rim.inner_hu = sum_hu / count;
  return rim;
}

}  // namespace spinaltap::test
