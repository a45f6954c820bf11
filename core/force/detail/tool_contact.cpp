#include "core/force/detail/tool_contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace spinaltap {
namespace {

constexpr int kPlacesAround = 16;
constexpr std::size_t kProbesAround = 6;

/// Cosine and sine of even steps around a chisel edge's disc.
const std::array<Eigen::Vector2d, kProbesAround>& probes_around() noexcept {
  static const std::array<Eigen::Vector2d, kProbesAround> around = [] {
    std::array<Eigen::Vector2d, kProbesAround> made;
    for (std::size_t n = 0; n < kProbesAround; ++n) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(n + 1) / kProbesAround;
      made[n] = {std::cos(angle), std::sin(angle)};
    }
    return made;
  }();
  return around;
}

}  // namespace

ToolContact::ToolContact(const OccupiedBone& bone, const DrillBit& bit) : bone_(&bone), is_plate_(bit.is_plate()) {
  if (is_plate_) {
    const PlateBox box(bit);
    section_mm2_ = bit.diameter_mm * bit.thickness_mm;
    add_box(box);
  } else {
    const BitProfile profile(bit);
    section_mm2_ = std::numbers::pi * bit.radius_mm() * bit.radius_mm();
    add_body(profile, bit.radius_mm());
  }
}

void ToolContact::add_body(const BitProfile& profile, double widest_mm) {
  const double pi = std::numbers::pi;
  double before_mm = 0.0;
  double begin_mm = 0.0;
  // A flat face at right angles to the axis, where a piece begins wider or narrower than the last ended.
  const auto add_face = [&](double back_mm, double from_mm, double to_mm) {
    if (from_mm == to_mm) return;
    const double inner_mm = std::min(from_mm, to_mm);
    const double outer_mm = std::max(from_mm, to_mm);
    constexpr int kRings = 4;
    const auto radius_of = [&](double share) {
      return std::sqrt(inner_mm * inner_mm + share * (outer_mm * outer_mm - inner_mm * inner_mm));
    };
    for (int n = 0; n < kRings; ++n) {
      add_ring(back_mm, radius_of((n + 0.5) / kRings), to_mm > from_mm ? -1.0 : 1.0, 0.0,
               pi * (outer_mm * outer_mm - inner_mm * inner_mm) / kRings);
    }
  };
  for (const ProfilePiece& piece : profile.pieces()) {
    add_face(piece.begin_mm, before_mm, piece.begin_radius_mm);
    const double length_mm = piece.end_mm - piece.begin_mm;
    // Heads in eighths or finer, long shanks by half a radius.
    const int rings = static_cast<int>(std::clamp(std::ceil(2.0 * length_mm / widest_mm), 8.0, 200.0));
    for (int n = 0; n < rings; ++n) {
      const double back_mm = piece.begin_mm + (n + 0.5) / rings * length_mm;
      const double radius_mm = std::sqrt(std::max(0.0, piece.radius_squared_mm2(back_mm)));
      // radius times its slope is half the slope of radius²: along (-slope, 1) points the normal.
      const double half_slope = 0.5 * piece.square[1] + piece.square[2] * back_mm;
      const double long_mm = std::hypot(half_slope, radius_mm);
      if (!(long_mm > 0.0)) continue;
      // A band's area is its length along the axis times 2 pi radius sqrt(1 + slope²).
      add_ring(back_mm, radius_mm, -half_slope / long_mm, radius_mm / long_mm, 2.0 * pi * long_mm * length_mm / rings);
    }
    before_mm = piece.end_radius_mm;
    begin_mm = piece.end_mm;
  }
  add_face(begin_mm, before_mm, 0.0);
}

void ToolContact::add_ring(double back_mm, double radius_mm, double normal_back, double normal_off, double area_mm2) {
  const double max_mm = std::sqrt(section_mm2_ / std::numbers::pi);
  for (int n = 0; n < kPlacesAround; ++n) {
    const double angle = 2.0 * std::numbers::pi * (n + 0.5) / kPlacesAround;
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    places_.push_back({back_mm, radius_mm * c, radius_mm * s, normal_back, normal_off * c, normal_off * s,
                       area_mm2 / (kPlacesAround * section_mm2_), max_mm});
  }
}

