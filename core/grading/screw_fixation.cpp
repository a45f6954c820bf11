#include "core/grading/screw_fixation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <numbers>

#include "core/base/check_range.h"
#include "core/base/error.h"
#include "core/base/text_fields.h"

namespace spinaltap {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSliceMm = 0.5;
constexpr int kPlaces = 24;  // around the thread

/// The thread of a screw in its hole. `back_mm`: behind the tip.
class SeatedThread {
 public:
  SeatedThread(const PedicleScrew& screw, double hole_mm)
      : thread_(screw.thread_or_usual()),
        radius_mm_(screw.radius_mm()),
        hole_radius_mm_(0.5 * hole_mm),
        tip_mm_(screw.tip_length_mm),
        shaft_mm_(screw.length_mm - screw.tip_length_mm) {}

  double tip_mm() const { return tip_mm_; }
  double radius_mm() const { return radius_mm_; }

  double core_radius_mm(double back_mm) const {
    const double root_mm = 0.5 * thread_.core_diameter_mm;
    if (!(thread_.tip_core_diameter_mm > 0.0) || !(shaft_mm_ > 0.0)) return root_mm;
    const double share = std::clamp((back_mm - tip_mm_) / shaft_mm_, 0.0, 1.0);
    return 0.5 * thread_.tip_core_diameter_mm + share * (root_mm - 0.5 * thread_.tip_core_diameter_mm);
  }
  /// Where bone begins: at the core, or at the wall of a wider hole.
  double wall_radius_mm(double back_mm) const { return std::max(core_radius_mm(back_mm), hole_radius_mm_); }
  double mid_radius_mm() const {
    return 0.5 * (radius_mm_ + std::min(radius_mm_, wall_radius_mm(tip_mm_ + shaft_mm_)));
  }

  /// Area on which bone shears, of a millimetre of thread, mm (Chapman et al. 1996).
  double shear_mm(double back_mm) const {
    const double depth_mm = radius_mm_ - wall_radius_mm(back_mm);
    if (!(depth_mm > 0.0)) return 0.0;
    const double shape_factor = 0.5 + 0.57735 * depth_mm / thread_.pitch_mm;
    return 2.0 * kPi * radius_mm_ * shape_factor;
  }

  /// Torque of a pressure of 1 MPa without friction's coefficient, of a millimetre of thread, mm²: integral of the
  /// radius over both flanks and, where the core is wider than the hole, over the core between the threads.
  double friction_mm2(double back_mm) const {
    const double core_mm = core_radius_mm(back_mm), wall_mm = wall_radius_mm(back_mm);
    if (!(radius_mm_ > wall_mm)) return 0.0;
    const double flank = thread_.flank_deg * kDegree;
    const double flanks_mm2 = 2.0 * (2.0 * kPi / 3.0) * (std::pow(radius_mm_, 3) - std::pow(wall_mm, 3)) /
                              (thread_.pitch_mm * std::cos(flank));
    if (!(core_mm > hole_radius_mm_)) return flanks_mm2;
    const double root_mm = thread_.crest_mm + 2.0 * (radius_mm_ - core_mm) * std::tan(flank);
    return flanks_mm2 + 2.0 * kPi * core_mm * core_mm * std::max(0.0, 1.0 - root_mm / thread_.pitch_mm);
  }

  /// Torque that crushes what a turn displaces, under 1 MPa, mm³: its volume over 2 pi.
  double forming_mm3() const {
    const double core_mm = core_radius_mm(tip_mm_), wall_mm = wall_radius_mm(tip_mm_);
    if (!(radius_mm_ > wall_mm)) return 0.0;
    const double depth_mm = radius_mm_ - wall_mm;
    const double section_mm2 = depth_mm * (thread_.crest_mm + depth_mm * std::tan(thread_.flank_deg * kDegree));
    const double thread_mm2 = section_mm2 * kPi * (radius_mm_ + wall_mm) / thread_.pitch_mm;
    const double core_mm2 = kPi * std::max(0.0, core_mm * core_mm - hole_radius_mm_ * hole_radius_mm_);
    return (thread_mm2 + core_mm2) * thread_.lead_mm() / (2.0 * kPi);
  }

