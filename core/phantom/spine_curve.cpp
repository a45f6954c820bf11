#include "core/phantom/spine_curve.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/phantom/detail/level_anatomy.h"
#include "core/phantom/detail/upper_neck.h"
#include "core/phantom/vertebra_ground_truth.h"

namespace spinaltap {
namespace {

bool is_cervical(Level level) { return static_cast<int>(level) <= static_cast<int>(Level::kC7); }
bool is_thoracic(Level level) { return !is_cervical(level) && level_rank(level) < level_rank(Level::kL1); }

/// Of a level of a spine with as many as the options say: the usual ones' measures, spread over them.
LevelMeasures measures_among(Level level, const SpineOptions& options) {
  if (is_upper_neck(level)) return upper_neck_measures(level);
  if (is_cervical(level)) return level_measures(level);
  const bool thoracic = is_thoracic(level);
  const Level first = thoracic ? Level::kT1 : Level::kL1;
  const int usual = thoracic ? 12 : 5, count = thoracic ? options.thoracic_levels : options.lumbar_levels;
  const int place = level == Level::kT13 ? 12 : static_cast<int>(level) - static_cast<int>(first);
  const double spread = static_cast<double>(place * (usual - 1)) / (count - 1);
  const int whole = static_cast<int>(spread + 1e-9);
  const auto row = [&](int n) {
    return level_measures(static_cast<Level>(static_cast<int>(first) + std::min(n, usual - 1)));
  };
  return mixed(row(whole), row(whole + 1), std::max(0.0, spread - whole));
}

/// Crushes a body. Its arch hangs from the rim behind.
void crush(LevelMeasures& m, const CrushedLevel& crushed) {
  const double lean_mm = m.body_depth_mm * std::tan(0.5 * m.wedge_deg * kDegree);
  const double front_mm = crushed.front_share * (m.body_height_mm - lean_mm);
  const double back_mm = crushed.back_share * (m.body_height_mm + lean_mm);
  m.body_height_mm = 0.5 * (front_mm + back_mm);
  m.back_rise_mm = 0.5 * (back_mm - lean_mm - m.body_height_mm);
  m.wedge_deg = 2.0 * std::atan(0.5 * (back_mm - front_mm) / m.body_depth_mm) / kDegree;
  m.crushed = 1.0 - crushed.front_share;
}

/// Numbers of one level of one seed.
class Chances {
 public:
  Chances(std::uint64_t seed, Level level)
      : seed_(mix_bits(seed) ^ mix_bits(1000 + static_cast<std::uint64_t>(level))) {}
  /// Even in [-1, 1].
  double next() { return 2.0 * random_uniform(seed_, count_++) - 1.0; }