void ToolContact::add_box(const PlateBox& box) {
  constexpr double kPitchMm = 2.0;
  const Vec3 middle = 0.5 * (box.low_mm() + box.high_mm());
  const Vec3 half = 0.5 * (box.high_mm() - box.low_mm());
  for (Eigen::Index n = 0; n < 3; ++n) {
    const Eigen::Index u = (n + 1) % 3, v = (n + 2) % 3;
    // A narrow face has three places across it: its middle and near both edges.
    const auto count = [&](Eigen::Index along) { return std::max(3.0, std::ceil(2.0 * half[along] / kPitchMm)); };
    const double across_u = count(u), across_v = count(v);
    const double share = 4.0 * half[u] * half[v] / (across_u * across_v * section_mm2_);
    for (const double sign : {-1.0, 1.0}) {
      for (double i = 0.5; i < across_u; ++i) {
        for (double j = 0.5; j < across_v; ++j) {
          Vec3 at = middle + sign * half[n] * Vec3::Unit(n);
          at[u] += half[u] * (2.0 * i / across_u - 1.0);
          at[v] += half[v] * (2.0 * j / across_v - 1.0);
          const Vec3 normal = sign * Vec3::Unit(n);
          places_.push_back({at.z(), at.x(), at.y(), normal.z(), normal.x(), normal.y(), share, half[n]});
        }
      }
    }
  }
}

/// How far bone reaches from `p` inwards into the bit.
double ToolContact::depth_mm(const Vec3& p, const Vec3& inward, double max_mm) const noexcept {
  const double step_mm = bone_->spacing_mm(p);
  double bone_mm = 0.0;
  while (bone_mm < max_mm && bone_->occupied_at(p + (bone_mm + step_mm) * inward) != nullptr) bone_mm += step_mm;
  if (bone_mm >= max_mm) return max_mm;
  // Between a place in bone and one out of it: where the nearest point changes, so that the depth follows the bit.
  double free_mm = bone_mm + step_mm;
  for (int n = 0; n < 7; ++n) {
    const double middle_mm = 0.5 * (bone_mm + free_mm);
    (bone_->occupied_at(p + middle_mm * inward) != nullptr ? bone_mm : free_mm) = middle_mm;
  }
  return bone_mm;
}

Vec3 ToolContact::contact_n(const Pose& pose, ContactStiffnessSum* stiffness) const noexcept {
  const Vec3 u = is_plate_ ? pose.side : any_perpendicular(pose.axis);
  const Vec3 v = pose.axis.cross(u);
  Vec3 force_n = Vec3::Zero();
  for (const Place& place : places_) {
    const Vec3 p = pose.tip_mm - place.back_mm * pose.axis + place.across_x_mm * u + place.across_y_mm * v;
    const OccupiedBone::Bone* bone = bone_->occupied_at(p);
    if (bone == nullptr) continue;
    const Vec3 inward = place.normal_back * pose.axis - place.normal_x * u - place.normal_y * v;
    const double stiff_n_mm = place.share * bone->contact_n_mm;
    const double push_n = stiff_n_mm * depth_mm(p, inward, place.max_mm);
    force_n += push_n * inward;
    if (stiffness != nullptr) stiffness->add(p - pose.tip_mm, inward, stiff_n_mm, push_n);
  }
  return force_n;
}

OccupiedBone::Mean ChiselProbe::ahead_of(const Pose& pose) const noexcept {
  // A centre and six around it stand for equal shares of the disc: radius² of the centre's share is a seventh of the
  // whole, and the six lie at their share's centroid.
  constexpr double kShare = 1.0 / (kProbesAround + 1);
  const double off_mm = 0.703 * edge_radius_mm_;
  if (width_mm_ > 0.0) {
    OccupiedBone::Mean along_edge;
    constexpr int kPlaces = 15;
    for (int n = 0; n < kPlaces; ++n) {
      const double off = width_mm_ * ((n + 0.5) / kPlaces - 0.5);
      bone_->add_ahead_of(pose.tip_mm + off * pose.side, pose.axis, 1.0 / kPlaces, along_edge);
    }
    return along_edge;
  }
  const Vec3 u = any_perpendicular(pose.axis);
  const Vec3 v = pose.axis.cross(u);
  OccupiedBone::Mean mean;
  bone_->add_ahead_of(pose.tip_mm, pose.axis, kShare, mean);
  for (const Eigen::Vector2d& around : probes_around()) {
    const Vec3 p = pose.tip_mm + off_mm * (around.x() * u + around.y() * v);
    bone_->add_ahead_of(p, pose.axis, kShare, mean);
  }
  return mean;
}

}  // namespace spinaltap
