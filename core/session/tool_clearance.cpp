#include "core/session/tool_clearance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/grading/grade.h"
#include "core/session/detail/wall_lattice.h"

namespace spinaltap {

struct ClearanceField::Lattice {
  const WallDistance& walls;
  WallLattice distances;
};

namespace {

/// Part of a bit's outline by the length along it, so that distances change by at most 1 mm per mm.
class OutlineStretch {
 public:
  OutlineStretch(const ProfilePiece& piece, double begin_mm, double end_mm) : piece_(piece), begin_mm_(begin_mm) {
    if (piece.ball_radius_mm > 0.0) {
      from_ = angle(begin_mm);
      length_mm_ = piece.ball_radius_mm * (angle(end_mm) - from_);
      return;
    }
    slope_ = (piece.end_radius_mm - piece.begin_radius_mm) / (piece.end_mm - piece.begin_mm);
    length_mm_ = (end_mm - begin_mm) * std::sqrt(1.0 + slope_ * slope_);
  }

  double length_mm() const { return length_mm_; }
  bool is_cylinder() const { return piece_.ball_radius_mm == 0.0 && slope_ == 0.0; }
  /// Behind the tip, and off the axis.
  std::pair<double, double> at(double along_mm) const {
    if (piece_.ball_radius_mm > 0.0) {
      const double turn = from_ + along_mm / piece_.ball_radius_mm;
      return {piece_.ball_centre_mm - piece_.ball_radius_mm * std::cos(turn), piece_.ball_radius_mm * std::sin(turn)};
    }
    if (slope_ == 0.0) return {begin_mm_ + along_mm, piece_.begin_radius_mm};
    const double back_mm = begin_mm_ + along_mm / std::sqrt(1.0 + slope_ * slope_);
    return {back_mm, piece_.begin_radius_mm + slope_ * (back_mm - piece_.begin_mm)};
  }

 private:
  double angle(double back_mm) const {
    return std::acos(std::clamp((piece_.ball_centre_mm - back_mm) / piece_.ball_radius_mm, -1.0, 1.0));
  }

  const ProfilePiece& piece_;
  double begin_mm_;
  double from_ = 0.0;
  double slope_ = 0.0;
  double length_mm_ = 0.0;
};

/// The part of a tool's axis that counts for a wall, back from its tip, mm.
struct AxisPart {
  double from_mm = 0.0, to_mm = -1.0;

  bool is_empty() const { return !(to_mm >= from_mm); }
  bool holds_tip() const { return from_mm <= 0.0 && !is_empty(); }
};
/// The least distance to a wall, and how far back from the tip it is, mm.
struct Least {
  double mm = std::numeric_limits<double>::infinity();
  double back_mm = 0.0;

  void take(double distance_mm, double at_mm) noexcept {
    if (!(distance_mm < mm)) return;
    mm = distance_mm;
    back_mm = at_mm;
  }
};
/// Of each wall, by WallKind.
template <class Of>
using OfWalls = std::array<Of, 2>;
constexpr std::size_t number_of(WallKind wall) { return static_cast<std::size_t>(wall); }

/// Looks for the place of a bit's outline that is least far from each wall. Rings of the outline are bounded from below
/// by the distance at their centre less their radius; only those that may beat the best are walked around. How far the
/// next ring is follows from what is found at one: so both walls are looked for in turns, step by step, and neither
/// waits for its own last step. Likewise each step's usual length is told by a branch, which is foreseen, and not by a
/// maximum, which is waited for.
class MinDistance {
 public:
  MinDistance(const WallLattice& distances, const BitProfile& bit, const Pose& pose_path,
              const OfWalls<AxisPart>& parts)
      : distances_(distances), bit_(bit), pose_(pose_path), outer_part_(parts[0]), canal_part_(parts[1]) {
    const ProfilePiece& last = bit.pieces().back();
    if (last.ball_radius_mm == 0.0 && last.begin_radius_mm == last.end_radius_mm) {
      shank_begin_mm_ = last.begin_mm;
      shank_end_mm_ = last.end_mm;
      shank_radius_mm_ = std::sqrt(last.radius_squared_mm2(last.end_mm));
    }
    across_ = any_perpendicular(pose_.axis);
    second_ = pose_.axis.cross(across_);
    static const std::array<std::pair<double, double>, kDirections> turns = [] {
      std::array<std::pair<double, double>, kDirections> made;
      for (std::size_t n = 0; n < kDirections; ++n) {
        const double angle = static_cast<double>(n) * kTurn;
        made[n] = {std::cos(angle), std::sin(angle)};
      }
      return made;
    }();
    for (std::size_t n = 0; n < kDirections; ++n) {
      around_[n] = turns[n].first * across_ + turns[n].second * second_;
    }
    const Vec3 first = place(std::min(outer_part_.from_mm, canal_part_.from_mm));
    const Vec3 last_place = place(std::max(outer_part_.to_mm, canal_part_.to_mm));
    constexpr double kRoundingMm = 1e-6;
    const Vec3 aside = Vec3::Constant(bit_.radius_mm() + kRoundingMm);
    is_within_ =
        distances_.holds(first.cwiseMin(last_place) - aside) && distances_.holds(first.cwiseMax(last_place) + aside);
  }