 private:
  std::uint64_t seed_, count_ = 0;
};

/// The sacrum's first segment, as far as a level's measures tell: an endplate, facets and a canal.
LevelMeasures sacrum_measures() {
  LevelMeasures m = level_measures(Level::kL5);
  m.body_width_mm = 50.0;
  m.body_depth_mm = 33.0;
  m.body_height_mm = 30.0;
  m.wedge_deg = 0.0;
  m.facet_x_mm = 24.0;
  m.facet_inward_deg = 32.0;
  m.flexion_deg = 36.0;
  return m;
}

LevelMeasures varied(LevelMeasures m, Level level, const SpineOptions& options, std::uint64_t draw) {
  Chances chances(options.seed + 7919 * draw, level);
  const double share = options.variation;
  const auto vary = [&](double& value, double by) { value *= 1.0 + share * by * chances.next(); };
  vary(m.body_width_mm, 0.06);
  vary(m.body_depth_mm, 0.06);
  vary(m.body_height_mm, 0.06);
  m.body_depth_mm = std::min(m.body_depth_mm, m.body_width_mm);
  m.wedge_deg += share * 2.0 * chances.next();
  vary(m.pedicle_width_mm, 0.15);
  vary(m.pedicle_height_mm, 0.06);
  m.pedicle_height_mm = std::max(m.pedicle_height_mm, m.pedicle_width_mm);
  m.pedicle_convergence_deg += share * 3.0 * chances.next();
  vary(m.canal_width_mm, 0.05);
  vary(m.canal_depth_mm, 0.06);
  vary(m.transverse_span_mm, 0.08);
  m.transverse_back_deg += share * 4.0 * chances.next();
  vary(m.spinous_length_mm, 0.1);
  m.spinous_drop_deg += share * 3.0 * chances.next();
  vary(m.spinous_tip_height_mm, 0.1);
  vary(m.lamina_height_mm, 0.04);
  m.facet_inward_deg += share * 5.0 * chances.next();
  vary(m.disc_below_mm, 0.25);
  return m;
}

/// The first of a row of random variations whose pedicles are exact and lead into the body, at the size asked for.
LevelMeasures sound_variation(const LevelMeasures& m, Level level, const SpineOptions& options) {
  constexpr std::uint64_t kMaxDraws = 40;
  for (std::uint64_t draw = 0; draw < kMaxDraws; ++draw) {
    const LevelMeasures drawn = varied(m, level, options, draw);
    try {
      (void)vertebra_ground_truth(Vertebra(level_anatomy(scaled(drawn, options.scale))));
      return drawn;
    } catch (const Error&) {  // a fillet reaches an isthmus
    }
  }
  fail("spine phantom: no variation of ", level_name(level), " with exact pedicles found; make variation smaller");
}

/// How far down the curve a level lies: 0 at its upper end vertebra, 1 at its lower one.
double place_in_curve(Level level, const SpineOptions& options) {
  const int first = level_rank(options.scoliosis_first.value_or(options.first));
  const int last = level_rank(options.scoliosis_last.value_or(options.last));
  return last > first ? static_cast<double>(level_rank(level) - first) / (last - first) : 0.5;
}

/// Sidewise tilt, degrees: half of Cobb's angle at the end vertebrae, none at the apex; beyond the ends it dies away.
double side_tilt_deg(double place, const SpineOptions& options) {
  const double half = 0.5 * options.scoliosis_deg;
  const double beyond = std::max({-place, place - 1.0, 0.0});
  return half * std::cos(std::numbers::pi * std::clamp(place, 0.0, 1.0)) * std::max(0.0, 1.0 - 1.5 * beyond);
}

double flexion_deg(const LevelMeasures& m, Level level, const SpineOptions& options) {
  if (is_cervical(level)) {
    // Above T1, as it leans: the natural curve has 25 degrees from C3 to C7.
    const double t1_deg = level_measures(Level::kT1).flexion_deg;
    return t1_deg * options.kyphosis_deg / 40.0 - (t1_deg - m.flexion_deg) * options.cervical_lordosis_deg / 25.0;
  }
  // The natural curve has 40 degrees from T1 to T12 and 55 from L1 to the sacrum; T9 and L3 hardly lean.
  return m.flexion_deg * (is_thoracic(level) ? options.kyphosis_deg / 40.0 : options.lordosis_deg / 55.0);
}

/// Upward normal of an endplate, own frame of its vertebra; `side`: 1 for the upper one, -1 for the lower one.
Vec3 endplate_normal(const PlacedLevel& level, double side) {
  return Vec3(std::tan(0.5 * level.side_wedge_deg * kDegree), -std::tan(0.5 * level.measures.wedge_deg * kDegree), side)
             .normalized() *
         side;
}

Vec3 endplate_centre(const PlacedLevel& level, double side) {
  return level.position_mm + level.rotation * Vec3(0.0, 0.0, 0.5 * side * level.measures.body_height_mm);
}

double own_disc_mm(const PlacedLevel& above, const SpineOptions& options) {
  const std::optional<double>& given = is_cervical(above.level)   ? options.cervical_disc_mm
                                       : is_thoracic(above.level) ? options.thoracic_disc_mm
                                                                  : options.lumbar_disc_mm;
  return given.value_or(above.measures.disc_below_mm);
}

/// Puts `below`, which is turned already, under `above`.
void stack(const PlacedLevel& above, PlacedLevel& below, double disc_mm, double scale) {
  if (above.level == Level::kC1) {  // around the dens
    below.position_mm = above.position_mm - below.rotation * (scale * kDensMm);
    return;
  }
  const Vec3 upper = above.rotation * endplate_normal(above, -1.0),
             lower = below.rotation * endplate_normal(below, 1.0);
  const Vec3 normal = (upper + lower).normalized();
  const Vec3 y = above.rotation.col(1);
  const Vec3 back = (y - y.dot(normal) * normal).normalized();
  const Vec3 left = back.cross(normal);
  // How far the rims near each other where the endplates meet at an angle.
  const Vec3 slope = upper - lower;
  const double half_width = 0.5 * std::max(above.measures.body_width_mm, below.measures.body_width_mm);
  const double half_depth = 0.5 * std::max(above.measures.body_depth_mm, below.measures.body_depth_mm);
  const double nearer = std::hypot(slope.dot(left) * half_width, slope.dot(back) * half_depth);
  const double height = std::max(disc_mm, 0.5 * disc_mm + nearer);
  const double shift = 0.5 * (above.measures.body_depth_mm - below.measures.body_depth_mm);
  below.position_mm = endplate_centre(above, -1.0) - height * normal + shift * back -
                      below.rotation * Vec3(0.0, 0.0, 0.5 * below.measures.body_height_mm);
}

}  // namespace

double disc_height_mm(const PlacedLevel& above, const PlacedLevel& below) {
  return (endplate_centre(above, -1.0) - endplate_centre(below, 1.0)).norm();
}

const PlacedLevel* placed_level(const std::vector<PlacedLevel>& placed, Level level) {
  const auto found =
      std::find_if(placed.begin(), placed.end(), [&](const PlacedLevel& one) { return one.level == level; });
  return found == placed.end() ? nullptr : &*found;
}

std::vector<PlacedLevel> place_levels(const SpineOptions& options) {
  check_spine_options(options);
  std::vector<PlacedLevel> levels;
  for (Level level = options.first;; level = level_below(level, options)) {
    levels.push_back({.level = level, .measures = measures_among(level, options)});
    if (level == options.last) break;
  }
  if (options.sacrum) levels.push_back({.level = Level::kSacrum, .measures = sacrum_measures()});
  const Mat3 patient = rotation_from_degrees(options.tilt_deg);
  std::vector<double> bend_deg(levels.size(), 0.0), flexion(levels.size(), 0.0);
  for (std::size_t n = 0; n < levels.size(); ++n) {
    PlacedLevel& placed = levels[n];
    const bool sacrum = placed.level == Level::kSacrum;
    if (!is_cervical(placed.level)) {
      placed.measures.wedge_deg *=
          is_thoracic(placed.level) ? options.kyphosis_deg / 40.0 : options.lordosis_deg / 55.0;
    }
    flexion[n] = flexion_deg(placed.measures, placed.level, options);
    if (options.variation > 0.0 && !sacrum && !is_upper_neck(placed.level))
      placed.measures = sound_variation(placed.measures, placed.level, options);
    placed.measures = scaled(placed.measures, options.scale);
    for (const CrushedLevel& crushed : options.crushed) {
      if (crushed.level != placed.level) continue;
      const double wedge_deg = placed.measures.wedge_deg;
      crush(placed.measures, crushed);
      // The levels above lean forward by what the body bends, those below backward.
      const double half_deg = 0.5 * (placed.measures.wedge_deg - wedge_deg);
      for (PlacedLevel& other : levels) {
        const int below = level_rank(other.level) - level_rank(placed.level);
        if (below != 0) bend_deg[static_cast<std::size_t>(&other - levels.data())] += below < 0 ? half_deg : -half_deg;
      }
    }
  }
  for (std::size_t n = 0; n < levels.size(); ++n) {
    PlacedLevel& placed = levels[n];
    const double place = place_in_curve(placed.level, options);
    const double step = 0.5 / std::max<double>(1.0, static_cast<double>(levels.size()) - 1.0);
    if (place > 1e-9 && place < 1.0 - 1e-9) {
      // Bodies take half of the bend, discs the other.
      placed.side_wedge_deg = 0.5 * (side_tilt_deg(place - step, options) - side_tilt_deg(place + step, options));
    }
    const double turn =
        -options.scoliosis_turn * options.scoliosis_deg * std::sin(std::numbers::pi * std::clamp(place, 0.0, 1.0));
    Chances chances(options.seed + 1, placed.level);
    Vec3 degrees(flexion[n] + bend_deg[n], side_tilt_deg(place, options), turn);
    for (int axis = 0; axis < 3; ++axis) degrees[axis] += options.variation * (axis == 2 ? 3.0 : 1.5) * chances.next();
    placed.rotation = patient * rotation_from_degrees(degrees);
  }
  for (std::size_t n = 1; n < levels.size(); ++n) {
    stack(levels[n - 1], levels[n], own_disc_mm(levels[n - 1], options), options.scale);
  }
  const Vec3 shift = options.position_mm - levels[(levels.size() - 1) / 2].position_mm;
  for (PlacedLevel& placed : levels) placed.position_mm += shift;
  return levels;
}

}  // namespace spinaltap
