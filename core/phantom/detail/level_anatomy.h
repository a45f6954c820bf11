#pragma once

#include "core/phantom/level_measures.h"
#include "core/phantom/vertebra_anatomy.h"

namespace spinaltap {

/// The middle of an articular facet's surface, on the left, in its vertebra's own frame.
struct FacetPlace {
  Vec3 centre_mm;
  Vec3 normal;  ///< unit, from the superior facet to the inferior one above it
};

/// A whole vertebra by a level's measures, unplaced. The parts that no measure gives are drawn in proportion. The
/// inferior articular processes end at the facets of a level alike below; aim_inferior_processes() sends them
/// elsewhere.
VertebraAnatomy level_anatomy(const LevelMeasures& measures);

/// Where level_anatomy() has the superior facet.
FacetPlace superior_facet(const LevelMeasures& measures);

/// Lets the inferior articular processes end behind a facet of the level below, given in this vertebra's frame, with
/// their front `overlap_mm` in front of its surface: what Spine cuts away to leave an even gap. Those of a cervical
/// level start from its pillars, others from the lamina.
void aim_inferior_processes(VertebraAnatomy& anatomy, const FacetPlace& facet_below, double overlap_mm,
                            double cervical_share);

/// Measures `by` times as large in all directions.
LevelMeasures scaled(const LevelMeasures& measures, double by);

}  // namespace spinaltap
