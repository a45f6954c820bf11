#include "vdb/engine/detail/round_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace spinaltap::detail {
namespace {

/// Of doubles, with room.
constexpr double kRoundSpareMm = 1e-6;
/// The diagonal of a leaf, in voxels, with room.
constexpr double kLeafVoxels = 14.0;
/// Of a cylinder's axis along z, from where on its rows are those along y.
constexpr double kSteep = 0.75;

}  // namespace

RoundRows::RoundRows(const ToolBounds& bounds, double voxel_mm) : voxel_mm_(voxel_mm) {
  for (std::size_t n = 0; n < bounds.pieces().size(); ++n) {
    const ToolBounds::Piece& piece = bounds.pieces()[n];
    const bool is_ball = piece.ball_radius_mm > 0.0;
    if (!is_ball && piece.per_back != 0.0) continue;
    pieces_ |= 1U << n;
    Round& round = rounds_[n];
    round = {is_ball,
             is_ball ? piece.ball_radius_mm : -piece.at_origin_mm,
             piece.begin_mm,
             piece.end_mm,
             piece.ball_centre_mm,
             0.0};
    constexpr double kNowhere = std::numeric_limits<double>::infinity();
    if (is_ball && piece.begin_mm <= piece.ball_centre_mm - piece.ball_radius_mm + kRoundSpareMm)
      round.begin_mm = -kNowhere;
    if (is_ball && piece.end_mm >= piece.ball_centre_mm + piece.ball_radius_mm - kRoundSpareMm) round.end_mm = kNowhere;
    // Some 2^-24 of what each of a dozen operations has, squared, with room.
    const double far = round.radius_mm / voxel_mm + kLeafVoxels;
    round.rounding = 6e-6 * far * far;
  }
}

void RoundRows::take(const SweptBounds& tool) noexcept {
  constexpr double kShortWayMm = 0.1;
  const auto pieces = tool.pieces();
  const Pose &from = pieces.front().from(), &to = pieces.back().to();
  const bool is_straight = tool.line().edge_mm == 0.0;
  skin_mm_ = SweepProfile::kEdge * (is_straight ? SweepProfile::kStraightSkinMm : SweepProfile::kTurningSkinMm);
  if (pieces.size() > 1) {
    parts_ = pieces.size();
    for (std::size_t n = 0; n < parts_; ++n) moments_[n] = {pieces[n].from().tip_mm, pieces[n].from().axis};
  } else {
    const Vec3 way = to.tip_mm - from.tip_mm;
    parts_ = static_cast<std::size_t>(std::clamp(std::ceil(way.norm() / kShortWayMm), 1.0, double{kMaxParts}));
    for (std::size_t n = 0; n < parts_; ++n) {
      const double share = static_cast<double>(n) / static_cast<double>(parts_);
      moments_[n] = {from.tip_mm + share * way, (from.axis + share * (to.axis - from.axis)).normalized()};
    }
  }
  moments_[parts_] = {to.tip_mm, to.axis};
  is_end_enough_ = parts_ == 1 && is_straight;
  per_piece_ = static_cast<double>(pieces.size()) / static_cast<double>(parts_);
}

void RoundRows::put(std::size_t number, const std::uint64_t* words, const Vec3& first_mm, const BitPlace& centre,
                    double half_mm, const SweptBounds::Reach& reach, RowArguments& rows) const noexcept {
  const Round& round = rounds_[number];
  const double per_mm = 1.0 / voxel_mm_;
  rows.words = words;
  rows.is_ball = round.is_ball;
  rows.has_ends =
      centre.back_mm - half_mm - reach.body < round.begin_mm || centre.back_mm + half_mm + reach.body > round.end_mm;
  rows.along_y = !round.is_ball && std::abs(moments_[parts_].axis.z()) > kSteep;
  const bool is_end_enough = is_end_enough_ && !rows.has_ends;
  const double part_mm = per_piece_ * reach.piece * (is_end_enough ? 1.0 : 0.5);
  const double in_mm = round.radius_mm - kRoundSpareMm, out_mm = round.radius_mm + skin_mm_ + kRoundSpareMm;
  const double out_square_mm2 = out_mm * out_mm + part_mm * part_mm;
  rows.in_square = static_cast<float>(per_mm * per_mm * in_mm * std::max(in_mm, 0.0) - round.rounding);
  rows.out_square = static_cast<float>(per_mm * per_mm * out_square_mm2 + round.rounding);
  rows.tolerance = static_cast<float>(2e-6 * (round.radius_mm * per_mm + kLeafVoxels));
  const double near_mm = std::sqrt(out_square_mm2) + half_mm;
  const Vec3 to_middle_mm = Vec3::Constant(3.5 * voxel_mm_);
  rows.place_count = 0;
  for (std::size_t n = parts_ + 1; n-- > (is_end_enough ? parts_ : 0);) {
    const Moment& at = moments_[n];
    Vec3 from = first_mm - at.tip_mm;
    const double back_mm = round.is_ball ? round.centre_mm : -from.dot(at.axis);
    from += back_mm * at.axis;
    const Vec3 middle = from + to_middle_mm;
    const double along_mm = round.is_ball ? 0.0 : middle.dot(at.axis);
    if (n != parts_ && middle.squaredNorm() - along_mm * along_mm > near_mm * near_mm) continue;
    RoundPlace& place = rows.places[rows.place_count++];
    for (unsigned k = 0; k < 3; ++k) {
      const unsigned axis = k > 0 && rows.along_y ? 3 - k : k;
      place.first[k] = static_cast<float>(per_mm * from[axis]);
      place.axis[k] = static_cast<float>(at.axis[axis]);
    }
    place.low = static_cast<float>(per_mm * (back_mm - round.end_mm + kRoundSpareMm) + 1e-4);
    place.high = static_cast<float>(per_mm * (back_mm - round.begin_mm - kRoundSpareMm) - 1e-4);
  }
}

double RoundRows::bound_mm(std::size_t number, float square) const noexcept {
  const Round& round = rounds_[number];
  const double least = static_cast<double>(square) * (1.0 - 1e-5) - round.rounding;
  return voxel_mm_ * std::sqrt(std::max(0.0, least)) - round.radius_mm;
}

}  // namespace spinaltap::detail