  OfWalls<Least> find() const noexcept {
    OfWalls<Least> least;
    Least& outer_least = least[number_of(WallKind::outer)];
    Least& canal_least = least[number_of(WallKind::canal)];
    start_at_the_most_promising(outer_least, canal_least);
    // The chisel edge's middle, where a blunt tip looks at a wall.
    if (outer_part_.holds_tip()) outer_least.take(centre_mm<WallKind::outer>(0.0), 0.0);
    if (canal_part_.holds_tip()) canal_least.take(centre_mm<WallKind::canal>(0.0), 0.0);
    for (const ProfilePiece& piece : bit_.pieces()) {
      Walk outer(piece, outer_part_), canal(piece, canal_part_);
      while (outer.is_on && canal.is_on) {
        go_on<WallKind::outer>(outer, outer_least);
        go_on<WallKind::canal>(canal, canal_least);
      }
      while (outer.is_on) go_on<WallKind::outer>(outer, outer_least);
      while (canal.is_on) go_on<WallKind::canal>(canal, canal_least);
    }
    return least;
  }

 private:
  static constexpr double kCoarseMm = 1.0;                       ///< between the first look's places
  static constexpr double kFineMm = ClearanceField::kSpacingMm;  ///< between rings
  static constexpr double kUnknownMm = 0.5;                      ///< step where there is no distance
  static constexpr double kGoodEnough = 0.01;                    ///< mm that a ring must promise to beat the best by

  static constexpr std::size_t kDirections = 6;
  static constexpr double kTurn = 2.0 * std::numbers::pi / kDirections;

  /// Along a piece of the outline, ring by ring.
  struct Walk {
    Walk(const ProfilePiece& piece, const AxisPart& part)
        : Walk(piece, std::max(piece.begin_mm, part.from_mm), std::min(piece.end_mm, part.to_mm), part.is_empty()) {}
    Walk(const ProfilePiece& piece, double begin_mm, double end_mm, bool is_empty)
        : is_on(!is_empty && end_mm >= begin_mm), stretch(piece, begin_mm, end_mm) {}

    bool is_on;
    OutlineStretch stretch;
    double along_mm = 0.0;
  };
  /// For the places along the axis that promise most, mm.
  struct Look {
    double back_mm, to_mm;
    bool is_on() const { return back_mm <= to_mm; }
    double promise_mm = std::numeric_limits<double>::infinity();
    double best_back_mm = 0.0;
  };

