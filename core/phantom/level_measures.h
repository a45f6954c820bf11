#pragma once

#include "core/ct/level.h"

namespace spinaltap {

/// What sets one level of the spine apart from the others. Lengths in mm, angles in degrees; the vertebra's own frame
/// is that of VertebraAnatomy.
struct LevelMeasures {
  double body_width_mm;   ///< mean of both endplates
  double body_depth_mm;   ///< mean of both endplates
  double body_height_mm;  ///< in the middle, rim to rim
  double wedge_deg;       ///< above 0: lower in front
  double pedicle_width_mm;
  double pedicle_height_mm;
  double pedicle_convergence_deg;
  double canal_width_mm;  ///< between the pedicles
  double canal_depth_mm;
  double transverse_span_mm;     ///< from tip to tip
  double transverse_back_deg;    ///< of the transverse processes behind the coronal plane
  double transverse_rise_mm;     ///< of their roots above the pedicles' isthmus
  double spinous_length_mm;      ///< from behind the canal to the tip
  double spinous_drop_deg;       ///< of the spinous process below the horizontal
  double spinous_tip_height_mm;  ///< of its end
  double lamina_height_mm;
  double facet_x_mm;            ///< of the middle of the superior facet
  double facet_inward_deg;      ///< how far it looks inward from backward; below 0: outward
  double facet_upward_deg;      ///< how far it looks upward
  double disc_below_mm;         ///< height of the disc below, in its middle
  double flexion_deg;           ///< of the vertebra in the natural curve: how far its top leans forward
  double lumbar_share;          ///< of the shape of its arch: 0 thoracic, 1 lumbar
  double cervical_share = 0.0;  ///< of the shape of its arch: 1 cervical
  double back_rise_mm = 0.0;    ///< of a crushed body's back rim above half of its height: where its arch hangs
  double crushed = 0.0;         ///< share of the height that the body's front has lost
};

/// First and last level with measures. C1, C2 and the sacrum are simple solids of their own.
inline constexpr Level kFirstMeasured = Level{3}, kLastMeasured = Level::kL5;

/// `a` where `share` is 0, `b` where it is 1.
LevelMeasures mixed(const LevelMeasures& a, const LevelMeasures& b, double share);

/// Measures of an adult's level. Throws Error when the level has none.
const LevelMeasures& level_measures(Level level);

}  // namespace spinaltap
