#include "core/phantom/detail/trunk_bones.h"

#include <algorithm>
#include <cmath>

#include "core/phantom/detail/bone_group.h"
#include "core/phantom/detail/shape_solid.h"

namespace spinaltap {
namespace {

using shapes::BarKnot;
using shapes::BoneGroup;
using shapes::FlatBar;

/// Left bones of a place in the patient's frame, and their mirror images. Drawn after textbooks, mm at scale 1.
class BonePlacer {
 public:
  BonePlacer(const SpineOptions& options, const Vec3& origin_mm)
      : rotation_(rotation_from_degrees(options.tilt_deg)),
        origin_mm_(origin_mm),
        scale_(options.scale),
        weak_(options.osteoporosis) {}

  /// A row of bars through (x, y, z, thickness).
  void row(std::vector<FlatBar>& bars, std::vector<BarKnot> knots, const Vec3& thin, double flatness) const {
    for (BarKnot& knot : knots) knot = {scale_ * knot.place_mm, scale_ * knot.thickness_mm};
    shapes::add_bars(bars, knots, thin, flatness);
  }
  void ball(std::vector<FlatBar>& bars, const Vec3& centre, double radius_mm) const {
    bars.emplace_back(scale_ * centre, scale_ * (centre + Vec3(0.0, 0.0, 0.5)), Vec3::UnitX(), 2.0 * scale_ * radius_mm,
                      2.0 * scale_ * radius_mm, 1.0);
  }
  /// `side`: 1, or -1 for the mirror image; `is_paired`: across the midline.
  SpinePart part(const std::vector<FlatBar>& bars, double reach_mm, double side, bool is_paired,
                 const ShellBone& bone) const {
    SpinePart made;
    made.label = kOtherBoneLabel;
    const ShellBone used = weak_ ? ShellBone{0.6 * bone.cortex_mm, 0.85 * bone.cortex_hu, 0.35 * bone.core_hu} : bone;
    made.solid = std::make_shared<const ShapeSolid<BoneGroup>>(BoneGroup(bars, {}, reach_mm, is_paired), rotation_,
                                                               origin_mm_, side, used);
    return made;
  }

