#pragma once

#include "core/segment/body_chain.h"
#include "core/segment/star_surface.h"

namespace spinaltap {

/// A vertebral body: the cylinder that lies nearest, and its true surface.
struct VertebralBody {
  BodyCylinder cylinder;
  StarSurface surface;
  bool is_cut = false;  ///< by the CT's border: one end is a guess
};

/// The cylinders of all bodies of a chain: of each, the one near its span with the most wall. Where a rib's head or a
/// spur leads one astray, the size and the place that its neighbour has are tried too, from the best body up and down.
std::vector<BodyCylinder> find_body_cylinders(const WallProbe& probe, const std::vector<BodySpan>& chain);

/// A body's true surface: along each of many rays from the middle of the cylinder that lies nearest, the outer edge of
/// the wall near it. Neighbouring rays pull each other along (see choose_steps()), so that the wall is found where it
/// is as thin as the noise, and cancellous bone may be as dark as the discs.
VertebralBody find_vertebral_body(const WallProbe& probe, const BodyCylinder& cylinder);

}  // namespace spinaltap
