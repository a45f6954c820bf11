#include "core/segment/vertebra_markers.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace spinaltap {
namespace {

/// Calls `visit(offset, p_patient)` for all voxels, slices in parallel.
template <class Visit>
void for_all(const GridGeometry& geometry, const Visit& visit) {
  tbb::parallel_for(0, geometry.size[2], [&](int k) {
    std::size_t voxel = geometry.offset(0, 0, k);
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) visit(voxel++, geometry.to_patient(Vec3(i, j, k)));
    }
  });
}

/// The same for those of the box around a sphere.
template <class Visit>
void for_near(const GridGeometry& geometry, const Vec3& centre_mm, double radius_mm, const Visit& visit) {
  const Eigen::Array3d middle = geometry.to_index(centre_mm).array();
  const Eigen::Array3d reach = radius_mm / geometry.spacing_mm.array();
  const Eigen::Array3d last(geometry.size[0] - 1, geometry.size[1] - 1, geometry.size[2] - 1);
  const Eigen::Array3i low = (middle - reach).floor().max(0.0).min(last).cast<int>();
  const Eigen::Array3i high = (middle + reach).ceil().max(0.0).min(last).cast<int>();
  tbb::parallel_for(low.z(), high.z() + 1, [&](int k) {
    for (int j = low.y(); j <= high.y(); ++j) {
      for (int i = low.x(); i <= high.x(); ++i) visit(geometry.offset(i, j, k), geometry.to_patient(Vec3(i, j, k)));
    }
  });
}

/// A point seen from the body: its own frame, and how far outside the cylinder.
struct Place {
  Vec3 p_body_mm;    ///< to the left, back and up from the middle
  double across;     ///< 1 on the cylinder's side, below 1 within it
  double beyond_mm;  ///< above the upper or below the lower end; negative between
};

class PlaceFinder {
 public:
  explicit PlaceFinder(const BodyCylinder& body) : body_(body), to_body_(body.axes().transpose()) {}

  Place operator()(const Vec3& p_patient) const {
    const Vec3 p = to_body_ * (p_patient - body_.centre_mm);
    return {p, std::hypot(p.x() / body_.half_mm.x(), p.y() / body_.half_mm.y()), std::abs(p.z()) - body_.half_mm.z()};
  }

 private:
  const BodyCylinder& body_;
  Mat3 to_body_;
};

bool is_on_border(const GridGeometry& ct, const Vec3& p_patient, const Vec3& voxel_mm) {
  const Vec3 p = ct.to_index(p_patient);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    const double half_voxel = 0.5 * voxel_mm[a] / ct.spacing_mm[a] + 0.1;
    if (p[a] < half_voxel || p[a] > ct.size[axis] - 1 - half_voxel) return true;
  }
  return false;
}

constexpr double kDeepMm = 1.7;  // away from the wall, whose place is unsure

struct AtVoxel {
  double depth_mm, depth_in_others_mm;
  bool is_rib, is_on_border, is_dense;
  double front_mm;  ///< in front of this only the column itself has bone
};

/// Whether a voxel is so far above or below that it cannot be the vertebra's.
bool is_too_far(const Place& place, const BodyCylinder& body, bool is_on_border) {
  constexpr double kMaxUpMm = 22.0;       // superior articular processes rise less over the endplate,
  constexpr double kMaxDownMm = 55.0;     // spinous processes of the middle thoracic spine hang down less;
  constexpr double kBorderUpMm = 12.0;    // on the CT's border neighbours are cut from their bodies,
  constexpr double kBorderDownMm = 20.0;  // and more likely met than the vertebra's own tips,
  constexpr double kMiddleMm = 7.0;       // but for the spinous process, which reaches down in the middle;
  constexpr double kMiddleUpMm = 2.0;     // there what is above is the upper neighbour's
  const bool above = place.p_body_mm.z() > 0.0;
  const bool spinous = std::abs(place.p_body_mm.x()) < kMiddleMm && place.p_body_mm.y() > body.half_mm.y();
  const double border_mm = above ? (spinous ? kMiddleUpMm : kBorderUpMm) : (spinous ? kMaxDownMm : kBorderDownMm);
  return place.beyond_mm > (is_on_border ? border_mm : above ? kMaxUpMm : kMaxDownMm);
}

