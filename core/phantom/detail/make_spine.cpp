#include "core/phantom/detail/make_spine.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error.h"
#include "core/base/lerp.h"
#include "core/base/random.h"
#include "core/phantom/detail/level_anatomy.h"
#include "core/phantom/detail/rib.h"
#include "core/phantom/detail/shape_solid.h"
#include "core/phantom/detail/shapes.h"
#include "core/phantom/detail/trunk_bones.h"
#include "core/phantom/detail/upper_neck.h"
#include "core/phantom/level_measures.h"
#include "core/phantom/vertebra_ground_truth.h"

namespace spinaltap::shapes {
namespace {

/// A simple sacrum in the frame of its first segment's body: a wedge that bends backward, wings to both sides, two
/// superior articular processes, a back wall with a crest behind the canal.
class SacrumShape {
 public:
  /// `measures`: of the first segment, for its endplate, canal and facets.
  explicit SacrumShape(const LevelMeasures& measures);

  template <class T>
  T operator()(const Point<T>& p) const {
    const Point<T> side{soft_magnitude(p.x, 1.0), p.y, p.z};
    T f = smooth_min(body_(p), wing_(side), 6.0);
    f = smooth_min(f, lower_(p), 8.0);
    f = smooth_min(f, back_(side), 4.0);
    f = smooth_min(f, strut_(side), 3.0);
    f = smooth_min(f, process_(side), 3.0);
    return smooth_min(f, crest_(p), 3.0);
  }

  const Box3& bounds() const { return bounds_; }

 private:
  RoundPlate body_;
  FlatBar wing_, lower_, back_, strut_, process_, crest_;
  Box3 bounds_;
};

SacrumShape::SacrumShape(const LevelMeasures& m) {
  const double by = m.body_width_mm / 50.0;
  const double half_height = 0.5 * m.body_height_mm, half_depth = 0.5 * m.body_depth_mm;
  body_ = RoundPlate(Vec3::Zero(), {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()},
                     Vec3(0.5 * m.body_width_mm, half_depth, half_height), 0.35 * half_height);
  wing_ =
      FlatBar(Vec3(16.0, 4.0, -1.0) * by, Vec3(44.0, 12.0, -12.0) * by, Vec3(0.2, 1.0, 0.2), 20.0 * by, 22.0 * by, 1.5);
  lower_ =
      FlatBar(Vec3(0.0, 3.0, -12.0) * by, Vec3(0.0, 32.0, -70.0) * by, Vec3(0.0, 1.0, 0.5), 22.0 * by, 7.0 * by, 2.4);
  const FacetPlace facet = superior_facet(m);
  constexpr double kProcessMm = 7.0;
  const Vec3 tip = facet.centre_mm - 0.5 * kProcessMm * facet.normal;
  process_ = FlatBar(Vec3(tip.x() + 1.0, tip.y() - 1.0, 2.0), tip, facet.normal, 9.0 * by, kProcessMm, 1.5);
  // From the wings' back to the processes, and from these to the crest, around the canal.
  strut_ =
      FlatBar(Vec3(26.0, 10.0, -4.0) * by, Vec3(tip.x() + 1.0, tip.y(), 2.0), Vec3::UnitX(), 9.0 * by, 8.0 * by, 1.5);
  const double back_y = half_depth + m.canal_depth_mm + 4.0;
  back_ =
      FlatBar(Vec3(tip.x() + 1.0, tip.y(), 0.0), Vec3(0.0, back_y + 3.0, -8.0), Vec3::UnitY(), 6.0 * by, 6.0 * by, 2.5);
  crest_ =
      FlatBar(Vec3(0.0, back_y + 4.0, -6.0), Vec3(0.0, back_y + 12.0, -20.0), Vec3::UnitX(), 5.0 * by, 6.0 * by, 2.0);
  for (const Box3& box : {body_.bounds(), wing_.bounds(), lower_.bounds(), back_.bounds(), strut_.bounds(),
                          process_.bounds(), crest_.bounds()}) {
    bounds_.extend(Box3(box.min() - Vec3::Constant(2.0), box.max() + Vec3::Constant(2.0)));
  }
  bounds_.extend(Vec3(-bounds_.max().x(), bounds_.min().y(), bounds_.min().z()));
}

}  // namespace
}  // namespace spinaltap::shapes

