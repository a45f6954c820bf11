#pragma once

#include "core/segment/body_chain.h"
#include "core/segment/star_surface.h"

namespace spinaltap {

/// A vertebral body: the cylinder that lies nearest, and its true surface.
struct VertebralBody {
  BodyCylinder cylinder;
  StarSurface surface;
};

/// The body of a span of the column, in a CT that was smoothed. First the cylinder near it with the most wall; then,
/// along each of many rays from its middle, the outer edge of the wall near it. Neighbouring rays pull each other along
/// (see choose_steps()), so that the wall is found where it is as thin as the noise, and marrow may be as dark as the
/// discs.
VertebralBody find_vertebral_body(const FloatGrid& smooth, const BodySpan& span, const WallLevels& levels);

}  // namespace spinaltap