  Vec3 place(double back_mm) const { return pose_.tip_mm - back_mm * pose_.axis; }
  template <WallKind wall>
  double centre_mm(double back_mm) const noexcept {
    return distance_mm<wall>(place(back_mm));
  }
  double radius_at_mm(double back_mm) const noexcept {
    if (back_mm > shank_begin_mm_ && back_mm <= shank_end_mm_) return shank_radius_mm_;
    return std::max(0.0, bit_.widest_mm(back_mm, back_mm));
  }
  template <WallKind wall>
  double distance_mm(const Vec3& p) const noexcept {
    if (!is_within_ && !distances_.holds(p)) return std::numeric_limits<double>::infinity();
    return WallLattice::distance_of<wall>(distances_.node_within(p));
  }

  /// A good first value lets the walk leave out most rings.
  void start_at_the_most_promising(Least& outer_least, Least& canal_least) const noexcept {
    Look outer{outer_part_.from_mm, outer_part_.to_mm}, canal{canal_part_.from_mm, canal_part_.to_mm};
    while (outer.is_on() && canal.is_on()) {
      if (is_within_ && outer.back_mm == canal.back_mm) {
        // Mostly so: at one place the lattice tells of both walls.
        const WallLattice::Node node = distances_.node_within(place(outer.back_mm));
        const double radius_mm = radius_at_mm(outer.back_mm);
        go_on(outer, WallLattice::distance_of<WallKind::outer>(node), radius_mm);
        go_on(canal, WallLattice::distance_of<WallKind::canal>(node), radius_mm);
      } else {
        go_on<WallKind::outer>(outer);
        go_on<WallKind::canal>(canal);
      }
    }
    while (outer.is_on()) go_on<WallKind::outer>(outer);
    while (canal.is_on()) go_on<WallKind::canal>(canal);
    take_best<WallKind::outer>(outer, outer_least);
    take_best<WallKind::canal>(canal, canal_least);
  }

  template <WallKind wall>
  void take_best(const Look& look, Least& least) const noexcept {
    if (!std::isfinite(look.promise_mm)) return;
    least.take(ring_mm<wall>(look.best_back_mm, radius_at_mm(look.best_back_mm)), look.best_back_mm);
  }

  template <WallKind wall>
  void go_on(Look& look) const noexcept {
    go_on(look, centre_mm<wall>(look.back_mm), radius_at_mm(look.back_mm));
  }
  void go_on(Look& look, double centre_distance_mm, double radius_mm) const noexcept {
    const double back_mm = look.back_mm;
    const double bound_mm = centre_distance_mm - radius_mm;
    const double above_mm = bound_mm - look.promise_mm;
    if (bound_mm < look.promise_mm) {
      look.promise_mm = bound_mm;
      look.best_back_mm = back_mm;
    }
    // The widest part behind may promise more than this place does.
    const double sure_mm = above_mm - (bit_.radius_mm() - radius_mm);
    if (sure_mm > kCoarseMm && std::isfinite(sure_mm)) {
      look.back_mm = back_mm + sure_mm;
    } else {
      look.back_mm = back_mm + kCoarseMm;
    }
  }

  template <WallKind wall>
  void go_on(Walk& walk, Least& least) const noexcept {
    const double along_mm = walk.along_mm;
    const auto [back_mm, radius_mm] = walk.stretch.at(along_mm);
    double bound_mm = centre_mm<wall>(back_mm) - radius_mm;
    if (bound_mm < least.mm - kGoodEnough) {
      bound_mm = ring_mm<wall>(back_mm, radius_mm);
      least.take(bound_mm, back_mm);
    }
    if (along_mm >= walk.stretch.length_mm()) {
      walk.is_on = false;
      return;
    }
    const double sure_mm = bound_mm - least.mm;
    double next_mm = along_mm + kFineMm;
    if (!std::isfinite(bound_mm)) {
      next_mm = along_mm + kUnknownMm;
    } else if (sure_mm > kFineMm) {
      next_mm = along_mm + sure_mm;
    }
    walk.along_mm = next_mm < walk.stretch.length_mm() ? next_mm : walk.stretch.length_mm();
  }