 private:
  ScrewThread thread_;
  double radius_mm_, hole_radius_mm_, tip_mm_, shaft_mm_;
};

/// Means of the bone around a path, of each of its slices.
struct BoneAround {
  double slice_mm = 0.0;
  std::vector<double> shear_mpa, cortical_mpa;  ///< at the outer diameter; of cortex alone, over all places
  std::vector<double> modulus_mpa;              ///< likewise
  std::vector<double> crushing_mpa;             ///< in the middle of the thread
  std::vector<std::uint8_t> has_bone;
};

BoneAround bone_around(const DrillPath& path, const SeatedThread& thread, const DensitySampler& density,
                       const FixationModel& model) {
  const double length_mm = path.length_mm();
  const auto slices = static_cast<std::size_t>(std::ceil(length_mm / kSliceMm));
  BoneAround bone;
  bone.slice_mm = length_mm / static_cast<double>(slices);
  const Vec3 axis = path.direction(), u = any_perpendicular(axis), v = axis.cross(u);
  std::vector<Vec3> places_mm;
  places_mm.reserve(slices * 2 * kPlaces);
  for (std::size_t slice = 0; slice < slices; ++slice) {
    const Vec3 centre_mm = path.entry_mm + (static_cast<double>(slice) + 0.5) * bone.slice_mm * axis;
    for (const double radius_mm : {thread.radius_mm(), thread.mid_radius_mm()}) {
      for (int n = 0; n < kPlaces; ++n) {
        const double angle = 2.0 * kPi * n / kPlaces;
        places_mm.push_back(centre_mm + radius_mm * (std::cos(angle) * u + std::sin(angle) * v));
      }
    }
  }
  std::vector<double> found_g_cm3(places_mm.size(), 0.0);
  density(places_mm, found_g_cm3);
  std::size_t next = 0;
  for (std::size_t slice = 0; slice < slices; ++slice) {
    double shear_mpa = 0.0, cortical_mpa = 0.0, modulus_mpa = 0.0, crushing_mpa = 0.0;
    bool has_bone = false;
    for (int n = 0; n < kPlaces; ++n) {
      const double g_cm3 = found_g_cm3[next++];
      const double here_mpa = model.shear.mpa(g_cm3);
      shear_mpa += here_mpa;
      if (g_cm3 >= model.cortical_g_cm3) cortical_mpa += here_mpa;
      modulus_mpa += model.modulus.mpa(g_cm3);
      has_bone = has_bone || g_cm3 > 0.0;
    }
    for (int n = 0; n < kPlaces; ++n) crushing_mpa += model.crushing.mpa(found_g_cm3[next++]);
    bone.shear_mpa.push_back(shear_mpa / kPlaces);
    bone.cortical_mpa.push_back(cortical_mpa / kPlaces);
    bone.modulus_mpa.push_back(modulus_mpa / kPlaces);
    bone.crushing_mpa.push_back(crushing_mpa / kPlaces);
    bone.has_bone.push_back(has_bone ? 1 : 0);
  }
  return bone;
}

/// Of a slice, the part that thread fills with the tip at a depth; `back_mm`: how far behind the tip its middle is.
struct Filled {
  double length_mm = 0.0;
  double back_mm = 0.0;
};

Filled filled(std::size_t slice, double slice_mm, double tip_depth_mm, double cone_mm) {
  const double begin_mm = static_cast<double>(slice) * slice_mm;
  const double end_mm = std::min(begin_mm + slice_mm, tip_depth_mm - cone_mm);
  return {std::max(0.0, end_mm - begin_mm), tip_depth_mm - 0.5 * (begin_mm + end_mm)};
}

double torque_n_mm(const SeatedThread& thread, const BoneAround& bone, double tip_depth_mm, double friction) {
  double rubbing_n_mm = 0.0;
  double met_mpa_mm = 0.0;
  for (std::size_t slice = 0; slice < bone.crushing_mpa.size(); ++slice) {
    const double begin_mm = static_cast<double>(slice) * bone.slice_mm;
    if (begin_mm >= tip_depth_mm) break;
    const Filled part = filled(slice, bone.slice_mm, tip_depth_mm, thread.tip_mm());
    if (part.length_mm > 0.0) {
      rubbing_n_mm += bone.crushing_mpa[slice] * part.length_mm * thread.friction_mm2(part.back_mm);
    }
    // The cone at the tip opens the way.
    const double from_mm = std::max(begin_mm, tip_depth_mm - thread.tip_mm());
    const double to_mm = std::min(begin_mm + bone.slice_mm, tip_depth_mm);
    met_mpa_mm += bone.crushing_mpa[slice] * std::max(0.0, to_mm - from_mm);
  }
  return friction * rubbing_n_mm + thread.forming_mm3() * met_mpa_mm / thread.tip_mm();
}

FixationFigure figure_of(double median, std::initializer_list<double> spreads) {
  constexpr double kOneSided95 = 1.6448536269514722;
  double variance = 0.0;
  for (const double spread : spreads) variance += spread * spread;
  const double factor = std::exp(kOneSided95 * std::sqrt(variance));
  return {median, median / factor, median * factor};
}

}  // namespace

