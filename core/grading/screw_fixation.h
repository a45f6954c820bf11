#pragma once

#include <vector>

#include "core/ct/hu_to_density.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// A property that goes with a power of the density: `at_reference_mpa` where it is `reference_g_cm3`.
struct DensityPowerLaw {
  double at_reference_mpa = 1.0;
  double reference_g_cm3 = 1.0;
  double exponent = 1.0;

  /// MPa; 0 of no density and less.
  double mpa(double density_g_cm3) const;
};

/// What holds a screw, and how well that is known. docs/screws.md has the sources and what was weighed.
struct FixationModel {
  /// Shear strength. Human cortical bone along its axis, pure shear: 51.6 MPa (Turner, Wang & Burr 2001), at 1.9
  /// g/cm³; exponent of human trabecular bone of four sites (Sanyal et al. 2012).
  DensityPowerLaw shear{51.6, 1.9, 1.7};
  /// Pressure under which it is crushed: shear strength over 0.44, their ratio at any density (Sanyal et al. 2012).
  DensityPowerLaw crushing{117.3, 1.9, 1.7};
  /// Young's modulus of vertebral trabecular bone, 4,730 MPa at 1 g/cm³ (Morgan, Bayraktar & Keaveny 2003).
  DensityPowerLaw modulus{4730.0, 1.0, 1.56};
  double poisson = 0.3;
  /// Of metal on bone: rough printed titanium has 0.37 and more (Abedi et al. 2025), a turned thread less.
  double friction = 0.3;
  double cortical_g_cm3 = 0.7;  ///< from which on bone counts as cortex; a convention

  // Standard deviations of natural logarithms.
  double density_spread = 0.10;   ///< of densities from CT numbers without a phantom in the scan
  double strength_spread = 0.35;  ///< of strength at a density: 0.16 of 0.44 (Sanyal et al. 2012)
  double modulus_spread = 0.30;   ///< of the modulus at a density
  double friction_spread = 0.20;  ///< of the friction
  double model_spread = 0.10;     ///< of Chapman's formula itself: R² 0.947 over twelve screws (Chapman et al. 1996)
};

/// Rejects values that are not finite or make no sense.
void check_fixation_model(const FixationModel& model);

/// A figure with the bounds that it keeps to in 90 of 100 cases.
struct FixationFigure {
  double median = 0.0;
  double p05 = 0.0;
  double p95 = 0.0;
};

/// A screw on its way in, with its tip at a depth.
struct FixationRow {
  double depth_mm = 0.0;     ///< from the entry
  double torque_n_mm = 0.0;  ///< that drives it on
  double shear_mpa = 0.0;    ///< mean shear strength of the bone around the thread's outer diameter here
};

/// How well a screw holds: screw_fixation().
struct ScrewFixation {
  FixationFigure pullout_n;        ///< axial force that shears the bone off the thread
  FixationFigure stiffness_n_mm;   ///< axial, of the elastic bone around a rigid screw that grips all over: never more
  FixationFigure max_torque_n_mm;  ///< the largest insertion torque on the way
  double cortical_share = 0.0;     ///< of the pull-out strength, by bone of FixationModel::cortical_g_cm3 and more
  double engaged_mm = 0.0;         ///< length of thread with bone on one side of it or more
  std::vector<FixationRow> rows;   ///< from the entry to the target, half a millimetre apart or a little less
};

/// How well a path's screw holds once its tip is at the target, in the hole that the path's bit drilled, and what
/// drives it there.
///
/// Pull-out: Chapman et al. 1996, F = S L pi D TSF with TSF = 0.5 + 0.57735 d / p, summed along the thread: S is the
/// mean shear strength of the bone around the thread's outer diameter D there, d the thread's depth in bone, from the
/// core or from the hole's wall where that is wider. Torque: friction of core and flanks, pressed by the strength of
/// the crushed bone, along all thread in the hole (as Seneviratne et al. 2001 sum it for self-tapping screws), and the
/// work of crushing what the next turn displaces. Stiffness: Randolph & Wroth 1978, of a pile in shear. The cone at the
/// tip counts for nothing.
///
/// Throws Error on a path without a screw, a curved one, a bad path or model, and without a sampler.
ScrewFixation screw_fixation(const DrillPath& path, const DensitySampler& density, const FixationModel& model = {});

}  // namespace spinaltap