  /// The least distance on a ring around the axis.
  template <WallKind wall>
  double ring_mm(double back_mm, double radius_mm) const noexcept {
    if (!(radius_mm > 0.0)) return centre_mm<wall>(back_mm);
    const Vec3 middle = place(back_mm);
    const auto at = [&](double angle) {
      return distance_mm<wall>(middle + radius_mm * (std::cos(angle) * across_ + std::sin(angle) * second_));
    };
    std::array<double, kDirections> values_mm{};
    for (std::size_t n = 0; n < kDirections; ++n) {
      values_mm[n] = distance_mm<wall>(middle + radius_mm * around_[n]);
    }
    // Half out of the lattice: what is not known may be as bad as can be.
    if (*std::max_element(values_mm.begin(), values_mm.end()) == std::numeric_limits<double>::infinity()) {
      return centre_mm<wall>(back_mm) - radius_mm;
    }
    const auto best =
        static_cast<std::size_t>(std::min_element(values_mm.begin(), values_mm.end()) - values_mm.begin());
    double min_mm = values_mm[best];
    double angle = static_cast<double>(best) * kTurn;
    double before_mm = values_mm[(best + kDirections - 1) % kDirections];
    double after_mm = values_mm[(best + 1) % kDirections];
    double half_turn = kTurn;
    static const std::array<double, 2> cosines{std::cos(kTurn), std::cos(0.25 * kTurn)};
    static const std::array<double, 2> sines{std::sin(kTurn), std::sin(0.25 * kTurn)};
    for (std::size_t round = 0; round < 2; ++round) {
      // Around the ring a flat wall's distance is a sinusoid: through three of its values goes one.
      const double across = (before_mm - after_mm) * (1.0 - cosines[round]);
      const double along = (before_mm + after_mm - 2.0 * min_mm) * sines[round];
      if (!(along > 0.0) || !std::isfinite(across)) break;
      const double turned = angle + std::clamp(std::atan2(across, along), -half_turn, half_turn);
      const double there_mm = at(turned);
      if (there_mm < min_mm) {
        min_mm = there_mm;
        angle = turned;
      }
      if (round > 0) break;
      half_turn = 0.25 * kTurn;
      before_mm = at(angle - half_turn);
      after_mm = at(angle + half_turn);
    }
    return std::min({min_mm, before_mm, after_mm});
  }

  const WallLattice& distances_;
  const BitProfile& bit_;
  Pose pose_;
  Vec3 across_, second_;
  std::array<Vec3, kDirections> around_;
  AxisPart outer_part_, canal_part_;
  /// The last piece, where it is a cylinder: most of a drill.
  double shank_begin_mm_ = std::numeric_limits<double>::infinity(), shank_end_mm_ = 0.0, shank_radius_mm_ = 0.0;
  bool is_within_ = false;  ///< all places that may be looked at are in the lattice
};

/// Looks for the place of a box that is least far from one wall: boxes that may not beat the best are left out, others
/// halved, down to some that are so small that their corners tell.
class MinDistanceOfBox {
 public:
  MinDistanceOfBox(const WallLattice& distances, const Pose& pose_path, WallKind wall)
      : distances_(distances), tip_mm_(pose_path.tip_mm), columns_(plate_rows(pose_path).transpose()), wall_(wall) {}

  void find(const PlateBox& plate, double from_back_mm, double to_back_mm) noexcept {
    if (!(to_back_mm >= from_back_mm)) return;
    Vec3 low = plate.low_mm(), high = plate.high_mm();
    low.z() = std::max(low.z(), from_back_mm);
    high.z() = std::min(high.z(), to_back_mm);
    const Vec3 middle = 0.5 * (low + high), half = 0.5 * (high - low);
    take_corners(middle, half);
    look(middle, half);
  }

  double min_mm() const { return min_mm_; }
  double back_mm() const { return min_back_mm_; }

 private:
  static constexpr double kSmallMm = 0.5 * ClearanceField::kSpacingMm;  ///< half a side
  static constexpr double kGoodEnoughMm = 0.01;                         ///< that a box must promise to beat the best by

  double at(const Vec3& seen) const { return distances_.distance_mm(tip_mm_ + columns_ * seen, wall_); }

