#include "core/phantom/trunk_tissue.h"

#include <algorithm>
#include <cmath>

#include "core/base/lerp.h"
#include "core/phantom/detail/check_within.h"
#include "core/phantom/detail/shapes.h"
#include "core/phantom/detail/texture.h"
#include "core/phantom/spine_ground_truth.h"

namespace spinaltap {
namespace {

constexpr double kRoomAirHu = -1000.0;

/// Where a level's body stands, or would stand: beyond the ends of the spine, 20 to 37 mm a level.
Vec3 place_of(const Spine& spine, Level level) {
  const std::vector<PlacedLevel>& placed = spine.placed();
  if (const PlacedLevel* const found = placed_level(placed, level)) return found->position_mm;
  const bool is_above = level_rank(level) < level_rank(placed.front().level);
  const PlacedLevel& end = is_above ? placed.front() : placed.back();
  const double steps = 0.5 * (level_rank(end.level) - level_rank(level));
  const double step_mm = level_rank(level) > level_rank(Level::kT12) ? 36.0 : is_above ? 24.0 : 28.0;
  return end.position_mm + Vec3(0.0, 0.0, steps * step_mm);
}

double ellipsoid_mm(const Vec3& p, const Vec3& centre_mm, const Vec3& half_mm) {
  return ((p - centre_mm).cwiseQuotient(half_mm).norm() - 1.0) * half_mm.minCoeff();
}

void check_trunk(const TrunkTissueOptions& options) {
  const auto check = [](const char* name, double value, double low, double high) {
    check_within("trunk", name, value, low, high);
  };
  check("half_width_mm", options.half_width_mm, 100.0, 300.0);
  check("front_mm", options.front_mm, 100.0, 300.0);
  check("shoulder_mm", options.shoulder_mm, 0.0, 120.0);
  check("kidney_hu", options.kidney_hu, -50.0, 500.0);
  check("pelvis_of_kidney_hu", options.pelvis_of_kidney_hu, -50.0, 3000.0);
  check("gas_share", options.gas_share, 0.0, 1.0);
}

}  // namespace

TrunkTissue::TrunkTissue(const Spine& spine, const TrunkTissueOptions& options)
    : soft_(spine, options.soft), options_(options) {
  check_trunk(options);
  const Vec3 t2 = place_of(spine, Level{9}), t7 = place_of(spine, Level{14}), t9 = place_of(spine, Level{16});
  const Vec3 t12 = place_of(spine, Level::kT12), l2 = place_of(spine, Level{21}), l4 = place_of(spine, Level{23});
  shoulder_z_mm_ = t2.z() + 10.0;
  abdomen_z_mm_ = t12.z() - 10.0;
  const double muscle = options.soft.muscle_hu, blood = 0.5 * (options.soft.aorta_hu + muscle);
  organs_.push_back({t7 + Vec3(18.0, -78.0, -8.0), Vec3(58.0, 42.0, 56.0), blood, 3.0});             // heart
  organs_.push_back({t12 + Vec3(-75.0, -62.0, -12.0), Vec3(72.0, 72.0, 62.0), muscle + 10.0, 2.0});  // liver
  organs_.push_back({t12 + Vec3(98.0, -8.0, 0.0), Vec3(28.0, 42.0, 48.0), muscle + 5.0, 2.0});       // spleen
  for (const double side : {1.0, -1.0}) {
    const Vec3 kidney = l2 + Vec3(side * 64.0, 6.0, side * 8.0 + 12.0);
    organs_.push_back({kidney, Vec3(36.0, 32.0, 66.0), options.soft.fat_hu, 3.0});
    organs_.push_back({kidney, Vec3(25.0, 21.0, 54.0), options.kidney_hu, 1.5});
    organs_.push_back({kidney - Vec3(side * 12.0, 3.0, 0.0), Vec3(9.0, 8.0, 18.0), options.pelvis_of_kidney_hu, 1.5});
    organs_.push_back({l4 + Vec3(side * 42.0, -12.0, -6.0), Vec3(20.0, 24.0, 90.0), muscle, 3.0});  // psoas
  }
  if (options.stent) stent_ = Stent{l2.z(), t9.z()};
  if (options.pacemaker) {
    const std::vector<Vec3> way{t2 + Vec3(88.0, -72.0, -20.0),  t2 + Vec3(50.0, -58.0, -6.0),
                                t2 + Vec3(-14.0, -56.0, -20.0), t7 + Vec3(-24.0, -62.0, 44.0),
                                t7 + Vec3(-18.0, -74.0, -8.0),  t7 + Vec3(34.0, -96.0, -36.0)};
    for (std::size_t n = 1; n < way.size(); ++n) wires_.push_back({way[n - 1], way[n], 1.0});
    case_ = Organ{t2 + Vec3(96.0, -92.0, -30.0), Vec3(24.0, 7.0, 22.0), kMetalHu, 1.0};
  }
  double back_mm = -1e9;
  for (const PlacedLevel& placed : spine.placed()) {
    const SoftTissue::Station here = soft_.at_height(placed.position_mm.z());
    back_mm = std::max(back_mm, here.centre_mm.y() + here.back_mm);
    middle_x_mm_ += here.centre_mm.x() / static_cast<double>(spine.placed().size());
  }
  table_y_mm_ = back_mm + options.soft.skin_mm + 3.0;
}

/// Air and the table.
double TrunkTissue::behind_hu(const Vec3& p) const {
  if (!options_.table) return kRoomAirHu;
  constexpr double kBendMm = 450.0, kShellMm = 1.2, kThickMm = 42.0, kShellHu = 60.0, kFoamHu = -930.0;
  const double x = p.x() - middle_x_mm_;
  if (std::fabs(x) > 230.0) return kRoomAirHu;
  // The lower shell is flatter: the table thins out to its edges.
  const double upper = p.y() - (table_y_mm_ - x * x / (2.0 * kBendMm));
  const double lower = p.y() - (table_y_mm_ + kThickMm - x * x / (1.2 * kBendMm));
  double hu = upper > 0.0 && lower < 0.0 ? kFoamHu : kRoomAirHu;
  for (const double shell : {upper, lower}) hu = lerp(hu, kShellHu, shapes::inside(std::fabs(shell) - kShellMm, 0.6));
  return hu;
}

double TrunkTissue::organs_hu(double hu, const Vec3& p) const {
  for (const Organ& organ : organs_) {
    if (((p - organ.centre_mm).cwiseAbs() - organ.half_mm).maxCoeff() > organ.soft_mm) continue;
    hu = lerp(hu, organ.hu, shapes::inside(ellipsoid_mm(p, organ.centre_mm, organ.half_mm), organ.soft_mm));
  }
  return hu;
}

double TrunkTissue::metal_hu(double hu, const Vec3& p, const SoftTissue::Station& here) const {
  for (const ScrewRod& wire : wires_) {
    const double away = segment_distance_mm(p, wire.head_mm, wire.tip_mm) - wire.radius_mm;
    if (away < 1.0) hu = lerp(hu, kMetalHu, shapes::inside(away, 0.7));
  }
  if (case_) hu = lerp(hu, kMetalHu, shapes::inside(ellipsoid_mm(p, case_->centre_mm, case_->half_mm), 1.0));
  if (stent_ && p.z() > stent_->low_mm && p.z() < stent_->high_mm) {
    constexpr double kAortaMm = 11.5, kRingMm = 9.0, kZigMm = 6.0, kWireMm = 0.5;
    constexpr int kTeeth = 8;
    const double x = p.x() - here.centre_mm.x() - 11.0,
                 y = p.y() - here.centre_mm.y() + here.half_depth_mm + kAortaMm + 1.5;
    const double off = std::hypot(x, y) - kAortaMm;
    if (std::fabs(off) < 2.5) {
      // Rings of zigzag wire: how far the place lies above the ring's wire at its angle.
      const double zig = 0.5 * kZigMm * std::cos(kTeeth * std::atan2(y, x));
      const double up = std::remainder(p.z() - zig, kRingMm);
      // A zigzag runs steeply: its wire is nearer than straight up.
      hu = lerp(hu, kMetalHu, shapes::inside(std::hypot(off, 0.5 * up) - kWireMm, 0.7));
    }
  }
  return hu;
}

double TrunkTissue::hu(const Vec3& p) const {
  const SoftTissue::Station here = soft_.at_height(p.z());
  const double x = p.x() - here.centre_mm.x(), y = p.y() - here.centre_mm.y();
  // The outline: an oval between the skin in front and the one behind.
  const double below_neck = 1.0 - here.neck;
  const double at_shoulder = 1.0 - shapes::smooth_step(15.0, 110.0, std::fabs(p.z() - shoulder_z_mm_));
  const double back = here.back_mm + options_.soft.skin_mm;
  const double half_x = options_.half_width_mm + options_.shoulder_mm * at_shoulder;
  const double half_y =
      0.5 * (back + options_.front_mm * lerp(0.6, 1.0, shapes::smooth_step(-20.0, 150.0, shoulder_z_mm_ - p.z())));
  const double u = std::fabs(x) / half_x, v = std::fabs(y - back + half_y) / half_y;
  const double oval = (std::sqrt(std::sqrt(u * u * u * u + v * v * v * v)) - 1.0) * std::min(half_x, half_y) * 0.7;
  if (here.neck <= 0.0 && oval > 3.0) return behind_hu(p);
  double hu = soft_.hu(p);
  if (below_neck > 0.0) {
    // Bowels: loops with gas, in fat.
    constexpr double kGasHu = -900.0, kWallHu = 35.0;
    if (p.z() < abdomen_z_mm_ && y < -here.half_depth_mm - 32.0) {
      static const Vec3 kLoopMm(24.0, 24.0, 30.0);
      const double loop = Texture(kLoopMm, options_.soft.seed + 5).at(p);
      double bowel = lerp(options_.soft.fat_hu, kWallHu, shapes::smooth_step(-0.3, 0.1, loop));
      const double gas_from = lerp(2.5, 0.5, options_.gas_share);
      bowel = lerp(bowel, kGasHu, shapes::smooth_step(gas_from, gas_from + 0.15, loop));
      hu = lerp(hu, bowel, shapes::smooth_step(0.0, 8.0, -here.half_depth_mm - 32.0 - y));
    }
    // Organs stand before the column and its muscles.
    hu = organs_hu(hu, p);
    hu = lerp(hu, options_.soft.fat_hu, shapes::inside(-oval - 14.0, 2.5) * below_neck);
    hu = lerp(hu, 20.0, shapes::inside(-oval - 2.0, 0.8) * below_neck);
    if (oval > -2.0 && here.neck <= 0.0) hu = lerp(hu, behind_hu(p), shapes::inside(-oval, 0.8));
  }
  hu = metal_hu(hu, p, here);
  // Behind the skin of the neck and back, where SoftTissue has air.
  return hu < -980.0 && y > 0.0 ? behind_hu(p) : hu;
}

}  // namespace spinaltap
