#include "core/drill/point_volume.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace spinaltap {

PointVolume::PointVolume(const DrillPath& path, const PointVolumeOptions& options)
    : pattern_(options.radius_mm, options.spacing_mm), lead_in_mm_(options.lead_in_mm) {
  constexpr double kMaxPoints = 0x1.0p32;
  check_path(path);
  if (!(options.lead_in_mm >= 0.0) || !(options.lead_in_mm <= 100.0)) {
    fail("point volume: expected a lead-in of 0 to 100 mm, found ", options.lead_in_mm, " mm");
  }
  frame_ = PathFrame(path.entry_mm - options.lead_in_mm * path.direction(), path.direction());
  const double discs = std::max(1.0, std::round((options.lead_in_mm + path.length_mm()) / options.spacing_mm));
  if (!(discs * static_cast<double>(pattern_.point_count()) <= kMaxPoints)) {
    fail("point volume: expected at most ", kMaxPoints, " points, found ", discs, " discs of ", pattern_.point_count());
  }
  disc_count_ = static_cast<int>(discs);
  const std::size_t points = static_cast<std::size_t>(disc_count_) * pattern_.point_count();
  alive_.assign(points, 1);
  hu_.assign(points, 0);
}

std::size_t PointVolume::alive_count() const {
  return static_cast<std::size_t>(std::count(alive_.begin(), alive_.end(), std::uint8_t{1}));
}

void fill_volume(PointVolume& volume, const BoneSampler& bone, const Progress& progress) {
  const std::size_t per_disc = volume.pattern().point_count();
  ProgressCounter counter(progress, "filling the point volume", static_cast<std::size_t>(volume.disc_count()));
  tbb::parallel_for(0, volume.disc_count(), [&](int disc) {
    std::vector<Vec3> points_mm(per_disc);
    std::vector<float> distance_mm(per_disc);
    std::vector<float> hu(per_disc);
    for (std::size_t i = 0; i < per_disc; ++i) {
      points_mm[i] = volume.frame().to_patient(volume.point_in_path_mm(disc, i));
    }
    bone(points_mm, distance_mm, hu);
    const auto alive = volume.alive().subspan(volume.disc_start(disc), per_disc);
    const auto number = volume.hu().subspan(volume.disc_start(disc), per_disc);
    for (std::size_t i = 0; i < per_disc; ++i) {
      alive[i] = distance_mm[i] < 0.0F ? 1 : 0;
      if (std::isnan(hu[i])) {
        if (alive[i] != 0) fail("point volume: the CT number of a point inside the bone is not a number");
        number[i] = 0;
        continue;
      }
      number[i] = static_cast<std::int16_t>(std::lround(std::clamp(hu[i], -32768.0F, 32767.0F)));
    }
    counter.add();
  });
}

}  // namespace spinaltap