  void take_corners(const Vec3& middle, const Vec3& half) noexcept {
    for (unsigned corner = 0; corner < 8; ++corner) {
      const Vec3 sign((corner & 1U) != 0 ? 1.0 : -1.0, (corner & 2U) != 0 ? 1.0 : -1.0,
                      (corner & 4U) != 0 ? 1.0 : -1.0);
      const Vec3 seen = middle + half.cwiseProduct(sign);
      const double distance_mm = at(seen);
      if (!(distance_mm < min_mm_)) continue;
      min_mm_ = distance_mm;
      min_back_mm_ = seen.z();
    }
  }

  void look(const Vec3& middle, const Vec3& half) noexcept {
    const double distance_mm = at(middle);
    if (std::isfinite(distance_mm)) {
      if (distance_mm - half.norm() >= min_mm_ - kGoodEnoughMm) return;
    } else {
      // Outside the lattice there is no bound, but what reaches into it may have one.
      const double outside_mm = distances_.outside_mm(tip_mm_ + columns_ * middle);
      if (outside_mm == 0.0 || outside_mm > half.norm()) return;
    }
    Eigen::Index longest = 0;
    if (half.maxCoeff(&longest) <= kSmallMm) {
      take_corners(middle, half);
      return;
    }
    Vec3 halved = half;
    halved[longest] *= 0.5;
    const Vec3 step = halved[longest] * Vec3::Unit(longest);
    const bool low_first = at(middle - step) < at(middle + step);
    look(low_first ? Vec3(middle - step) : Vec3(middle + step), halved);
    look(low_first ? Vec3(middle + step) : Vec3(middle - step), halved);
  }

