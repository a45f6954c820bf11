#include "core/phantom/level_body.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/lerp.h"
#include "core/phantom/detail/shapes.h"

namespace spinaltap {

double segment_distance_mm(const Vec3& p, const Vec3& start, const Vec3& end) {
  const Vec3 along = end - start;
  const double share = std::clamp((p - start).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - start - share * along).norm();
}

LevelBody::LevelBody(std::shared_ptr<const Vertebra> vertebra, std::vector<Pit> pits, std::vector<ScrewRod> screws,
                     std::vector<CementLump> cement)
    : vertebra_(std::move(vertebra)), pits_(std::move(pits)), screws_(std::move(screws)), cement_(std::move(cement)) {}

double LevelBody::screw_value_mm(const Vec3& p) const {
  double value = std::numeric_limits<double>::infinity();
  for (const ScrewRod& screw : screws_) {
    value = std::min(value, segment_distance_mm(p, screw.head_mm, screw.tip_mm) - screw.radius_mm);
  }
  return value;
}

double LevelBody::value_mm(const Vec3& p) const {
  constexpr double kPitEdge = 0.8;
  double value = 0.0;
  vertebra_->evaluate({&p, 1}, {&value, 1}, {});
  for (const Pit& pit : pits_) {
    value = shapes::smooth_max(value, pit.radius_mm - (p - pit.centre_mm).norm(), kPitEdge);
  }
  return screws_.empty() ? value : std::min(value, screw_value_mm(p));
}

void LevelBody::evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm,
                         std::span<Vec3> gradients) const {
  for (std::size_t n = 0; n < points_mm.size(); ++n) {
    values_mm[n] = value_mm(points_mm[n]);
    if (gradients.empty()) continue;
    gradients[n] = shapes::slope_of([this](const Vec3& p) { return value_mm(p); }, points_mm[n]);
  }
}

Box3 LevelBody::bounds_mm() const {
  Box3 box = vertebra_->bounds_mm();
  for (const ScrewRod& screw : screws_) {
    for (const Vec3& end : {screw.head_mm, screw.tip_mm}) {
      box.extend(end - Vec3::Constant(screw.radius_mm)).extend(end + Vec3::Constant(screw.radius_mm));
    }
  }
  return box;
}

double LevelBody::hu(const Vec3& p_patient, double distance_mm, double aperture_mm) const {
  double bone = vertebra_->hu(p_patient, distance_mm, aperture_mm);
  for (const CementLump& lump : cement_) {
    const double depth_mm = lump.radius_mm - (p_patient - lump.centre_mm).norm();
    bone = lerp(bone, kCementHu, shapes::smooth_step(-0.8, 0.8, depth_mm));
  }
  if (screws_.empty()) return bone;
  const double value = screw_value_mm(p_patient);
  const double metal = aperture_mm > 0.0 ? std::clamp(0.5 - value / aperture_mm, 0.0, 1.0) : (value < 0.0 ? 1.0 : 0.0);
  return lerp(bone, kMetalHu, metal);
}

}  // namespace spinaltap