WalkerVoxel marker_at(const Place& place, const BodyCylinder& body, const AtVoxel& at) {
  constexpr double kDiscMm = 0.3;      // on the endplate: what noise and blur make of it
  constexpr double kNextBodyMm = 3.5;  // thinner discs are rare, where no body was found on that side
  constexpr double kInFront = 1.3;     // osteophytes reach no further
  const double end_share = std::abs(place.p_body_mm.z()) / body.half_mm.z();
  if (at.depth_in_others_mm > at.depth_mm) {
    if (at.depth_in_others_mm > kDeepMm) return WalkerVoxel::kOther;
    if (at.depth_in_others_mm > 0.0) return WalkerVoxel::kFree;
  }
  if (at.depth_mm > kDeepMm && place.across < 0.9 && end_share < 0.9) return WalkerVoxel::kWanted;
  if (at.is_rib || (place.p_body_mm.y() < at.front_mm && place.across > kInFront)) return WalkerVoxel::kOther;
  if (place.across < 1.0 && place.beyond_mm > kNextBodyMm) return WalkerVoxel::kOther;
  const bool on_endplate =
      (place.across < 1.0 && end_share > 0.6) ||
      (place.across < kInFront && place.beyond_mm > -1.0 && place.p_body_mm.y() < 0.8 * body.half_mm.y());
  if (on_endplate && at.depth_mm < -kDiscMm && !at.is_dense) return WalkerVoxel::kOutside;
  return is_too_far(place, body, at.is_on_border) ? WalkerVoxel::kOther : WalkerVoxel::kFree;
}

}  // namespace

// Panjabi 1991, 1992: C3 to C7 are 16 to 22 mm wide, 15 to 18 deep, 11 to 13 high; T1 is 24 mm wide and 14 high, T4 19
// and more in some, but as deep.
bool BodyInRow::is_cervical() const {
  constexpr double kMaxWidthMm = 23.5, kMaxHeightMm = 14.5, kMinShape = 1.1;  // width over depth
  const Vec3& half_mm = body().cylinder.half_mm;
  return 2.0 * half_mm.x() < kMaxWidthMm && 2.0 * half_mm.z() < kMaxHeightMm && half_mm.x() > kMinShape * half_mm.y();
}

std::vector<float> depth_in_body_mm(const VertebralBody& body, const GridGeometry& geometry) {
  constexpr float kFar = -1000.0F;
  constexpr double kMarginMm = 3.0;
  // wall_edge() is largest this far outside the cortex's crest.
  constexpr double kWallMm = 0.8;
  std::vector<float> depth_mm(geometry.voxel_count(), kFar);
  const double reach_mm = body.surface.largest_radius_mm() + kMarginMm;
  for_near(geometry, body.surface.centre_mm(), reach_mm, [&](std::size_t voxel, const Vec3& p_mm) {
    if ((p_mm - body.surface.centre_mm()).norm() > reach_mm) return;
    const double depth = body.surface.depth_mm(p_mm) - kWallMm;
    const bool held_back = depth > 0.0 && body.cylinder.scale_to(p_mm) > 1.0;
    depth_mm[voxel] = held_back ? -0.01F : static_cast<float>(depth);
  });
  return depth_mm;
}

std::vector<std::uint8_t> voxels_of_rib_heads(std::span<const std::uint8_t> mask, const BodyCylinder& body,
                                              const GridGeometry& geometry) {
  constexpr double kFromMm = 5.0, kToMm = 13.0;  // from the body's side
  constexpr double kBehindMm = 2.0;              // from the body's back: transverse processes begin further back
  std::vector<std::uint8_t> heads(mask.size(), 0);
  const PlaceFinder place_of(body);
  for_all(geometry, [&](std::size_t voxel, const Vec3& p_mm) {
    if (mask[voxel] == 0) return;
    const Vec3 p = place_of(p_mm).p_body_mm;
    const double beside_mm = std::abs(p.x()) - body.half_mm.x();
    heads[voxel] = beside_mm > kFromMm && beside_mm < kToMm && p.y() > -0.5 * body.half_mm.y() &&
                   p.y() < body.half_mm.y() + kBehindMm;
  });
  return heads;
}

std::vector<std::uint8_t> voxels_on_border(const GridGeometry& geometry, const GridGeometry& ct) {
  std::vector<std::uint8_t> border(geometry.voxel_count(), 0);
  for_all(geometry, [&](std::size_t voxel, const Vec3& p_mm) {
    border[voxel] = is_on_border(ct, p_mm, geometry.spacing_mm) ? 1 : 0;
  });
  return border;
}

std::vector<std::uint8_t> voxels_to_the_side(std::span<const std::uint8_t> mask, const BodyCylinder& body,
                                             const GridGeometry& geometry, double from_mm) {
  std::vector<std::uint8_t> side(mask.size(), 0);
  const PlaceFinder place_of(body);
  for_all(geometry, [&](std::size_t voxel, const Vec3& p_mm) {
    if (mask[voxel] != 0 && std::abs(place_of(p_mm).p_body_mm.x()) >= from_mm) side[voxel] = 1;
  });
  return side;
}