  const WallLattice& distances_;
  Vec3 tip_mm_;
  Mat3 columns_;
  WallKind wall_;
  double min_mm_ = std::numeric_limits<double>::infinity();
  double min_back_mm_ = 0.0;
};

/// The part of a bit's axis, back from the tip, that is at least so deep along a path.
AxisPart deeper_than(double depth_mm, double tip_depth_mm, double axis_along, double length_mm) {
  constexpr double kAcross = 1e-9;
  if (std::abs(axis_along) < kAcross) return {0.0, tip_depth_mm >= depth_mm ? length_mm : -1.0};
  const double back_mm = (tip_depth_mm - depth_mm) / axis_along;
  return axis_along > 0.0 ? AxisPart{0.0, std::min(length_mm, back_mm)} : AxisPart{std::max(0.0, back_mm), length_mm};
}

/// The part of a bit's axis at `pose` that is at least so deep along a curve, which short bits follow: from the tip
/// back to where halving finds it, to 0.01 mm.
AxisPart deeper_along(const PathCurve& curve, double depth_mm, const Pose& pose, double length_mm) {
  const auto is_deep = [&](double back_mm) { return curve.nearest_mm(pose.tip_mm - back_mm * pose.axis) >= depth_mm; };
  const bool tip_is_deep = is_deep(0.0), base_is_deep = is_deep(length_mm);
  if (tip_is_deep == base_is_deep) return {0.0, tip_is_deep ? length_mm : -1.0};
  constexpr double kNearMm = 0.01;
  double deep_mm = tip_is_deep ? 0.0 : length_mm, shallow_mm = tip_is_deep ? length_mm : 0.0;
  while (std::abs(deep_mm - shallow_mm) > kNearMm) {
    const double middle_mm = 0.5 * (deep_mm + shallow_mm);
    (is_deep(middle_mm) ? deep_mm : shallow_mm) = middle_mm;
  }
  return tip_is_deep ? AxisPart{0.0, deep_mm} : AxisPart{deep_mm, length_mm};
}

/// What the entry opening is looked for with: the bit, and for a plate a round one as wide as its diagonal.
DrillPath opened_by(DrillPath path) {
  path.screw.reset();
  if (path.bit.is_plate()) {
    constexpr double kTipMm = 0.1;
    const double diagonal_mm = std::hypot(path.bit.diameter_mm, path.bit.thickness_mm);
    path.bit = {diagonal_mm, path.bit.length_mm + kTipMm, kTipMm};
  }
  return path;
}

}  // namespace

ClearanceField::ClearanceField(const WallDistance& walls, const DrillPath& path, double reach_mm, double behind_mm,
                               double beyond_mm, const Progress& progress)
    : ClearanceField(lattice_of(std::array{&walls}, path, reach_mm, behind_mm, beyond_mm, progress), path) {}

ClearanceField::ClearanceField(std::span<const WallDistance* const> walls, const DrillPath& path,
                               const Progress& progress)
    : ClearanceField(lattice_of(walls, path, reach_of(path), kBehindMm, kBeyondMm, progress), path) {}

std::shared_ptr<const ClearanceField::Lattice> ClearanceField::lattice_of(std::span<const WallDistance* const> walls,
                                                                          const DrillPath& path, double reach_mm,
                                                                          double behind_mm, double beyond_mm,
                                                                          const Progress& progress, double spacing_mm) {
  if (walls.empty()) fail("clearances: expected the walls of a bone, found none");
  return std::make_shared<const Lattice>(
      Lattice{*walls.front(), WallLattice(walls, path, spacing_mm, reach_mm, behind_mm, beyond_mm, progress)});
}

ClearanceField::ClearanceField(std::shared_ptr<const Lattice> lattice, const DrillPath& path)
    : lattice_(std::move(lattice)),
      curve_(path),
      entry_end_mm_(spinaltap::entry_end_mm(lattice_->walls, opened_by(path))) {}

namespace {

constexpr double kAroundBonesMm = 3.0;

/// A line through the middle of a box, from one of its faces to the other, as a path.
DrillPath line_through(const Box3& box_mm) {
  if (box_mm.isEmpty()) fail("clearances: expected bone in a box, found an empty one");
  DrillPath line;
  line.entry_mm = line.target_mm = box_mm.center();
  line.entry_mm.z() = box_mm.min().z();
  line.target_mm.z() = box_mm.max().z();
  return line;
}

double reach_about(const Box3& box_mm) { return 0.5 * box_mm.sizes().head<2>().norm() + kAroundBonesMm; }

}  // namespace

ClearanceField::ClearanceField(std::span<const WallDistance* const> walls, const Box3& bones_mm,
                               const Progress& progress)
    : ClearanceField(lattice_of(walls, line_through(bones_mm), reach_about(bones_mm), kAroundBonesMm, kAroundBonesMm,
                                progress, kFreeSpacingMm),
                     PathCurve(line_through(bones_mm))) {}

ClearanceField::ClearanceField(std::shared_ptr<const Lattice> lattice, const PathCurve& line)
    : lattice_(std::move(lattice)),
      curve_(line),
      entry_end_mm_(std::numeric_limits<double>::infinity()),
      has_path_(false) {}

ClearanceField::~ClearanceField() = default;
ClearanceField::ClearanceField(ClearanceField&&) noexcept = default;

ClearanceField ClearanceField::with_entry_of(const DrillPath& path) const {
  if (!has_path_) return {lattice_, curve_};
  return {lattice_, path};
}

std::size_t ClearanceField::memory_bytes() const { return lattice_->distances.memory_bytes(); }

/// `find(parts)`: the least distances of the parts of a tool's axis that count for each wall.
template <class Find>
Clearance ClearanceField::found(double length_mm, const Pose& pose, const Find& find) const noexcept {
  Clearance clearance;
  if (!pose.tip_mm.allFinite() || !pose.axis.allFinite()) return clearance;
  OfWalls<AxisPart> parts;
  if (!has_path_) {
    parts[number_of(WallKind::canal)] = {0.0, length_mm};
    const Least canal = find(parts)[number_of(WallKind::canal)];
    clearance.canal_mm = canal.mm;
    clearance.canal_at_mm = pose.tip_mm - canal.back_mm * pose.axis;
    return clearance;
  }
  const double tip_depth_mm = curve_.nearest_mm(pose.tip_mm);
  const double axis_along = pose.axis.dot(curve_.direction_at(tip_depth_mm));
  const auto part = [&](double depth_mm) {
    return curve_.is_straight() ? deeper_than(depth_mm, tip_depth_mm, axis_along, length_mm)
                                : deeper_along(curve_, depth_mm, pose, length_mm);
  };
  parts[number_of(WallKind::outer)] = part(entry_end_mm_);
  parts[number_of(WallKind::canal)] = part(0.0);
  const OfWalls<Least> least = find(parts);
  const Least &outer = least[number_of(WallKind::outer)], &canal = least[number_of(WallKind::canal)];
  clearance.outer_mm = outer.mm;
  clearance.canal_mm = canal.mm;
  clearance.outer_at_mm = pose.tip_mm - outer.back_mm * pose.axis;
  clearance.canal_at_mm = pose.tip_mm - canal.back_mm * pose.axis;
  return clearance;
}

Clearance ClearanceField::of(const BitProfile& bit, const Pose& pose) const noexcept {
  const WallLattice& distances = lattice_->distances;
  return found(bit.length_mm(), pose, [&](const OfWalls<AxisPart>& parts) {
    return MinDistance(distances, bit, distances.frame().to_path(pose), parts).find();
  });
}

Clearance ClearanceField::of(const PlateBox& plate, const Pose& pose) const noexcept {
  const WallLattice& distances = lattice_->distances;
  const Pose pose_path = distances.frame().to_path(pose);
  return found(plate.length_mm(), pose, [&](const OfWalls<AxisPart>& parts) {
    OfWalls<Least> least;
    for (const WallKind wall : {WallKind::outer, WallKind::canal}) {
      MinDistanceOfBox search(distances, pose_path, wall);
      search.find(plate, parts[number_of(wall)].from_mm, parts[number_of(wall)].to_mm);
      least[number_of(wall)] = {search.min_mm(), search.back_mm()};
    }
    return least;
  });
}

TipPlace ClearanceField::tip_at(const Pose& pose) const noexcept {
  constexpr double kStepMm = 0.25;  // the lattice's distances are no surer over less
  const WallLattice& distances = lattice_->distances;
  TipPlace place;
  if (!pose.tip_mm.allFinite() || !pose.axis.allFinite()) return place;
  const Pose from = distances.frame().to_path(pose);
  place.inside_mm = distances.inside_mm(from.tip_mm);
  if (!(place.inside_mm > 0.0)) {
    place.ahead_mm = 0.0;
    return place;
  }
  // A place of bone has bone all around as far as its distance.
  double before_mm = 0.0, before_inside_mm = place.inside_mm;
  while (std::isfinite(before_inside_mm) && before_mm < kAheadMm) {
    const double ahead_mm = before_mm + std::max(kStepMm, before_inside_mm);
    const double inside_mm = distances.inside_mm(from.tip_mm + ahead_mm * from.axis);
    if (inside_mm <= 0.0) {
      place.ahead_mm = before_mm + (ahead_mm - before_mm) * before_inside_mm / (before_inside_mm - inside_mm);
      return place;
    }
    before_mm = ahead_mm;
    before_inside_mm = inside_mm;
  }
  return place;
}

Vec3 ClearanceField::into_bone_at(const Vec3& p_mm) const noexcept {
  const WallLattice& distances = lattice_->distances;
  const Vec3 p_path = distances.frame().to_path(Pose{p_mm, Vec3::UnitZ()}).tip_mm;
  Vec3 slope;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 step = kSpacingMm * Vec3::Unit(axis);
    slope[axis] = distances.inside_mm(p_path + step) - distances.inside_mm(p_path - step);
  }
  const double length = slope.norm();
  if (!(length > 0.0) || !std::isfinite(length)) return Vec3::Zero();
  return distances.frame().to_patient(Pose{Vec3::Zero(), slope / length}).axis;
}

}  // namespace spinaltap
