#pragma once

#include "core/segment/random_walker.h"
#include "core/segment/vertebral_body.h"

namespace spinaltap {

/// Deeper than this below the body's wall, mm, all is bone, as dark as cancellous bone may be. Nearer to it CT numbers
/// decide: the wall's place is sure to no more than this, most of all where the canal hollows it.
inline constexpr float kSureDepthMm = 2.5F;

/// Depth of each voxel's centre below the crest of the body's wall (along the ray from its middle), mm; negative
/// outside the surface or outside the cylinder, which holds back a surface that ran into a pedicle or a rib's head.
std::vector<float> depth_in_body_mm(const VertebralBody& body, const GridGeometry& geometry);

/// The voxels of a mask at least `from_mm` to either side of the body's middle plane.
std::vector<std::uint8_t> voxels_to_the_side(std::span<const std::uint8_t> mask, const BodyCylinder& body,
                                             const GridGeometry& geometry, double from_mm);

/// The voxels of a mask where only the heads and necks of ribs can be: beside the body, in front of where transverse
/// processes begin.
std::vector<std::uint8_t> voxels_of_rib_heads(std::span<const std::uint8_t> mask, const BodyCylinder& body,
                                              const GridGeometry& geometry);

/// The voxels of a part of a CT that lie on the CT's border.
std::vector<std::uint8_t> voxels_on_border(const GridGeometry& geometry, const GridGeometry& ct);

/// One vertebra to be parted from its neighbours: `own` of `bodies`, which lie in a row from below upward in front of
/// `canal`.
struct BodyInRow {
  std::span<const VertebralBody> bodies;
  const SpinalCanal& canal;
  std::size_t own = 0;
  bool has_sacrum = false;  ///< the first of the bodies is the sacrum's

  const VertebralBody& body() const { return bodies[own]; }
  /// Whether it is a lumbar one for sure: one of the four above a sacrum.
  bool is_lumbar() const { return has_sacrum && own >= 1 && own <= 4; }
  /// Whether it is one of C3 to C7 for sure, by its size: its transverse processes stand beside the body, no ribs do.
  bool is_cervical() const;
};

/// What is known of each bone voxel before the walk, from anatomy:
/// wanted is the inside of the body; other are the insides of the other bodies, `ribs`, bone in the column of bodies
/// above and below, bone in front of the column, bone further up or down than processes reach, and bone on the CT's
/// border that is nearly so far. Outside (no bone) is what lies on an endplate and is not as dense as `dense_hu`, for
/// that is disc. All the rest is free. `depth_mm`: in the own body, `depth_in_others_mm`: in the nearest of the others.
struct MarkerInput {
  std::span<const std::uint8_t> bone, ribs;
  std::span<const float> depth_mm, depth_in_others_mm;
  const FloatGrid& hu;
  double dense_hu = 0.0;
  const GridGeometry& ct_geometry;
};
std::vector<WalkerVoxel> place_markers(const MarkerInput& input, const BodyInRow& row);

/// The voxels of the laminae: bone that rays from the canal backward meet first, at a height where it can only be this
/// vertebra's. Empty where there is none within 18 mm, as after a laminectomy.
std::vector<std::size_t> lamina_voxels(std::span<const std::uint8_t> bone, const GridGeometry& geometry,
                                       const VertebralBody& vertebra, const SpinalCanal& canal);

}  // namespace spinaltap
