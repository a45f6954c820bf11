#include "core/phantom/detail/upper_neck.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/phantom/detail/bone_group.h"
#include "core/phantom/detail/level_anatomy.h"

namespace spinaltap::shapes {
namespace {

/// A braincase: a shell around an ellipsoid, open below, with two condyles beside the opening.
class SkullShape {
 public:
  explicit SkullShape(double scale) : place_(skull_place(scale)) {
    wall_mm_ = 6.5 * scale;
    foramen_mm_ = 15.5 * scale;
    condyle_ = FlatBar(Vec3(15.0, -3.0, 12.0) * scale, Vec3(19.0, 6.0, 13.0) * scale, Vec3::UnitX(), 8.0 * scale,
                       8.0 * scale, 1.2);
    foramen_y_mm_ = 6.0 * scale;
  }

  template <class T>
  T operator()(const Point<T>& p) const {
    const Point<T> q = minus(p, place_.centre_mm);
    const Vec3& half = place_.half_mm;
    const T x = q.x * (1.0 / half.x()), y = q.y * (1.0 / half.y()), z = q.z * (1.0 / half.z());
    const T shell = magnitude((root(x * x + y * y + z * z) - 1.0) * half.minCoeff()) - 0.5 * wall_mm_;
    const T away_y = p.y - foramen_y_mm_;
    const T opening = foramen_mm_ - root(p.x * p.x + away_y * away_y);
    // Below the middle only.
    const T hole = value_of(q.z) > 0.0 ? shell : smooth_max(shell, opening, 3.0);
    return smooth_min(hole, condyle_(Point<T>{soft_magnitude(p.x, 0.8), p.y, p.z}), 3.0);
  }

  Box3 bounds() const {
    const Vec3 half = place_.half_mm + Vec3::Constant(wall_mm_);
    Box3 box(place_.centre_mm - half * 1.05, place_.centre_mm + half * 1.05);
    return box.extend(condyle_.bounds());
  }

 private:
  SkullPlace place_;
  double wall_mm_, foramen_mm_, foramen_y_mm_;
  FlatBar condyle_;
};

}  // namespace
}  // namespace spinaltap::shapes

