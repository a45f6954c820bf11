#include "core/session/tool_clearance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/plan/grade.h"
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

/// Looks for the place of a bit's outline that is least far from one wall. Rings of the outline are bounded from below
/// by the distance at their centre less their radius; only those that may beat the best are walked around.
class MinDistance {
 public:
  MinDistance(const WallLattice& distances, const BitProfile& bit, const Pose& pose_path, WallKind wall,
              double from_back_mm, double to_back_mm)
      : distances_(distances), bit_(bit), pose_(pose_path), wall_(wall), from_mm_(from_back_mm), to_mm_(to_back_mm) {
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
  }

  void find() noexcept {
    if (!(to_mm_ >= from_mm_)) return;
    start_at_the_most_promising();
    // The chisel edge's middle, where a blunt tip looks at a wall.
    if (from_mm_ <= 0.0) take(centre_mm(0.0), 0.0);
    for (const ProfilePiece& piece : bit_.pieces()) walk(piece);
  }

  double min_mm() const { return min_mm_; }
  double back_mm() const { return min_back_mm_; }

 private:
  static constexpr double kCoarseMm = 1.0;                       ///< between the first look's places
  static constexpr double kFineMm = ClearanceField::kSpacingMm;  ///< between rings
  static constexpr double kUnknownMm = 0.5;                      ///< step where there is no distance
  static constexpr double kGoodEnough = 0.01;                    ///< mm that a ring must promise to beat the best by

  static constexpr std::size_t kDirections = 6;
  static constexpr double kTurn = 2.0 * std::numbers::pi / kDirections;

  Vec3 place(double back_mm) const { return pose_.tip_mm - back_mm * pose_.axis; }
  double centre_mm(double back_mm) const { return distances_.distance_mm(place(back_mm), wall_); }
  void take(double distance_mm, double back_mm) {
    if (!(distance_mm < min_mm_)) return;
    min_mm_ = distance_mm;
    min_back_mm_ = back_mm;
  }

  /// A good first value lets the walk leave out most rings.
  void start_at_the_most_promising() {
    double promise_mm = std::numeric_limits<double>::infinity();
    double best_back_mm = 0.0;
    for (double back_mm = from_mm_; back_mm <= to_mm_;) {
      const double radius_mm = std::max(0.0, bit_.widest_mm(back_mm, back_mm));
      const double bound_mm = centre_mm(back_mm) - radius_mm;
      const double above_mm = bound_mm - promise_mm;
      if (bound_mm < promise_mm) {
        promise_mm = bound_mm;
        best_back_mm = back_mm;
      }
      // The widest part behind may promise more than this place does.
      const double sure_mm = above_mm - (bit_.radius_mm() - radius_mm);
      back_mm += std::isfinite(bound_mm) ? std::max(kCoarseMm, std::isfinite(sure_mm) ? sure_mm : 0.0) : kCoarseMm;
    }
    if (std::isfinite(promise_mm)) {
      take(ring_mm(best_back_mm, std::max(0.0, bit_.widest_mm(best_back_mm, best_back_mm))), best_back_mm);
    }
  }

  void walk(const ProfilePiece& piece) {
    const double begin_mm = std::max(piece.begin_mm, from_mm_);
    const double end_mm = std::min(piece.end_mm, to_mm_);
    if (!(end_mm >= begin_mm)) return;
    const OutlineStretch stretch(piece, begin_mm, end_mm);
    for (double along_mm = 0.0;;) {
      const auto [back_mm, radius_mm] = stretch.at(along_mm);
      double bound_mm = centre_mm(back_mm) - radius_mm;
      if (bound_mm < min_mm_ - kGoodEnough) {
        bound_mm = ring_mm(back_mm, radius_mm);
        take(bound_mm, back_mm);
      }
      if (along_mm >= stretch.length_mm()) return;
      const double step_mm = std::isfinite(bound_mm) ? std::max(kFineMm, bound_mm - min_mm_) : kUnknownMm;
      along_mm = std::min(along_mm + step_mm, stretch.length_mm());
    }
  }

