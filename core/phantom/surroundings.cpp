#include "core/phantom/surroundings.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/lerp.h"
#include "core/base/random.h"
#include "core/phantom/detail/shapes.h"
#include "core/phantom/detail/texture.h"
#include "core/phantom/detail/upper_neck.h"
#include "core/phantom/spine_ground_truth.h"

namespace spinaltap {
namespace {

constexpr double kSoftMm = 0.8;  ///< over which one tissue goes over into the next

double inside(double distance_mm, double soft_mm = kSoftMm) { return shapes::inside(distance_mm, soft_mm); }

/// Roughly the distance from an ellipse with these half axes.
double ellipse_mm(double x, double y, double half_x, double half_y) {
  return (std::hypot(x / half_x, y / half_y) - 1.0) * std::min(half_x, half_y);
}

}  // namespace

SoftTissue::SoftTissue(const Spine& spine, const SoftTissueOptions& options) : options_(options) {
  if (spine.placed().empty()) fail("soft tissue: a spine made from SpineOptions expected, found other bodies");
  for (const PlacedLevel& placed : spine.placed()) {
    const LevelMeasures& m = placed.measures;
    const double half_depth = 0.5 * m.body_depth_mm;
    const bool thoracic = level_rank(placed.level) <= level_rank(Level::kT12);
    const bool cervical = level_rank(placed.level) < level_rank(Level::kT1);
    const double low = placed.level == Level::kT12 ? 0.25 : placed.level == Level{18} ? 0.7 : 1.0;
    stations_.push_back({placed.position_mm, placed.rotation, 0.5 * m.body_width_mm, half_depth, 0.5 * m.canal_width_mm,
                         0.5 * m.canal_depth_mm, half_depth + 0.5 * m.canal_depth_mm,
                         half_depth + m.canal_depth_mm + m.spinous_length_mm * std::cos(m.spinous_drop_deg * kDegree),
                         thoracic && !cervical ? low : 0.0, cervical ? 1.0 : 0.0});
  }
  const PlacedLevel& top = spine.placed().front();
  if (top.level == Level::kC1) {
    const double scale = top.measures.body_width_mm / upper_neck_measures(Level::kC1).body_width_mm;
    const SkullPlace skull = skull_place(scale);
    const Vec3 half = skull.half_mm + Vec3::Constant(9.0);
    head_ = Disc{top.position_mm + top.rotation * skull.centre_mm, top.rotation, half.x(), half.y(), half.z()};
  }
  for (const DiscGroundTruth& disc : spine_ground_truth(spine).discs) {
    // Frame: the disc's normal up, backward as far as that leaves it.
    const Vec3 back = (Vec3::UnitY() - disc.normal.y() * disc.normal).normalized();
    Mat3 rotation;
    rotation << back.cross(disc.normal), back, disc.normal;
    discs_.push_back({disc.centre_mm, rotation, 0.5 * disc.width_mm, 0.5 * disc.depth_mm, 0.5 * disc.height_mm});
  }
}

/// Between the stations above and below; their rotations are those of the nearer one.
SoftTissue::Station SoftTissue::at_height(double z_mm) const {
  if (z_mm >= stations_.front().centre_mm.z()) return stations_.front();
  for (std::size_t n = 1; n < stations_.size(); ++n) {
    const Station& a = stations_[n - 1];
    const Station& b = stations_[n];
    if (z_mm < b.centre_mm.z()) continue;
    const double t = (a.centre_mm.z() - z_mm) / (a.centre_mm.z() - b.centre_mm.z());
    const auto mix = [&](double x, double y) { return lerp(x, y, t); };
    return {(1.0 - t) * a.centre_mm + t * b.centre_mm,
            t < 0.5 ? a.rotation : b.rotation,
            mix(a.half_width_mm, b.half_width_mm),
            mix(a.half_depth_mm, b.half_depth_mm),
            mix(a.canal_half_width_mm, b.canal_half_width_mm),
            mix(a.canal_half_depth_mm, b.canal_half_depth_mm),
            mix(a.canal_y_mm, b.canal_y_mm),
            mix(a.back_mm, b.back_mm),
            mix(a.lung, b.lung),
            mix(a.neck, b.neck)};
  }
  return stations_.back();
}

/// `hu` as the neck has it: muscle for the aorta, a windpipe, air around an outline that widens to the shoulders.
double SoftTissue::in_neck_hu(double hu, const Vec3& p, const Station& here) const {
  constexpr double kAirHu = -1000.0;
  const double x = p.x() - here.centre_mm.x(), y = p.y() - here.centre_mm.y();
  const double front = -here.half_depth_mm;
  double neck = hu;
  neck = lerp(neck, options_.muscle_hu, inside(ellipse_mm(x, y - front + 16.0, 26.0, 14.0), 2.0));
  neck = lerp(neck, kAirHu + 30.0, inside(ellipse_mm(x, y - front + 22.0, 9.0, 8.0)));
  // Great vessels at both sides.
  for (const double side : {1.0, -1.0}) {
    neck = lerp(neck, 0.5 * (options_.aorta_hu + options_.muscle_hu),
                inside(std::hypot(x - side * 27.0, y - front + 14.0) - 4.5));
  }
  neck = lerp(hu, neck, shapes::smooth_step(0.0, 1.0, here.neck));
  // It widens to the shoulders.
  const double shoulder = 1.0 - here.neck;
  double outline = ellipse_mm(x, y + 4.0 + 20.0 * shoulder, 63.0 + 130.0 * shoulder, 68.0 + 55.0 * shoulder);
  if (head_) {
    const Vec3 q = head_->rotation.transpose() * (p - head_->centre_mm);
    const Vec3 half(head_->half_width_mm, head_->half_depth_mm, head_->half_height_mm);
    const double head = (q.cwiseQuotient(half).norm() - 1.0) * half.minCoeff();
    // A face and jaws below the front of the braincase.
    const Vec3 f = q - Vec3(0.0, -0.42 * half.y(), -1.0 * half.z());
    const double face =
        (f.cwiseQuotient(Vec3(0.82 * half.x(), 0.62 * half.y(), 1.1 * half.z())).norm() - 1.0) * 0.6 * half.x();
    outline = std::min({outline, head, face});
    if (p.z() > here.centre_mm.z() + 30.0) outline = std::min(head, face);
    neck = lerp(neck, options_.muscle_hu - 18.0, inside(head + 11.0));  // the brain
  }
  neck = lerp(neck, options_.fat_hu, inside(-outline - 4.0, 1.5));
  neck = lerp(neck, 30.0, inside(-outline - 1.5));
  neck = lerp(neck, kAirHu, inside(-outline));
  return neck;
}

double SoftTissue::hu(const Vec3& p) const {
  constexpr double kAirHu = -1000.0;
  const Station here = at_height(p.z());
  // Sidewise and backward from the column's middle at this height.
  const double x = p.x() - here.centre_mm.x(), y = p.y() - here.centre_mm.y();
  const double side = std::fabs(x);
  // Muscle, with patches of fat.
  static const Vec3 kGrain(9.0, 9.0, 14.0);
  const Texture patches(kGrain, options_.seed);
  double hu = lerp(options_.muscle_hu, options_.fat_hu, 0.8 * shapes::smooth_step(0.9, 1.5, patches.at(p)));
  // Fat in front of the column, between the organs.
  const double in_front = inside(y + here.half_depth_mm + 4.0, 4.0) * (1.0 - here.lung);
  hu = lerp(hu, options_.fat_hu, 0.75 * in_front);
  // Lungs: beside and in front of the bodies, the mediastinum between them.
  if (here.lung > 0.0) {
    const double mediastinum = 24.0 + 0.35 * std::max(0.0, -y - here.half_depth_mm);
    const double lung = std::max({mediastinum - side, ellipse_mm(side - 50.0, y + 45.0, 62.0, 85.0), y - 26.0});
    hu = lerp(hu, options_.lung_hu, inside(lung, 1.5) * here.lung);
  }
  // Fat under the skin, the skin, air behind it.
  const double depth = here.back_mm + options_.skin_mm - y - 0.0025 * side * side;
  hu = lerp(hu, options_.fat_hu, inside(depth - 0.6 * options_.skin_mm, 2.0));
  hu = lerp(hu, 30.0, inside(depth - 2.0));
  hu = lerp(hu, kAirHu, inside(depth));
  // The aorta, to the left in front.
  constexpr double kAortaMm = 11.5;
  const double aorta = std::hypot(x - 11.0, y + here.half_depth_mm + kAortaMm + 1.5) - kAortaMm;
  hu = lerp(hu, options_.aorta_hu, inside(aorta));
  if (here.neck > 0.0) hu = in_neck_hu(hu, p, here);
  // Muscle next to the bodies in front of the ribs: ligaments and vessels rather than lung.
  const double cuff = ellipse_mm(x, y, here.half_width_mm + 3.0, here.half_depth_mm + 3.0);
  if (aorta > 0.0 || here.neck > 0.0) hu = lerp(hu, 50.0, inside(cuff));
  for (const Disc& disc : discs_) {
    if (std::fabs(p.z() - disc.centre_mm.z()) > 40.0) continue;
    const Vec3 q = disc.rotation.transpose() * (p - disc.centre_mm);
    // Endplates are hollow, so a disc is thicker in its middle than between the rims; bone lies over the rest.
    const double wall = ellipse_mm(q.x(), q.y(), disc.half_width_mm + 0.5, disc.half_depth_mm + 0.5);
    const double height = std::fabs(q.z()) - disc.half_height_mm - 4.0;
    hu = lerp(hu, options_.disc_hu, inside(std::max(wall, height)));
  }
  const double canal = ellipse_mm(x, y - here.canal_y_mm, here.canal_half_width_mm, here.canal_half_depth_mm);
  return lerp(hu, options_.canal_hu, inside(canal));
}

}  // namespace spinaltap
