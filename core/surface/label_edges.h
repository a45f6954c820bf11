#pragma once

#include "core/base/progress.h"
#include "core/ct/ct_volume.h"

namespace spinaltap {

/// How the edge of a mask lies on the edges of bone that its CT shows.
struct LabelEdges {
  std::size_t places = 0;  ///< of the mask's edge that were looked at; 0: too few to say anything
  /// Share of them with an edge of bone within 1 mm, once the mask was put back by the two figures below.
  double on_edge = 0.0;
  Vec3 moved_mm = Vec3::Zero();  ///< how far the mask lies from its bone, patient LPS
  double grown_mm = 0.0;         ///< how far its edge lies outside the bone's; below 0: inside
  /// The same share for the mask turned round about its own middle, put back likewise: left to right, front to back,
  /// top to bottom.
  Vec3 on_edge_mirrored = Vec3::Zero();
};

/// Looks along the normals of the mask's own smoothed surface, 5 mm to either side, for the place where the CT number
/// falls most, and fits to all of them one shift and one growth by robust least squares, so that a mask that is a voxel
/// too large or too small all around is not taken for one that was moved. Where few places agree, shifts of up to 16 mm
/// are tried first. Source: iterative closest points along normals (Chen & Medioni 1992), with the growth as a fourth
/// number. The same mask gives the same figures at any number of threads. Throws Error on an empty mask.
LabelEdges find_label_edges(const CtVolume& ct, const BoneMask& mask, const Progress& progress = {});

}  // namespace spinaltap