double DensityPowerLaw::mpa(double density_g_cm3) const {
  return density_g_cm3 > 0.0 ? at_reference_mpa * std::pow(density_g_cm3 / reference_g_cm3, exponent) : 0.0;
}

void check_fixation_model(const FixationModel& model) {
  const auto within = [](double value, double lowest, double highest, const char* what) {
    check_range(value, lowest, highest, "screw's fixation", what);
  };
  for (const DensityPowerLaw& law : {model.shear, model.crushing, model.modulus}) {
    within(law.at_reference_mpa, 1e-6, 1e6, "a strength or modulus (MPa)");
    within(law.reference_g_cm3, 0.01, 10.0, "a density (g/cm³)");
    within(law.exponent, 0.0, 5.0, "an exponent of the density");
  }
  within(model.poisson, 0.0, 0.49, "a Poisson's ratio");
  within(model.friction, 0.0, 2.0, "a coefficient of friction");
  within(model.cortical_g_cm3, 0.0, 10.0, "a cortex's density (g/cm³)");
  for (const double spread :
       {model.density_spread, model.strength_spread, model.modulus_spread, model.friction_spread, model.model_spread}) {
    within(spread, 0.0, 3.0, "a spread");
  }
}

ScrewFixation screw_fixation(const DrillPath& path, const DensitySampler& density, const FixationModel& model) {
  check_path(path);
  check_fixation_model(model);
  if (!path.screw) fail("path ", in_quotes(path.name), ": expected a screw, whose hold is asked for, found none");
  if (!density) fail("screw's fixation: expected a sampler of densities");
  const SeatedThread thread(*path.screw, path.bit.diameter_mm);
  const BoneAround bone = bone_around(path, thread, density, model);
  const double length_mm = path.length_mm();

  ScrewFixation fixation;
  double pullout_n = 0.0, cortical_n = 0.0, shear_modulus_n = 0.0;
  for (std::size_t slice = 0; slice < bone.shear_mpa.size(); ++slice) {
    const Filled part = filled(slice, bone.slice_mm, length_mm, thread.tip_mm());
    const double area_mm2 = part.length_mm * thread.shear_mm(part.back_mm);
    pullout_n += area_mm2 * bone.shear_mpa[slice];
    cortical_n += area_mm2 * bone.cortical_mpa[slice];
    if (!(area_mm2 > 0.0) || bone.has_bone[slice] == 0) continue;
    fixation.engaged_mm += part.length_mm;
    shear_modulus_n += part.length_mm * bone.modulus_mpa[slice] / (2.0 * (1.0 + model.poisson));
  }
  fixation.pullout_n =
      figure_of(pullout_n, {model.density_spread * model.shear.exponent, model.strength_spread, model.model_spread});
  fixation.cortical_share = pullout_n > 0.0 ? cortical_n / pullout_n : 0.0;

  // Beyond this radius the bone stands still; a short screw is not thinner than its surroundings.
  const double still_mm = std::max(2.5 * fixation.engaged_mm * (1.0 - model.poisson), 2.0 * thread.radius_mm());
  fixation.stiffness_n_mm = figure_of(2.0 * kPi * shear_modulus_n / std::log(still_mm / thread.radius_mm()),
                                      {model.density_spread * model.modulus.exponent, model.modulus_spread});

  double max_n_mm = 0.0;
  for (std::size_t n = 0; n <= bone.shear_mpa.size(); ++n) {
    const std::size_t slice = std::min(n, bone.shear_mpa.size() - 1);
    FixationRow row{static_cast<double>(n) * bone.slice_mm, 0.0, bone.shear_mpa[slice]};
    row.torque_n_mm = torque_n_mm(thread, bone, row.depth_mm, model.friction);
    max_n_mm = std::max(max_n_mm, row.torque_n_mm);
    fixation.rows.push_back(row);
  }
  fixation.max_torque_n_mm = figure_of(max_n_mm, {model.density_spread * model.crushing.exponent, model.strength_spread,
                                                  model.friction_spread, model.model_spread});
  return fixation;
}

}  // namespace spinaltap