namespace spinaltap {
namespace {

using shapes::BoneGroup;
using shapes::FlatBar;
using shapes::RoundPlate;

std::shared_ptr<const Solid> placed_group(BoneGroup group, const PlacedLevel& level, const ShellBone& bone) {
  return std::make_shared<const ShapeSolid<BoneGroup>>(std::move(group), level.rotation, level.position_mm, 1.0, bone);
}

}  // namespace

LevelMeasures upper_neck_measures(Level level) {
  LevelMeasures m = level_measures(kFirstMeasured);
  m.wedge_deg = 0.0;
  m.canal_width_mm = 24.0;
  m.canal_depth_mm = 18.0;
  if (level == Level{2}) {
    m.body_width_mm = 17.0;
    m.body_depth_mm = 15.0;
    m.body_height_mm = 18.0;
    m.spinous_length_mm = 20.0;
    m.disc_below_mm = 4.8;
    m.flexion_deg = -5.0;
  } else if (level == Level::kC1) {
    m.body_width_mm = 30.0;
    m.body_depth_mm = 14.0;
    m.body_height_mm = 14.0;
    m.spinous_length_mm = 6.0;
    m.flexion_deg = -8.0;
  } else {
    fail("spine phantom: ", level_name(level), " is no level of the upper neck");
  }
  return m;
}

std::shared_ptr<const Solid> make_atlas(const PlacedLevel& atlas, double scale, const ShellBone& bone) {
  std::vector<FlatBar> bars;
  const auto at = [&](double x, double y, double z) { return Vec3(scale * Vec3(x, y, z)); };
  bars.emplace_back(at(17.0, 1.0, -0.5), at(17.5, 2.0, 4.5), Vec3::UnitX(), 10.0 * scale, 11.0 * scale, 1.35);
  shapes::add_bars(
      bars, {{at(15.0, -4.0, 0.5), 6.0 * scale}, {at(8.0, -9.5, 1.0), 5.0 * scale}, {at(0.0, -10.8, 1.0), 6.0 * scale}},
      Vec3::UnitY(), 1.6);
  shapes::add_bars(bars,
                   {{at(17.5, 6.0, 2.5), 6.0 * scale},
                    {at(14.5, 15.0, 3.0), 4.5 * scale},
                    {at(7.0, 22.5, 2.0), 5.0 * scale},
                    {at(0.0, 25.0, 1.0), 6.0 * scale}},
                   Vec3(0.4, 1.0, 0.0), 1.5);
  shapes::add_bars(bars, {{at(20.0, 3.0, 1.0), 6.5 * scale}, {at(35.0, 5.0, -1.0), 6.0 * scale}}, Vec3::UnitZ(), 1.2);
  return placed_group(BoneGroup(bars, {}, 2.5, true), atlas, bone);
}

std::shared_ptr<const Solid> make_axis(const PlacedLevel& axis, const PlacedLevel& below, double scale,
                                       const ShellBone& bone) {
  std::vector<FlatBar> bars;
  const auto at = [&](double x, double y, double z) { return Vec3(scale * Vec3(x, y, z)); };
  const LevelMeasures& m = axis.measures;
  const RoundPlate body(Vec3::Zero(), {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()},
                        0.5 * Vec3(m.body_width_mm, m.body_depth_mm, m.body_height_mm), 0.22 * m.body_height_mm);
  // The dens, the shoulders that carry C1, the bridges to the pillars.
  bars.emplace_back(at(0.0, -1.0, 5.0), at(0.0, -2.2, 22.0), Vec3::UnitX(), 10.5 * scale, 9.5 * scale, 1.1);
  bars.emplace_back(at(7.0, 1.0, 5.0), at(17.0, 2.5, 5.5), Vec3::UnitZ(), 8.0 * scale, 7.0 * scale, 1.7);
  const FacetPlace facet = superior_facet(below.measures);
  const Mat3 turn = axis.rotation.transpose() * below.rotation;
  Vec3 tip = turn * (facet.centre_mm + 2.0 * facet.normal) +
             axis.rotation.transpose() * (below.position_mm - axis.position_mm);
  tip.z() += 1.0;
  shapes::add_bars(bars, {{at(16.0, 4.0, 3.0), 8.0 * scale}, {at(19.5, 11.0, -4.0), 8.0 * scale}, {tip, 6.0 * scale}},
                   Vec3(0.0, 0.7, 0.7), 1.4);
  shapes::add_bars(
      bars,
      {{at(18.5, 13.0, -4.0), 5.0 * scale}, {at(8.0, 21.5, -5.0), 5.0 * scale}, {at(0.0, 26.0, -5.5), 7.0 * scale}},
      Vec3(0.55, 1.0, 0.25), 2.2);
  bars.emplace_back(at(0.0, 26.0, -5.5), at(2.5, 40.0, -10.0), Vec3::UnitX(), 7.0 * scale, 7.0 * scale, 1.6);
  bars.emplace_back(at(17.0, 5.0, 0.0), at(27.0, 7.0, -5.0), Vec3(-0.25, 1.0, 0.1), 5.0 * scale, 4.5 * scale, 1.3);
  return placed_group(BoneGroup(bars, {body}, 3.0, true), axis, bone);
}

SkullPlace skull_place(double scale) { return {scale * Vec3(0.0, -24.0, 77.0), scale * Vec3(69.0, 88.0, 66.0)}; }

std::shared_ptr<const Solid> make_skull(const PlacedLevel& atlas, double scale, const ShellBone& bone) {
  return std::make_shared<const ShapeSolid<shapes::SkullShape>>(shapes::SkullShape(scale), atlas.rotation,
                                                                atlas.position_mm, 1.0, bone);
}

std::shared_ptr<const Solid> make_jaw(const PlacedLevel& atlas, double scale) {
  // Bone and teeth in one: brighter than either bone.
  constexpr ShellBone kToothed{2.5, 1500.0, 700.0};
  std::vector<FlatBar> bars;
  const auto at = [&](double x, double y, double z) { return Vec3(scale * Vec3(x, y, z)); };
  shapes::add_bars(bars, {{at(48.0, -28.0, 8.0), 8.0 * scale}, {at(44.0, -38.0, -38.0), 10.0 * scale}}, Vec3::UnitX(),
                   2.6);
  shapes::add_bars(bars,
                   {{at(44.0, -38.0, -40.0), 11.0 * scale},
                    {at(30.0, -72.0, -46.0), 12.0 * scale},
                    {at(13.0, -95.0, -48.0), 12.0 * scale},
                    {at(0.0, -99.0, -48.0), 12.0 * scale}},
                   Vec3(1.0, 0.3, 0.0), 2.0);
  shapes::add_bars(bars,
                   {{at(27.0, -62.0, -14.0), 12.0 * scale},
                    {at(13.0, -90.0, -16.0), 12.0 * scale},
                    {at(0.0, -95.0, -16.0), 11.0 * scale}},
                   Vec3(1.0, 0.3, 0.0), 1.6);
  return placed_group(BoneGroup(bars, {}, 4.0, true), atlas, kToothed);
}

std::vector<Spur> cervical_spurs(const PlacedLevel& level, const VertebraAnatomy& anatomy, const PlacedLevel* above) {
  constexpr double kJointGapMm = 0.9;
  const LevelMeasures& m = level.measures;
  const auto to_patient = [&](const Vec3& p) { return Vec3(level.rotation * p + level.position_mm); };
  const Vec3 up = level.rotation.col(2);
  const double far_mm = level.position_mm.dot(up) + 1e3;  // a plane that cuts nothing
  const double half_width = 0.5 * m.body_width_mm, half_depth = 0.5 * m.body_depth_mm,
               half_height = 0.5 * m.body_height_mm;
  std::vector<Spur> spurs;
  for (const double side : {1.0, -1.0}) {
    const auto rod = [&](const Vec3& from, const Vec3& to, double radius_mm) {
      spurs.push_back({to_patient(from.cwiseProduct(Vec3(side, 1.0, 1.0))),
                       to_patient(to.cwiseProduct(Vec3(side, 1.0, 1.0))), radius_mm, up, far_mm});
    };
    // The uncinate process stands on the rim and ends below the body above.
    rod({half_width + 0.2, 0.55 * half_depth, half_height - 0.2},
        {half_width - 1.0, -0.45 * half_depth, half_height - 0.8}, 0.15 * m.body_width_mm);
    if (above != nullptr) {
      const Vec3 normal = (above->rotation.col(2) + up).normalized();
      const Vec3 bottom = above->position_mm - 0.5 * above->measures.body_height_mm * above->rotation.col(2);
      spurs.back().plane_normal = normal;
      spurs.back().plane_offset_mm = normal.dot(bottom) - kJointGapMm;
    }
    if (level.level == Level::kC7) continue;  // its spinous process has one end, its foramen is small
    const Vec3& tip = anatomy.transverse.tip_mm;
    rod({half_width - 0.5, -0.1 * half_depth, -0.5}, {tip.x() - 2.5, tip.y() - 4.5, tip.z() - 1.5}, 1.9);
    rod({tip.x() - 2.5, tip.y() - 4.5, tip.z() - 1.5}, {tip.x(), tip.y(), tip.z()}, 2.0);
    const auto& outline = anatomy.spinous.outline_mm;
    const Eigen::Vector2d end = 0.5 * (outline[1] + outline[3]);
    const Eigen::Vector2d along = (outline[2] - end).normalized();
    const Eigen::Vector2d start = end - 3.0 * along, tine = end + 1.5 * along;
    rod({0.5, start.x(), start.y()}, {4.2, tine.x(), tine.y() - 1.0}, 2.2);
  }
  return spurs;
}

}  // namespace spinaltap