 private:
  Mat3 rotation_;
  Vec3 origin_mm_;
  double scale_;
  bool weak_;
};

constexpr ShellBone kFlatBone{1.1, 1100.0, 230.0}, kLongBone{4.5, 1400.0, 60.0}, kHeadBone{1.2, 1000.0, 320.0};

}  // namespace

void add_pelvis(const SpineOptions& options, const std::vector<PlacedLevel>& placed, std::vector<SpinePart>& parts) {
  constexpr double kCartilageMm = 3.0;
  const PlacedLevel& sacrum = *placed_level(placed, Level::kSacrum);
  const std::size_t sacrum_part = placed.size() - 1;
  const BonePlacer place(options, sacrum.position_mm);
  // Head and neck of the thigh, with the trochanter and the shaft.
  std::vector<FlatBar> thigh;
  place.ball(thigh, Vec3(88.0, -22.0, -88.0), 23.5);
  place.row(thigh, {{Vec3(92.0, -21.0, -92.0), 30.0}, {Vec3(128.0, -14.0, -118.0), 34.0}}, Vec3::UnitY(), 1.1);
  place.row(
      thigh,
      {{Vec3(130.0, -12.0, -112.0), 30.0}, {Vec3(132.0, -14.0, -150.0), 32.0}, {Vec3(126.0, -18.0, -260.0), 28.0}},
      Vec3::UnitX(), 1.0);
  // The wing of the hip bone is a fan from the socket to the crest.
  std::vector<FlatBar> hip;
  const Vec3 out(1.0, -0.45, 0.0);
  place.row(hip, {{Vec3(84.0, -18.0, -72.0), 30.0}, {Vec3(94.0, -12.0, -40.0), 13.0}, {Vec3(124.0, -18.0, 28.0), 10.0}},
            out, 2.6);
  place.row(hip, {{Vec3(86.0, -24.0, -68.0), 22.0}, {Vec3(118.0, -62.0, -18.0), 10.0}}, out, 2.4);
  place.row(hip, {{Vec3(84.0, -2.0, -60.0), 18.0}, {Vec3(76.0, 22.0, -22.0), 14.0}, {Vec3(94.0, 30.0, 22.0), 10.0}},
            out, 2.2);
  place.row(hip, {{Vec3(78.0, 10.0, -40.0), 16.0}, {Vec3(58.0, 46.0, -18.0), 14.0}}, out, 2.0);
  // The crest itself is thicker.
  place.row(hip,
            {{Vec3(118.0, -64.0, -18.0), 12.0},
             {Vec3(128.0, -40.0, 14.0), 12.0},
             {Vec3(122.0, -8.0, 34.0), 13.0},
             {Vec3(100.0, 24.0, 32.0), 13.0},
             {Vec3(74.0, 42.0, 12.0), 13.0},
             {Vec3(56.0, 52.0, -12.0), 13.0}},
            out, 1.2);
  // The socket's block, pubis and ischium.
  place.row(hip, {{Vec3(76.0, -20.0, -86.0), 52.0}, {Vec3(80.0, -14.0, -94.0), 50.0}}, Vec3::UnitX(), 1.1);
  place.row(hip, {{Vec3(72.0, -36.0, -84.0), 20.0}, {Vec3(34.0, -74.0, -92.0), 13.0}, {Vec3(7.0, -84.0, -108.0), 15.0}},
            Vec3::UnitZ(), 1.2);
  place.row(hip, {{Vec3(74.0, 2.0, -98.0), 26.0}, {Vec3(62.0, 6.0, -138.0), 24.0}}, Vec3::UnitX(), 1.3);
  place.row(hip, {{Vec3(60.0, 2.0, -142.0), 16.0}, {Vec3(32.0, -50.0, -136.0), 11.0}, {Vec3(8.0, -82.0, -116.0), 12.0}},
            Vec3::UnitX(), 1.3);
  for (const double side : {1.0, -1.0}) {
    parts.push_back(place.part(thigh, 8.0, side, false, kLongBone));
    SpinePart bone = place.part(hip, 8.0, side, false, kFlatBone);
    bone.cuts = {{parts.size() - 1, kCartilageMm}, {sacrum_part, std::max(options.rib_gap_mm, 1.5)}};
    parts.push_back(std::move(bone));
  }
}

void add_shoulders(const SpineOptions& options, const std::vector<PlacedLevel>& placed, std::vector<SpinePart>& parts) {
  constexpr double kCartilageMm = 3.0, kRibGapMm = 3.0;
  const PlacedLevel& t2 = *placed_level(placed, Level{9});
  const BonePlacer place(options, t2.position_mm);
  std::vector<FlatBar> arm;
  place.ball(arm, Vec3(160.0, -4.0, -8.0), 23.0);
  place.row(arm,
            {{Vec3(163.0, -5.0, -14.0), 40.0}, {Vec3(172.0, -6.0, -60.0), 25.0}, {Vec3(182.0, -2.0, -200.0), 22.0}},
            Vec3::UnitX(), 1.0);
  std::vector<FlatBar> blade;
  const Vec3 back(0.45, 1.0, 0.0);
  // A thin plate between the socket and the medial border, with a ridge that ends over the arm.
  place.row(blade, {{Vec3(136.0, 6.0, -12.0), 13.0}, {Vec3(118.0, 26.0, -30.0), 6.0}, {Vec3(88.0, 54.0, -40.0), 5.0}},
            back, 4.0);
  place.row(blade, {{Vec3(130.0, 14.0, -26.0), 11.0}, {Vec3(96.0, 56.0, -122.0), 7.0}}, back, 1.5);
  place.row(blade, {{Vec3(112.0, 34.0, -60.0), 5.0}, {Vec3(92.0, 56.0, -82.0), 5.0}}, back, 4.5);
  place.row(blade, {{Vec3(126.0, 18.0, -4.0), 6.0}, {Vec3(86.0, 46.0, 4.0), 5.0}}, back, 2.0);
  place.row(blade, {{Vec3(84.0, 50.0, 2.0), 6.0}, {Vec3(82.0, 56.0, -50.0), 6.0}, {Vec3(96.0, 58.0, -124.0), 8.0}},
            back, 1.3);
  place.row(blade,
            {{Vec3(86.0, 58.0, -20.0), 7.0},
             {Vec3(122.0, 50.0, 0.0), 9.0},
             {Vec3(152.0, 30.0, 22.0), 10.0},
             {Vec3(162.0, 4.0, 26.0), 9.0}},
            Vec3(0.0, 0.2, 1.0), 1.8);
  place.row(blade, {{Vec3(130.0, 2.0, 4.0), 10.0}, {Vec3(124.0, -22.0, 8.0), 9.0}, {Vec3(138.0, -34.0, 2.0), 10.0}},
            Vec3::UnitZ(), 1.3);
  std::vector<FlatBar> collar;
  place.row(collar,
            {{Vec3(20.0, -64.0, -18.0), 20.0},
             {Vec3(40.0, -68.0, -8.0), 12.0},
             {Vec3(90.0, -40.0, 16.0), 11.0},
             {Vec3(120.0, -14.0, 24.0), 11.0},
             {Vec3(148.0, -12.0, 26.0), 12.0}},
            Vec3::UnitZ(), 1.2);
  std::vector<FlatBar> breast;
  place.row(breast, {{Vec3(0.0, -62.0, -34.0), 14.0}, {Vec3(0.0, -78.0, -66.0), 12.0}}, Vec3::UnitY(), 3.2);
  place.row(breast,
            {{Vec3(0.0, -80.0, -72.0), 11.0}, {Vec3(0.0, -104.0, -140.0), 11.0}, {Vec3(0.0, -108.0, -168.0), 9.0}},
            Vec3::UnitY(), 2.8);
  const std::size_t ribs_begin = placed.size(), ribs_end = parts.size();
  for (const double side : {1.0, -1.0}) {
    parts.push_back(place.part(arm, 6.0, side, false, kHeadBone));
    SpinePart bone = place.part(blade, 4.0, side, false, kFlatBone);
    bone.cuts = {{parts.size() - 1, kCartilageMm}};
    for (std::size_t rib = ribs_begin; rib < ribs_end; ++rib) {
      if (parts[rib].label == kRibLabel) bone.cuts.push_back({rib, kRibGapMm});
    }
    parts.push_back(std::move(bone));
    parts.push_back(place.part(collar, 4.0, side, false, kFlatBone));
  }
  parts.push_back(place.part(breast, 4.0, 1.0, true, kFlatBone));
}

}  // namespace spinaltap
