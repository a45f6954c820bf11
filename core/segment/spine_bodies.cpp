#include "core/segment/spine_bodies.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "core/segment/detail/median.h"

namespace spinaltap {
namespace {

/// How much of the room at either side of a body, level with its middle and as far out as only the sacrum has bone, is
/// bone; of the side with less.
double alae_share(const WallProbe& probe, const BodyCylinder& body, double bone_hu) {
  double bone[2] = {0.0, 0.0};
  double count = 0.0;
  for (double beside = 5.0; beside <= 17.0; beside += 1.5) {
    for (double y = 0.2; y <= 1.81; y += 0.2) {
      for (double z = -0.5; z <= 0.51; z += 0.25) {
        count += 1.0;
        for (const int side : {0, 1}) {
          const double x = (side == 0 ? 1.0 : -1.0) * (body.half_mm.x() + beside);
          const Vec3 p = body.centre_mm + body.axes() * Vec3(x, y * body.half_mm.y(), z * body.half_mm.z());
          // The inside of the ala is darker than its wall, and lighter than muscle.
          if (probe.hu(p) > 0.55 * bone_hu + 20.0) bone[side] += 1.0;
        }
      }
    }
  }
  return std::min(bone[0], bone[1]) / count;
}
constexpr double kAlaeShare = 0.5;

/// A sacrum has five bodies, the first of which is the widest of a spine but for L5: 50 +- 4 mm across, and 38 in small
/// adults. Shoulders, and the skull beside a neck's body of 24 mm, are no alae.
constexpr std::size_t kMaxSacral = 5;
constexpr double kMinSacrumMm = 32.0;

/// Whether the lowest of a row is as a sacrum, in three of four: it leans as no lumbar body does, and more than the one
/// above; is wider than any lumbar body beside the next, and has no wall where alae begin.
bool is_like_a_sacrum(const std::vector<std::optional<VertebralBody>>& bodies) {
  constexpr double kMinLeanDeg = 35.0, kMinKinkDeg = 12.0, kMinWidth = 1.08, kMaxWall = 0.75;
  if (bodies.size() < 3) return false;
  const BodyCylinder &lowest = bodies[0]->cylinder, &above = bodies[1]->cylinder;
  const auto lean_deg = [](const BodyCylinder& body) {
    const Vec3 up = body.axes().col(2);
    return std::atan2(-up.y(), up.z()) / kDegree;
  };
  std::vector<double> walls;
  for (std::size_t n = 1; n < bodies.size(); ++n) walls.push_back(bodies[n]->cylinder.fit);
  const bool signs[] = {lean_deg(lowest) >= kMinLeanDeg, lean_deg(lowest) - lean_deg(above) >= kMinKinkDeg,
                        lowest.half_mm.x() >= kMinWidth * above.half_mm.x(),
                        lowest.fit <= kMaxWall * detail::upper_median(std::move(walls))};
  return std::count(std::begin(signs), std::end(signs), true) >= 3;
}

/// Whether a body of the row is the sacrum's: by its alae, or where these are thin or light, as the lowest's, by how it
/// leans, its width and its wall too.
bool is_sacral(const WallProbe& probe, const std::vector<std::optional<VertebralBody>>& bodies, std::size_t n,
               double bone_hu) {
  constexpr double kThinAlaeShare = 0.2;
  const BodyCylinder& body = bodies[n]->cylinder;
  if (2.0 * body.half_mm.x() < kMinSacrumMm) return false;
  const double share = alae_share(probe, body, bone_hu);
  return share > kAlaeShare || (n == 0 && share >= kThinAlaeShare && is_like_a_sacrum(bodies));
}

/// Mean edge over the middle of a plane across a body.
double endplate_of(const WallProbe& probe, const BodyEnd& end, const ColumnSection& middle, double outward) {
  constexpr int kPlaces = 7;
  constexpr double kShare = 0.7;
  double sum = 0.0;
  double count = 0.0;
  for (int i = -kPlaces; i <= kPlaces; ++i) {
    for (int j = -kPlaces; j <= kPlaces; ++j) {
      const Eigen::Vector2d unit = kShare / kPlaces * Eigen::Vector2d(i, j);
      if (unit.norm() > kShare) continue;
      const Vec3 across(unit.x() * middle.half_width_mm, unit.y() * middle.half_depth_mm, 0.0);
      sum += probe.edge(end.centre_mm + middle.axes * across, outward * end.up);
      count += 1.0;
    }
  }
  return sum / count;
}

/// The sacrum's first body below the lowest vertebra: it leans back, has an upper endplate and alae, and goes on below
/// without an end. Nothing where it is not there.
std::optional<BodySpan> find_sacrum(const WallProbe& probe, const BodyCylinder& lowest, double bone_hu) {
  constexpr double kMinEdge = 0.4;
  const double height_mm = 1.6 * lowest.half_mm.z();
  std::optional<BodySpan> best;
  for (double lean_deg = 0.0; lean_deg <= 60.0; lean_deg += 7.5) {
    const Mat3 axes = lowest.axes() * Eigen::AngleAxisd(lean_deg * kDegree, Vec3::UnitX()).toRotationMatrix();
    for (double gap_mm = 2.0; gap_mm <= 20.0; gap_mm += 0.5) {
      // The disc is a wedge: its middle lies on the mean of both directions.
      const Vec3 down = -(lowest.axes().col(2) + axes.col(2)).normalized();
      BodySpan span;
      span.upper.centre_mm = lowest.centre_mm - lowest.half_mm.z() * lowest.axes().col(2) + gap_mm * down;
      span.upper.up = span.lower.up = axes.col(2);
      span.upper.s_mm = height_mm;
      span.lower.centre_mm = span.upper.centre_mm - height_mm * axes.col(2);
      span.lower.is_cut = true;
      span.middle.centre_mm = 0.5 * (span.upper.centre_mm + span.lower.centre_mm);
      span.middle.axes = axes;
      span.middle.half_width_mm = lowest.half_mm.x();
      span.middle.half_depth_mm = 0.9 * lowest.half_mm.y();
      span.upper.edge = endplate_of(probe, span.upper, span.middle, 1.0);
      if (span.upper.edge < std::max(kMinEdge, best ? best->upper.edge : 0.0)) continue;
      BodyCylinder body;
      body.centre_mm = span.middle.centre_mm;
      body.half_mm = Vec3(span.middle.half_width_mm, span.middle.half_depth_mm, 0.5 * height_mm);
      body.set_axes(axes);
      if (alae_share(probe, body, bone_hu) > kAlaeShare) best = span;
    }
  }
  return best;
}

/// Whole bodies with clear endplates, or in thick slices as clear as most, and as much wall as most.
std::vector<BodyCylinder> sure_bodies(const std::vector<BodyCylinder>& bodies, const std::vector<BodySpan>& chain) {
  std::vector<double> fits;
  fits.reserve(bodies.size());
  for (const BodyCylinder& body : bodies) fits.push_back(body.fit);
  constexpr double kMinShare = 0.75;
  constexpr double kClearEdge = 0.4;
  std::vector<double> edges;
  edges.reserve(chain.size());
  for (const BodySpan& span : chain) edges.push_back(std::min(span.lower.edge, span.upper.edge));
  const double min_edge = edges.empty() ? kClearEdge : std::min(kClearEdge, kMinShare * detail::upper_median(edges));
  const double min_fit = fits.empty() ? 0.0 : kMinShare * detail::upper_median(fits);
  std::vector<BodyCylinder> sure;
  for (std::size_t n = 0; n < bodies.size(); ++n) {
    const BodySpan& span = chain[n];
    if (span.is_cut() || std::min(span.lower.edge, span.upper.edge) < min_edge) continue;
    if (bodies[n].fit >= min_fit) sure.push_back(bodies[n]);
  }
  return sure;
}

double height_mm(const std::vector<BodySpan>& chain) {
  double sum_mm = 0.0;
  for (const BodySpan& span : chain) sum_mm += span.height_mm();
  return sum_mm;
}

/// A body, and its like where the next one up may be.
std::vector<BodyCylinder> with_one_above(const BodyCylinder& body) {
  constexpr double kStepOverHeight = 1.25;  // disc included
  BodyCylinder above = body;
  above.centre_mm += kStepOverHeight * 2.0 * body.half_mm.z() * body.axes().col(2);
  return {body, above};
}

/// How far a column goes on beyond the outermost of the sure bodies, at either end.
double max_beyond_mm(const SpineColumn& column, const std::vector<BodyCylinder>& sure) {
  const double below_mm = (sure.front().centre_mm - column.sections.front().centre_mm).norm();
  const double above_mm = (sure.back().centre_mm - column.sections.back().centre_mm).norm();
  return std::max({below_mm, above_mm, 45.0});
}

/// The bodies in front of a canal.
SpineBodies bodies_along(const CtVolume& ct, const BoneLevels& levels, SpinalCanal canal, const Progress& progress) {
  SpineBodies spine;
  spine.levels = levels;
  spine.canal = std::move(canal);
  progress.report("finding the vertebral bodies", 0.0);
  const FloatGrid hu = hu_around_canal(ct, spine.canal);
  constexpr double kBlurMm = 0.9;
  const FloatGrid smooth = gaussian_blur(hu, kBlurMm);
  const WallLevels walls{levels.low_hu};
  const WallProbe probe(smooth, walls);
  const SpineColumn first = fit_spine_column(smooth, spine.canal, walls);
  progress.report("finding the vertebral bodies", 0.4);
  const FloatGrid as_asked = blurred_as_asked(hu, levels, ct);
  spine.chain = find_body_chain(as_asked, first, walls);
  progress.report("finding the vertebral bodies", 0.6);
  std::vector<BodyCylinder> cylinders = find_body_cylinders(probe, spine.chain);
  // Once more, along the column through the bodies that are sure: where the canal ends, its curve says little.
  const std::vector<BodyCylinder> sure = sure_bodies(cylinders, spine.chain);
  if (!sure.empty()) {
    const double beyond_mm = max_beyond_mm(first, sure);
    // A single body says nothing of how the column bends: straight on, and only for bodies that the canal missed.
    const SpineColumn second = column_through(sure.size() >= 2 ? sure : with_one_above(sure.front()), beyond_mm, probe);
    std::vector<BodySpan> again = find_body_chain(as_asked, second, walls);
    // Bodies are lost by a column that bends where nothing holds it; one may have been none.
    constexpr double kMuchLess = 0.7;
    const bool is_as_much =
        height_mm(again) > kMuchLess * height_mm(spine.chain) && again.size() + 1 >= spine.chain.size();
    if ((sure.size() >= 2 && is_as_much) || again.size() > spine.chain.size()) {
      spine.chain = std::move(again);
      cylinders = find_body_cylinders(probe, spine.chain);
    }
  }
  progress.report("finding the vertebral bodies", 0.9);
  std::vector<std::optional<VertebralBody>> bodies(spine.chain.size());
  tbb::parallel_for(std::size_t{0}, bodies.size(), [&](std::size_t n) {
    bodies[n] = find_vertebral_body(probe, cylinders[n]);
    bodies[n]->is_cut = spine.chain[n].is_cut();
  });
  // What lies below the sacrum's first body is sacrum too.
  std::size_t lowest = 0;
  for (std::size_t n = 0; n < std::min(bodies.size(), kMaxSacral); ++n) {
    if (!is_sacral(probe, bodies, n, walls.bone_hu)) continue;
    lowest = n;
    spine.has_sacrum = true;
  }
  spine.chain.erase(spine.chain.begin(), spine.chain.begin() + static_cast<std::ptrdiff_t>(lowest));
  for (std::size_t n = lowest; n < bodies.size(); ++n) spine.bodies.push_back(std::move(*bodies[n]));
  if (spine.has_sacrum || spine.chain.empty() || spine.chain.front().lower.is_cut) return spine;
  if (const auto sacrum = find_sacrum(probe, spine.bodies.front().cylinder, walls.bone_hu)) {
    spine.has_sacrum = true;
    spine.bodies.insert(spine.bodies.begin(),
                        find_vertebral_body(probe, find_body_cylinders(probe, {*sacrum}).front()));
    spine.chain.insert(spine.chain.begin(), *sacrum);
  }
  return spine;
}

/// Of the bodies that have walls and the proportions of one, the heights.
double height_of_bodies_mm(const SpineBodies& spine) {
  constexpr double kMinFit = 0.3, kMinHalfWidthMm = 7.0, kMinHalfDepthMm = 6.0, kMinHalfHeightMm = 4.0;
  constexpr double kMinShape = 0.85, kMaxShape = 2.2;  // width over depth
  double sum_mm = 0.0;
  for (const VertebralBody& body : spine.bodies) {
    const Vec3& half_mm = body.cylinder.half_mm;
    const double shape = half_mm.x() / half_mm.y();
    if (body.cylinder.fit < kMinFit || half_mm.x() < kMinHalfWidthMm || half_mm.y() < kMinHalfDepthMm) continue;
    if (half_mm.z() < kMinHalfHeightMm || shape < kMinShape || shape > kMaxShape) continue;
    sum_mm += 2.0 * half_mm.z();
  }
  return sum_mm;
}

}  // namespace

SpineBodies find_spine_bodies(const CtVolume& ct, std::optional<double> threshold_hu,
                              const std::optional<Vec3>& near_mm, const Progress& progress) {
  const BoneLevels levels = choose_bone_levels(ct, threshold_hu);
  CanalSearch search{.near_mm = near_mm};
  SpineBodies best;
  best.levels = levels;
  double best_mm = 0.0;
  // What looks like a canal may be none: a body whose cancellous bone is as dark as a canal's contents, with a bright
  // vessel in front, or a hip. Where no row of bodies stands in front of any, walls of light or thickly sliced bone may
  // be too weak, and lower levels are tried.
  constexpr int kMaxTries = 8;
  constexpr double kMinRowMm = 60.0;  // three bodies
  for (const double share : {1.0, 0.75, 0.6}) {
    if (best_mm >= kMinRowMm) break;
    search.but_not.clear();
    BoneLevels canal_levels = levels;
    canal_levels.low_hu *= share;
    canal_levels.sure_hu *= share;
    const CanalFinder finder(ct, canal_levels, progress);
    for (int n = 0; n < kMaxTries; ++n) {
      SpinalCanal canal = finder.find(search, progress);
      if (canal.points_mm.empty()) break;
      const double canal_mm = SpinalCanal::kStepMm * static_cast<double>(canal.points_mm.size());
      SpineBodies spine = bodies_along(ct, levels, std::move(canal), progress);
      const double bodies_mm = height_of_bodies_mm(spine);
      search.but_not.push_back(spine.canal);
      // What sees the same bodies from further away may find them a little higher.
      constexpr double kClearlyMore = 1.3;
      const bool is_first = share == 1.0 && n == 0;
      const bool is_row = share == 1.0 || bodies_mm >= kMinRowMm;
      if (is_first || (is_row && bodies_mm > kClearlyMore * best_mm)) {
        best_mm = bodies_mm;
        best = std::move(spine);
      }
      // Discs are a quarter of a spine, and of ends some are unsure.
      constexpr double kMinShare = 0.4;
      if (is_row && bodies_mm >= kMinShare * canal_mm) {
        progress.report("finding the vertebral bodies", 1.0);
        return best;
      }
    }
  }
  progress.report("finding the vertebral bodies", 1.0);
  return best;
}

std::optional<std::size_t> body_at(const SpineBodies& spine, const Vec3& p_mm) {
  constexpr double kOutsideMm = 2.0;  // the surface's own error, and a point on the wall
  std::optional<std::size_t> best;
  double depth_mm = -kOutsideMm;
  for (std::size_t n = 0; n < spine.bodies.size(); ++n) {
    const double here_mm = spine.bodies[n].surface.depth_mm(p_mm);
    if (here_mm <= depth_mm) continue;
    depth_mm = here_mm;
    best = n;
  }
  return best;
}

}  // namespace spinaltap