namespace spinaltap {
namespace {

Vec3 mirrored(const Vec3& v) { return {-v.x(), v.y(), v.z()}; }

/// The superior facet of the level below, in the frame of the one above: the mean of the left one and the right one's
/// mirror image.
FacetPlace facet_from_above(const PlacedLevel& above, const PlacedLevel& below) {
  const FacetPlace facet = superior_facet(below.measures);
  const Mat3 turn = above.rotation.transpose() * below.rotation;
  const Vec3 shift = above.rotation.transpose() * (below.position_mm - above.position_mm);
  const Vec3 left = turn * facet.centre_mm + shift;
  const Vec3 right = mirrored(turn * mirrored(facet.centre_mm) + shift);
  const Vec3 normal = turn * facet.normal + mirrored(turn * mirrored(facet.normal));
  return {0.5 * (left + right), normal.normalized()};
}

void weaken(VertebraAnatomy& anatomy) {
  anatomy.cortex = {1100.0, 0.4, 0.3, 0.5, 0.5};
  anatomy.cancellous.body_hu = 45.0;
  anatomy.cancellous.pedicle_hu = 90.0;
  anatomy.cancellous.posterior_hu = 130.0;
  anatomy.cancellous.texture_hu = 45.0;
}

std::shared_ptr<const Vertebra> make_vertebra(const SpineOptions& options, const std::vector<PlacedLevel>& placed,
                                              std::size_t n) {
  // How deep the inferior process would reach into the gap: enough for the cut to shape the whole facet.
  constexpr double kShaped = 0.8;
  const PlacedLevel& level = placed[n];
  VertebraAnatomy anatomy = level_anatomy(level.measures);
  if (n + 1 < placed.size()) {
    aim_inferior_processes(anatomy, facet_from_above(level, placed[n + 1]), kShaped - options.facet_gap_mm,
                           level.measures.cervical_share);
  }
  anatomy.body.side_wedge_deg = level.side_wedge_deg;
  if (options.osteoporosis) weaken(anatomy);
  // A neck's is denser.
  const double density = options.density * lerp(1.0, 1.5, level.measures.cervical_share);
  for (double* hu : {&anatomy.cancellous.body_hu, &anatomy.cancellous.pedicle_hu, &anatomy.cancellous.posterior_hu}) {
    *hu *= density;
  }
  if (level.measures.crushed > 0.0) anatomy.cancellous.body_hu += 90.0;  // pressed together
  anatomy.cancellous.texture_seed = mix_bits(options.seed) + static_cast<std::uint64_t>(level.level);
  anatomy.placement.position_mm = level.position_mm;
  anatomy.placement.rotation_deg = rotation_in_degrees(level.rotation);
  // Where the joint below lies high, the inferior process's fillet may reach the pedicle: it is made smaller.
  constexpr int kMaxTries = 6;
  for (int attempt = 1;; ++attempt) {
    try {
      return std::make_shared<const Vertebra>(anatomy);
    } catch (const Error& error) {
      if (attempt == kMaxTries) fail("spine phantom: ", level_name(level.level), ": ", error.what());
      anatomy.inferior_articular.blend_mm *= 0.8;
    }
  }
}

std::vector<Pit> make_pits(const SpineOptions& options, const PlacedLevel& level) {
  if (std::find(options.schmorl_nodes.begin(), options.schmorl_nodes.end(), level.level) == options.schmorl_nodes.end())
    return {};
  const LevelMeasures& m = level.measures;
  const double side = 2.0 * random_uniform(options.seed, 5000 + static_cast<std::uint64_t>(level.level)) - 1.0;
  const Vec3 own(0.15 * side * m.body_width_mm, 0.1 * m.body_depth_mm, 0.5 * m.body_height_mm);
  return {{level.rotation * own + level.position_mm, 0.24 * m.body_height_mm}};
}

std::vector<ScrewRod> make_screws(const SpineOptions& options, const PlacedLevel& level, const Vertebra& vertebra) {
  if (std::find(options.screws.begin(), options.screws.end(), level.level) == options.screws.end()) return {};
  constexpr double kHeadMm = 9.0;  // outside the bone
  constexpr double kWallMm = 0.5;  // of the pedicle left on each side of a screw
  constexpr double kThinnestMm = 3.5;
  const VertebraGroundTruth ground_truth = vertebra_ground_truth(vertebra);
  std::vector<ScrewRod> screws;
  for (const PedicleGroundTruth& pedicle : {ground_truth.left, ground_truth.right}) {
    const double diameter =
        std::min(options.screw_diameter_mm, std::max(kThinnestMm, pedicle.width_mm - 2.0 * kWallMm));
    screws.push_back({pedicle.entry_mm - kHeadMm * pedicle.axis, pedicle.target_mm, 0.5 * diameter});
  }
  return screws;
}

/// Three lumps about the middle of the body, by chance.
std::vector<CementLump> make_cement(const SpineOptions& options, const PlacedLevel& level) {
  if (std::find(options.cement.begin(), options.cement.end(), level.level) == options.cement.end()) return {};
  const LevelMeasures& m = level.measures;
  const Vec3 half = 0.5 * Vec3(m.body_width_mm, m.body_depth_mm, m.body_height_mm);
  std::vector<CementLump> lumps;
  for (std::uint64_t n = 0; n < 3; ++n) {
    const auto chance = [&](std::uint64_t axis) {
      return 2.0 * random_uniform(options.seed + 11, 16 * static_cast<std::uint64_t>(level.level) + 4 * n + axis) - 1.0;
    };
    const Vec3 own = 0.5 * half.cwiseProduct(Vec3(chance(0), chance(1) - 0.3, 0.6 * chance(2)));
    lumps.push_back({level.rotation * own + level.position_mm, (0.4 + 0.12 * chance(3)) * half.y()});
  }
  return lumps;
}

/// Rims that may have spurs: where they stand, seen from the middle of the body, degrees to the left of its front.
constexpr std::array<double, 6> kSpurAngles{-80.0, -50.0, -20.0, 15.0, 45.0, 78.0};

/// Spurs of one endplate; `side`: 1 for the upper one. Those that face each other across a disc have the same chance.
std::vector<Spur> make_spurs(const SpineOptions& options, const std::vector<PlacedLevel>& placed, std::size_t n,
                             double side) {
  const PlacedLevel& level = placed[n];
  if (!(options.osteophyte_mm > 0.0) || level.level == Level::kSacrum) return {};
  const LevelMeasures& m = level.measures;
  const std::size_t disc = side > 0.0 ? n : n + 1;  // counted from above the uppermost level
  const bool faces = disc > 0 && disc < placed.size();
  const Vec3 up = level.rotation.col(2);
  std::vector<Spur> spurs;
  for (std::size_t k = 0; k < kSpurAngles.size(); ++k) {
    const std::uint64_t index = 7000 + 16 * disc + k;
    if (!(random_uniform(options.seed, index) < options.osteophyte_share)) continue;
    const double angle = kSpurAngles[k] * kDegree;
    const double radius = options.osteophyte_mm * (0.7 + 0.3 * random_uniform(options.seed + 3, index));
    const double share = 1.0 - 0.3 * radius / (0.5 * m.body_depth_mm);
    const Vec3 rim(0.5 * share * m.body_width_mm * std::sin(angle), -0.5 * share * m.body_depth_mm * std::cos(angle),
                   side * (0.5 * m.body_height_mm - 0.6 * radius));
    Spur spur;
    spur.radius_mm = radius;
    spur.root_mm = level.rotation * rim + level.position_mm;
    if (faces) {
      const PlacedLevel& upper = placed[disc - 1];
      const PlacedLevel& lower = placed[disc];
      const Vec3 normal = (upper.rotation.col(2) + lower.rotation.col(2)).normalized();
      const Vec3 top = upper.position_mm - 0.5 * upper.measures.body_height_mm * upper.rotation.col(2);
      const Vec3 bottom = lower.position_mm + 0.5 * lower.measures.body_height_mm * lower.rotation.col(2);
      spur.plane_normal = side * normal;
      spur.plane_offset_mm = spur.plane_normal.dot(0.5 * (top + bottom)) - 0.5 * options.osteophyte_gap_mm;
      spur.tip_mm = spur.root_mm + (0.6 * radius + 0.5 * (top - bottom).norm()) * side * normal;
    } else {
      spur.plane_normal = side * up;
      spur.tip_mm = spur.root_mm + 0.8 * radius * side * up;
      spur.plane_offset_mm = spur.plane_normal.dot(spur.tip_mm) + radius;
    }
    spurs.push_back(spur);
  }
  return spurs;
}

/// Length of a rib along its axis that is made, mm: enough to pass 60 mm from the midline.
double rib_length_mm(int number, const SpineOptions& options) {
  if (number == 12) return options.rib12_mm;
  if (number == 11) return 150.0 * options.scale;
  return (number == 1 ? 100.0 : 165.0) * options.scale;
}

/// Which of twelve ribs a level's is most like: the last two float. 0: it has none.
int rib_number(Level level, int thoracic_levels) {
  const int number = level == Level::kT13 ? 13 : static_cast<int>(level) - static_cast<int>(Level::kT1) + 1;
  if (number < 1 || number > thoracic_levels) return 0;
  return number > thoracic_levels - 2 ? number - thoracic_levels + 12 : std::min(number, 10);
}

void add_ribs(const SpineOptions& options, const std::vector<PlacedLevel>& placed, std::vector<SpinePart>& parts) {
  constexpr ShellBone kHealthy{0.9, 1000.0, 160.0}, kWeak{0.5, 900.0, 60.0};
  const std::size_t levels = placed.size();
  for (std::size_t n = 0; n < levels; ++n) {
    const int number = rib_number(placed[n].level, options.thoracic_levels);
    if (number == 0) continue;
    const double disc_mm =
        n > 0 ? disc_height_mm(placed[n - 1], placed[n])
              : level_measures(static_cast<Level>(static_cast<int>(Level::kT1) + number - 1)).disc_below_mm *
                    options.scale;
    const std::vector<Vec3> axis =
        rib_axis(number, placed[n].measures, parts[n].vertebra->anatomy(), disc_mm, rib_length_mm(number, options));
    const shapes::RibShape shape(axis, number, options.scale);
    for (const double side : {1.0, -1.0}) {
      SpinePart rib;
      rib.label = kRibLabel;
      rib.solid = std::make_shared<const ShapeSolid<shapes::RibShape>>(shape, placed[n].rotation, placed[n].position_mm,
                                                                       side, options.osteoporosis ? kWeak : kHealthy);
      for (std::size_t other = n > 0 ? n - 1 : 0; other <= std::min(n + 1, levels - 1); ++other) {
        rib.cuts.push_back({other, options.rib_gap_mm});
      }
      parts.push_back(std::move(rib));
    }
  }
}

}  // namespace

std::vector<SpinePart> make_parts(const SpineOptions& options, const std::vector<PlacedLevel>& placed) {
  std::vector<SpinePart> parts;
  for (std::size_t n = 0; n < placed.size(); ++n) {
    SpinePart part;
    part.label = static_cast<std::uint8_t>(placed[n].level);
    if (placed[n].level == Level::kSacrum) {
      part.solid = std::make_shared<const ShapeSolid<shapes::SacrumShape>>(
          shapes::SacrumShape(placed[n].measures), placed[n].rotation, placed[n].position_mm, 1.0,
          options.osteoporosis ? ShellBone{0.5, 900.0, 40.0} : ShellBone{1.0, 1000.0, 140.0});
    } else if (is_upper_neck(placed[n].level)) {
      const ShellBone bone = options.osteoporosis ? ShellBone{0.7, 1000.0, 150.0} : ShellBone{1.2, 1200.0, 320.0};
      part.solid = placed[n].level == Level::kC1 ? make_atlas(placed[n], options.scale, bone)
                                                 : make_axis(placed[n], placed[n + 1], options.scale, bone);
      if (n + 1 < placed.size()) part.cuts.push_back({n + 1, options.facet_gap_mm});
    } else {
      part.vertebra = make_vertebra(options, placed, n);
      std::vector<Pit> pits = make_pits(options, placed[n]);
      std::vector<ScrewRod> screws = make_screws(options, placed[n], *part.vertebra);
      std::vector<CementLump> cement = make_cement(options, placed[n]);
      if (pits.empty() && screws.empty() && cement.empty()) {
        part.solid = part.vertebra;
      } else {
        part.solid =
            std::make_shared<const LevelBody>(part.vertebra, std::move(pits), std::move(screws), std::move(cement));
      }
      // Long spinous processes pass the next level and may near the one after it.
      for (const std::size_t below : {n + 1, n + 2}) {
        if (below < placed.size()) part.cuts.push_back({below, options.facet_gap_mm});
      }
      for (const double side : {1.0, -1.0}) {
        for (Spur& spur : make_spurs(options, placed, n, side)) part.spurs.push_back(spur);
      }
      if (placed[n].measures.cervical_share > 0.5) {
        for (const Spur& spur : cervical_spurs(placed[n], part.vertebra->anatomy(), n > 0 ? &placed[n - 1] : nullptr)) {
          part.spurs.push_back(spur);
        }
      }
    }
    parts.push_back(std::move(part));
  }
  if (options.ribs) add_ribs(options, placed, parts);
  if (options.pelvis) add_pelvis(options, placed, parts);
  if (options.shoulders) add_shoulders(options, placed, parts);
  if (options.skull) {
    const ShellBone bone{1.6, 1400.0, 500.0};
    const SpinePart::Cut atlas{0, options.facet_gap_mm};
    parts.push_back({.label = kOtherBoneLabel, .solid = make_skull(placed[0], options.scale, bone), .cuts = {atlas}});
    parts.push_back({.label = kOtherBoneLabel, .solid = make_jaw(placed[0], options.scale), .cuts = {atlas}});
  }
  return parts;
}

void check_isthmuses(const Vertebra& vertebra, const std::function<double(const Vec3&)>& value_mm) {
  const VertebraGroundTruth ground_truth = vertebra_ground_truth(vertebra);
  for (const PedicleGroundTruth& pedicle : {ground_truth.left, ground_truth.right}) {
    for (int step = 0; step < 90; ++step) {
      const double angle = 4.0 * step * kDegree;
      const Vec3 p = pedicle.isthmus_mm + 0.5 * pedicle.width_mm * std::cos(angle) * pedicle.width_axis +
                     0.5 * pedicle.height_mm * std::sin(angle) * pedicle.height_axis;
      const double value = value_mm(p);
      if (!(std::fabs(value) < 1e-6)) {
        fail("spine phantom: a pedicle's isthmus must be clear of the neighbours, but ", std::fabs(value),
             " mm are taken from it; make the discs higher or facet_gap_mm smaller");
      }
    }
  }
}

}  // namespace spinaltap