  /// The least distance on a ring around the axis.
  double ring_mm(double back_mm, double radius_mm) const {
    if (!(radius_mm > 0.0)) return centre_mm(back_mm);
    const Vec3 middle = place(back_mm);
    const auto at = [&](double angle) {
      return distances_.distance_mm(middle + radius_mm * (std::cos(angle) * across_ + std::sin(angle) * second_),
                                    wall_);
    };
    std::array<double, kDirections> values_mm{};
    for (std::size_t n = 0; n < kDirections; ++n) {
      values_mm[n] = distances_.distance_mm(middle + radius_mm * around_[n], wall_);
    }
    // Half out of the lattice: what is not known may be as bad as can be.
    if (*std::max_element(values_mm.begin(), values_mm.end()) == std::numeric_limits<double>::infinity()) {
      return centre_mm(back_mm) - radius_mm;
    }
    const auto best =
        static_cast<std::size_t>(std::min_element(values_mm.begin(), values_mm.end()) - values_mm.begin());
    double min_mm = values_mm[best];
    double angle = static_cast<double>(best) * kTurn;
    double before_mm = values_mm[(best + kDirections - 1) % kDirections];
    double after_mm = values_mm[(best + 1) % kDirections];
    double half_turn = kTurn;
    for (int round = 0; round < 2; ++round) {
      // Around the ring a flat wall's distance is a sinusoid: through three of its values goes one.
      const double across = (before_mm - after_mm) * (1.0 - std::cos(half_turn));
      const double along = (before_mm + after_mm - 2.0 * min_mm) * std::sin(half_turn);
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
  WallKind wall_;
  double from_mm_, to_mm_;
  double min_mm_ = std::numeric_limits<double>::infinity();
  double min_back_mm_ = 0.0;
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
std::pair<double, double> deeper_than(double depth_mm, double tip_depth_mm, double axis_along, double length_mm) {
  constexpr double kAcross = 1e-9;
  if (std::abs(axis_along) < kAcross) return {0.0, tip_depth_mm >= depth_mm ? length_mm : -1.0};
  const double back_mm = (tip_depth_mm - depth_mm) / axis_along;
  return axis_along > 0.0 ? std::pair(0.0, std::min(length_mm, back_mm)) : std::pair(std::max(0.0, back_mm), length_mm);
}

/// The part of a bit's axis at `pose` that is at least so deep along a curve, which short bits follow: from the tip
/// back to where halving finds it, to 0.01 mm.
std::pair<double, double> deeper_along(const PathCurve& curve, double depth_mm, const Pose& pose, double length_mm) {
  const auto is_deep = [&](double back_mm) { return curve.nearest_mm(pose.tip_mm - back_mm * pose.axis) >= depth_mm; };
  const bool tip_is_deep = is_deep(0.0), base_is_deep = is_deep(length_mm);
  if (tip_is_deep == base_is_deep) return {0.0, tip_is_deep ? length_mm : -1.0};
  constexpr double kNearMm = 0.01;
  double deep_mm = tip_is_deep ? 0.0 : length_mm, shallow_mm = tip_is_deep ? length_mm : 0.0;
  while (std::abs(deep_mm - shallow_mm) > kNearMm) {
    const double middle_mm = 0.5 * (deep_mm + shallow_mm);
    (is_deep(middle_mm) ? deep_mm : shallow_mm) = middle_mm;
  }
  return tip_is_deep ? std::pair(0.0, deep_mm) : std::pair(deep_mm, length_mm);
}

/// What the entry opening is looked for with: the bit, and for a plate a round one as wide as its diagonal.
DrillPath opened_by(DrillPath path) {
  path.screw.reset();
  if (path.bit.shape == BitShape::plate) {
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
                                                                          const Progress& progress) {
  if (walls.empty()) fail("clearances: expected the walls of a bone, found none");
  return std::make_shared<const Lattice>(
      Lattice{*walls.front(), WallLattice(walls, path, kSpacingMm, reach_mm, behind_mm, beyond_mm, progress)});
}

ClearanceField::ClearanceField(std::shared_ptr<const Lattice> lattice, const DrillPath& path)
    : lattice_(std::move(lattice)),
      curve_(path),
      entry_end_mm_(spinaltap::entry_end_mm(lattice_->walls, opened_by(path))) {}

ClearanceField::~ClearanceField() = default;
ClearanceField::ClearanceField(ClearanceField&&) noexcept = default;

ClearanceField ClearanceField::with_entry_of(const DrillPath& path) const { return {lattice_, path}; }

std::size_t ClearanceField::memory_bytes() const { return lattice_->distances.memory_bytes(); }

/// `find(wall, from_mm, to_mm)`: the least distance of the tool's part from `from_mm` to `to_mm` back from its tip, and
/// how far back that is.
template <class Find>
Clearance ClearanceField::found(double length_mm, const Pose& pose, const Find& find) const noexcept {
  Clearance clearance;
  if (!pose.tip_mm.allFinite() || !pose.axis.allFinite()) return clearance;
  const double tip_depth_mm = curve_.nearest_mm(pose.tip_mm);
  const double axis_along = pose.axis.dot(curve_.direction_at(tip_depth_mm));
  const auto min = [&](WallKind wall, double depth_mm, double& distance_mm, Vec3& at_mm) {
    const auto [from_mm, to_mm] = curve_.is_straight() ? deeper_than(depth_mm, tip_depth_mm, axis_along, length_mm)
                                                       : deeper_along(curve_, depth_mm, pose, length_mm);
    const auto [least_mm, back_mm] = find(wall, from_mm, to_mm);
    distance_mm = least_mm;
    at_mm = pose.tip_mm - back_mm * pose.axis;
  };
  min(WallKind::outer, entry_end_mm_, clearance.outer_mm, clearance.outer_at_mm);
  min(WallKind::canal, 0.0, clearance.canal_mm, clearance.canal_at_mm);
  return clearance;
}

Clearance ClearanceField::of(const BitProfile& bit, const Pose& pose) const noexcept {
  const WallLattice& distances = lattice_->distances;
  const Pose pose_path = distances.frame().to_path(pose);
  return found(bit.length_mm(), pose, [&](WallKind wall, double from_mm, double to_mm) {
    MinDistance search(distances, bit, pose_path, wall, from_mm, to_mm);
    search.find();
    return std::pair(search.min_mm(), search.back_mm());
  });
}

Clearance ClearanceField::of(const PlateBox& plate, const Pose& pose) const noexcept {
  const WallLattice& distances = lattice_->distances;
  const Pose pose_path = distances.frame().to_path(pose);
  return found(plate.length_mm(), pose, [&](WallKind wall, double from_mm, double to_mm) {
    MinDistanceOfBox search(distances, pose_path, wall);
    search.find(plate, from_mm, to_mm);
    return std::pair(search.min_mm(), search.back_mm());
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