namespace {

/// Where the canal crosses the plane at a height above the body's middle; nothing where it does not.
std::optional<Vec3> canal_at(const SpinalCanal& canal, const BodyCylinder& body, double height_mm) {
  const Vec3 up = body.axes().col(2);
  const auto above = [&](const Vec3& p) { return (p - body.centre_mm).dot(up) - height_mm; };
  constexpr double kFarthestMm = 60.0;  // a curved canal may cross the plane again elsewhere
  for (std::size_t n = 0; n + 1 < canal.points_mm.size(); ++n) {
    const Vec3& a = canal.points_mm[n];
    const Vec3& b = canal.points_mm[n + 1];
    if (above(a) > 0.0 || above(b) <= 0.0 || (a - body.centre_mm).norm() > kFarthestMm) continue;
    return Vec3(a + above(a) / (above(a) - above(b)) * (b - a));
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::size_t> lamina_voxels(std::span<const std::uint8_t> bone, const GridGeometry& geometry,
                                       const VertebralBody& vertebra, const SpinalCanal& canal) {
  const BodyCylinder& body = vertebra.cylinder;
  // From the middle of the body downward: higher, the upper neighbour's laminae overlap; lower, they end. Where a cut
  // body's middle is a guess, less is sure.
  const double from = vertebra.is_cut ? -0.4 : -0.6;  // of half the body's height
  constexpr double kTo = 0.1;
  constexpr double kStepMm = 0.8;
  constexpr double kReach = 55.0 * kDegree;  // to either side of straight back: further there are foramina and ribs
  constexpr double kTurn = 3.0 * kDegree;
  constexpr double kMinMm = 3.0;
  constexpr double kMaxMm = 18.0;
  constexpr double kRayStepMm = 0.4;
  constexpr int kSolid = 4;  // bone for this many steps is a wall, less is noise
  constexpr int kDeep = 6;
  const Mat3 axes = body.axes();
  const Mat3 to_index = geometry.index_to_patient_matrix().inverse();
  std::vector<std::size_t> voxels;
  for (double z = from * body.half_mm.z(); z <= kTo * body.half_mm.z(); z += kStepMm) {
    const std::optional<Vec3> centre = canal_at(canal, body, z);
    if (!centre) continue;
    for (double turn = -kReach; turn <= kReach; turn += kTurn) {
      const Vec3 direction = axes * Vec3(std::sin(turn), std::cos(turn), 0.0);
      std::vector<std::size_t> met;
      for (double r = kMinMm; r <= kMaxMm + kDeep * kRayStepMm; r += kRayStepMm) {
        const Vec3 p = to_index * (*centre + r * direction - geometry.origin_mm);
        const Eigen::Array3i at = p.array().round().cast<int>();
        if (!geometry.contains(at.x(), at.y(), at.z())) break;
        const std::size_t voxel = geometry.offset(at.x(), at.y(), at.z());
        if (bone[voxel] == 0) {
          if (static_cast<int>(met.size()) >= kSolid || r > kMaxMm) break;
          met.clear();
          continue;
        }
        met.push_back(voxel);
        if (static_cast<int>(met.size()) == kDeep) break;
      }
      if (static_cast<int>(met.size()) >= kSolid) voxels.insert(voxels.end(), met.begin() + 1, met.end());
    }
  }
  std::sort(voxels.begin(), voxels.end());
  voxels.erase(std::unique(voxels.begin(), voxels.end()), voxels.end());
  return voxels;
}

std::vector<WalkerVoxel> place_markers(const MarkerInput& input, const BodyInRow& row) {
  const GridGeometry& geometry = input.hu.geometry;
  const BodyCylinder& body = row.body().cylinder;
  std::vector<WalkerVoxel> markers(input.bone.size(), WalkerVoxel::kOutside);
  const PlaceFinder place_of(body);
  constexpr double kFrontOfNeck = -0.6;  // of half the depth: anterior tubercles of transverse processes end there
  const double front_mm = row.is_cervical() ? kFrontOfNeck * body.half_mm.y() : 0.0;
  for_all(geometry, [&](std::size_t voxel, const Vec3& p_mm) {
    if (input.bone[voxel] == 0) return;
    markers[voxel] =
        marker_at(place_of(p_mm), body,
                  {static_cast<double>(input.depth_mm[voxel]), static_cast<double>(input.depth_in_others_mm[voxel]),
                   input.ribs[voxel] != 0, is_on_border(input.ct_geometry, p_mm, geometry.spacing_mm),
                   static_cast<double>(input.hu.values[voxel]) >= input.dense_hu, front_mm});
  });
  for (std::size_t n = 0; n < row.bodies.size(); ++n) {
    constexpr double kReachMm = 130.0;  // further than the grid
    if ((row.bodies[n].cylinder.centre_mm - body.centre_mm).norm() > kReachMm) continue;
    for (const std::size_t voxel : lamina_voxels(input.bone, geometry, row.bodies[n], row.canal)) {
      if (markers[voxel] == WalkerVoxel::kFree)
        markers[voxel] = n == row.own ? WalkerVoxel::kWanted : WalkerVoxel::kOther;
    }
  }
  return markers;
}

}  // namespace spinaltap
