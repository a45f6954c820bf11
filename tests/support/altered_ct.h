#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/random.h"
#include "core/ct/ct_volume.h"

namespace spinaltap::test {

/// A CT on another grid: `to_old` gives the place in the CT of a place in the new one, both patient LPS, mm.
template <class ToOld>
CtVolume warped(const CtVolume& ct, const GridGeometry& geometry, const ToOld& to_old) {
  std::vector<std::int16_t> hu;
  hu.reserve(geometry.voxel_count());
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        const Vec3 old_mm = to_old(geometry.to_patient(Vec3(i, j, k)));
        hu.push_back(static_cast<std::int16_t>(std::lround(sample_hu(ct, old_mm))));
      }
    }
  }
  return make_ct_volume(geometry, std::move(hu));
}

/// Turned about an axis of the patient through the CT's middle.
struct Turn {
  int axis;
  double deg;

  Vec3 operator()(const CtVolume& ct, const Vec3& p_mm, double sign) const {
    const auto& size = ct.geometry.size;
    const Vec3 middle_mm = ct.geometry.to_patient(0.5 * Vec3(size[0] - 1, size[1] - 1, size[2] - 1));
    return middle_mm + Eigen::AngleAxisd(sign * deg * kDegree, Vec3::Unit(axis)) * (p_mm - middle_mm);
  }
};
inline CtVolume turned(const CtVolume& ct, const Turn& turn) {
  return warped(ct, ct.geometry, [&](const Vec3& p_mm) { return turn(ct, p_mm, -1.0); });
}

/// A body crushed to a share of its height, from its lower end at `low_mm` up to `high_mm`: what is above comes down.
/// The CT's slices stand across the patient.
struct Crush {
  double low_mm, high_mm, share;

  Vec3 to_new(Vec3 p_mm) const {
    p_mm.z() -= (1.0 - share) * std::clamp(p_mm.z() - low_mm, 0.0, high_mm - low_mm);
    return p_mm;
  }
  Vec3 to_old(Vec3 p_mm) const {
    p_mm.z() += (1.0 / share - 1.0) * std::clamp(p_mm.z() - low_mm, 0.0, share * (high_mm - low_mm));
    return p_mm;
  }
};
inline CtVolume crushed(const CtVolume& ct, const Crush& crush) {
  return warped(ct, ct.geometry, [&](const Vec3& p_mm) { return crush.to_old(p_mm); });
}

/// In slices of another step and width: means over a box of that width.
inline CtVolume resliced(const CtVolume& ct, double pixel_mm, double step_mm, double width_mm) {
  const GridGeometry& old = ct.geometry;
  CtVolume thick = ct;
  const int reach = static_cast<int>(std::lround(0.5 * width_mm / old.spacing_mm.z()));
  for (int k = 0; k < old.size[2]; ++k) {
    const int low = std::max(0, k - reach), high = std::min(old.size[2] - 1, k + reach);
    for (int j = 0; j < old.size[1]; ++j) {
      for (int i = 0; i < old.size[0]; ++i) {
        double sum = 0.0;
        for (int n = low; n <= high; ++n) sum += ct.at(i, j, n);
        thick.hu[old.offset(i, j, k)] = static_cast<std::int16_t>(std::lround(sum / (high - low + 1)));
      }
    }
  }
  GridGeometry geometry = old;
  geometry.spacing_mm = Vec3(pixel_mm, pixel_mm, step_mm);
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    geometry.size[a] = static_cast<int>((old.size[a] - 1) * old.spacing_mm[axis] / geometry.spacing_mm[axis]) + 1;
  }
  return warped(thick, geometry, [](const Vec3& p_mm) { return p_mm; });
}

/// As by a sharper kernel and a lower dose: `amount` times what a pixel has over its neighbours' mean is added, then
/// noise of a standard deviation.
inline CtVolume sharpened(const CtVolume& ct, double amount, double noise_hu, std::uint64_t seed) {
  CtVolume sharp = ct;
  const GridGeometry& geometry = ct.geometry;
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        double sum = 0.0;
        for (int n = 0; n < 9; ++n) {
          sum += ct.at(std::clamp(i + n % 3 - 1, 0, geometry.size[0] - 1),
                       std::clamp(j + n / 3 - 1, 0, geometry.size[1] - 1), k);
        }
        const std::size_t voxel = geometry.offset(i, j, k);
        const double own = ct.hu[voxel];
        const double hu = own + amount * (own - sum / 9.0) + noise_hu * random_normal(seed, voxel);
        sharp.hu[voxel] = static_cast<std::int16_t>(std::lround(std::clamp(hu, -1024.0, 3071.0)));
      }
    }
  }
  return make_ct_volume(geometry, std::move(sharp.hu));
}

/// With lighter bone: what is over 60 HU has that share of it left.
inline CtVolume with_light_bone(const CtVolume& ct, double share) {
  std::vector<std::int16_t> hu = ct.hu;
  for (std::int16_t& one : hu) {
    if (one > 60) one = static_cast<std::int16_t>(std::lround(60.0 + share * (one - 60)));
  }
  return make_ct_volume(ct.geometry, std::move(hu));
}

/// As a larger or smaller patient, about the patient's origin.
inline CtVolume scaled_by(const CtVolume& ct, double by) {
  GridGeometry geometry = ct.geometry;
  geometry.spacing_mm *= by;
  geometry.origin_mm *= by;
  return make_ct_volume(geometry, ct.hu);
}

}  // namespace spinaltap::test
