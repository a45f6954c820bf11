#include "core/phantom/detail/level_anatomy.h"

#include <algorithm>
#include <cmath>

#include "core/base/lerp.h"
#include "core/phantom/detail/shapes.h"

namespace spinaltap {
namespace {

/// A value of the three shapes of arches.
double of_arch(const LevelMeasures& m, double thoracic, double lumbar, double cervical) {
  return lerp(lerp(thoracic, lumbar, m.lumbar_share), cervical, m.cervical_share);
}

/// Places that several parts share.
struct Plan {
  double lumbar;            ///< 0 thoracic ... 1 lumbar
  Vec3 isthmus_mm;          ///< of the left pedicle
  double arch_y_mm;         ///< where the pedicle ends and the arch begins
  double canal_back_mm;     ///< y of the canal's back corner
  Eigen::Vector2d side_mm;  ///< (x, y) of the lamina's outer end
  double ridge_y_mm;        ///< y of the lamina's middle plane in the midline
  double lamina_z_mm;       ///< of its centre

  explicit Plan(const LevelMeasures& m) : lumbar(m.lumbar_share) {
    const double half_depth = 0.5 * m.body_depth_mm;
    const double below_rim = of_arch(m, 0.5, 3.3, 1.0);
    isthmus_mm = Vec3(0.5 * (m.canal_width_mm + lerp(1.0, 0.6, m.cervical_share) * m.pedicle_width_mm),
                      half_depth + of_arch(m, 3.2, 4.0, 1.5),
                      0.5 * (m.body_height_mm - m.pedicle_height_mm) - below_rim + m.back_rise_mm);
    // The isthmus of a pedicle that converges reaches back on its inner side.
    const double turned = 0.5 * m.pedicle_width_mm * std::fabs(std::sin(m.pedicle_convergence_deg * kDegree));
    arch_y_mm = isthmus_mm.y() + of_arch(m, 7.5, 9.0, 2.5) + turned;
    canal_back_mm = half_depth - 1.3 + m.canal_depth_mm + 0.8;
    side_mm = Eigen::Vector2d(of_arch(m, 0.95, 0.8, 1.35) * isthmus_mm.x(), arch_y_mm - of_arch(m, 0.0, 0.5, -3.0));
    ridge_y_mm = canal_back_mm + of_arch(m, 3.0, 5.5, 2.2);
    const double top = isthmus_mm.z() + of_arch(m, 1.0, 1.5, 2.0);
    lamina_z_mm = top - 0.5 * m.lamina_height_mm;
  }

  /// y of the lamina's middle plane, at its centre's height.
  double lamina_y_mm(double x) const { return lerp(ridge_y_mm, side_mm.y(), x / side_mm.x()); }
};

VertebraAnatomy::Body make_body(const LevelMeasures& m) {
  VertebraAnatomy::Body body;
  body.width_mm = m.body_width_mm;
  body.depth_mm = m.body_depth_mm;
  body.height_mm = m.body_height_mm;
  body.waist_mm = 0.06 * m.body_depth_mm;
  body.kidney_mm = lerp(0.12, 0.07, m.cervical_share) * m.body_depth_mm;
  body.kidney_width_mm = 0.24 * m.body_depth_mm;
  body.superior_hollow_mm = lerp(0.075, 0.16, m.crushed) * m.body_height_mm;
  body.inferior_hollow_mm = 0.09 * m.body_height_mm;
  body.rim_mm = 0.075 * m.body_depth_mm;
  body.edge_mm = 0.09 * m.body_height_mm;
  body.wedge_deg = m.wedge_deg;
  return body;
}

VertebraAnatomy::Pedicle make_pedicle(const LevelMeasures& m, const Plan& plan) {
  VertebraAnatomy::Pedicle pedicle;
  pedicle.width_mm = m.pedicle_width_mm;
  pedicle.height_mm = m.pedicle_height_mm;
  pedicle.isthmus_mm = plan.isthmus_mm;
  pedicle.convergence_deg = m.pedicle_convergence_deg;
  pedicle.flare_mm = std::min(1.3, 0.15 * m.pedicle_width_mm);
  pedicle.flare_length_mm = 5.0;
  pedicle.anterior_length_mm = 0.33 * m.body_depth_mm + of_arch(m, 2.0, 2.0, 5.0);
  pedicle.posterior_length_mm = plan.arch_y_mm - plan.isthmus_mm.y() + 1.0;
  pedicle.blend_mm = lerp(1.8, 2.4, plan.lumbar);
  return pedicle;
}

VertebraAnatomy::Process make_transverse(const LevelMeasures& m, const Plan& plan) {
  const double root_mm = of_arch(m, 6.4, 5.4, 4.8), tip_mm = of_arch(m, 6.8, 4.0, 4.4);
  const double wide = of_arch(m, 1.25, 2.1, 1.25);
  const Vec3 root(plan.isthmus_mm.x() + of_arch(m, 2.0, 2.0, 6.5), plan.arch_y_mm - of_arch(m, 0.2, 0.2, 1.0),
                  plan.isthmus_mm.z() + m.transverse_rise_mm);
  // Its round end is as long as half its width.
  const double end_mm = 0.5 * wide * tip_mm * std::cos(m.transverse_back_deg * kDegree);
  const double tip_x = std::max(0.5 * m.transverse_span_mm - end_mm, root.x() + of_arch(m, 4.0, 4.0, 1.5));
  const double run = tip_x - root.x();
  // Cervical ones run forward, beside the foramen.
  const double back = std::max(run * std::tan(m.transverse_back_deg * kDegree), -7.0);
  const Vec3 tip(tip_x, root.y() + back, root.z() + lerp(0.06, 0.1, plan.lumbar) * run);
  return {root, tip, Vec3(-0.25, 1.0, 0.1), root_mm, tip_mm, wide, of_arch(m, 2.2, 3.2, 1.8)};
}

VertebraAnatomy::Process make_pars(const LevelMeasures& m, const Plan& plan) {
  if (m.cervical_share > 0.5) {  // the pillar between the facets
    const Vec3 root(m.facet_x_mm, plan.arch_y_mm + 2.2, plan.isthmus_mm.z() - 0.5);
    const Vec3 tip(m.facet_x_mm, plan.arch_y_mm + 5.0, plan.lamina_z_mm - 2.5);
    return {root, tip, Vec3(0.0, 1.0, 0.5), 8.0, 7.5, 1.3, 2.2};
  }
  const double thick_mm = lerp(5.5, 8.0, plan.lumbar);
  const double x = 0.7 * plan.isthmus_mm.x();
  const Vec3 root(plan.isthmus_mm.x() + 0.6, plan.arch_y_mm + 0.8, plan.isthmus_mm.z() - 2.0);
  const Vec3 tip(x, plan.lamina_y_mm(x) + 0.5, plan.lamina_z_mm - 0.1 * m.lamina_height_mm);
  return {root, tip, Vec3(0.55, -0.83, 0.0), thick_mm, thick_mm, 1.4, 2.2};
}

VertebraAnatomy::Spinous make_spinous(const LevelMeasures& m, const Plan& plan) {
  VertebraAnatomy::Spinous spinous;
  const double upper_z = plan.lamina_z_mm + 0.30 * m.lamina_height_mm;
  const double lower_z = plan.lamina_z_mm - 0.36 * m.lamina_height_mm;
  const double root_y = plan.canal_back_mm - 0.5;
  const double drop = m.spinous_drop_deg * kDegree;
  const Eigen::Vector2d along(std::cos(drop), -std::sin(drop)), across(std::sin(drop), std::cos(drop));
  const Eigen::Vector2d start(plan.canal_back_mm, lerp(upper_z, lower_z, lerp(0.42, 0.5, plan.lumbar)));
  const Eigen::Vector2d end = start + m.spinous_length_mm * along;
  const double half = 0.5 * m.spinous_tip_height_mm;
  spinous.outline_mm = {Eigen::Vector2d(root_y, upper_z), end + half * across, end + std::min(0.6 * half, 3.0) * along,
                        end - half * across, Eigen::Vector2d(root_y, lower_z)};
  spinous.rounding_mm = of_arch(m, 3.0, 4.0, 2.5);
  spinous.root_thickness_mm = of_arch(m, 5.0, 6.0, 4.2);
  spinous.tip_thickness_mm = of_arch(m, 5.5, 9.0, 6.5);
  spinous.blend_mm = of_arch(m, 3.5, 5.0, 3.0);
  return spinous;
}

/// From the pedicle's root up to the facet, thin across it.
void make_superior(VertebraAnatomy& anatomy, const LevelMeasures& m, const Plan& plan) {
  const FacetPlace facet = superior_facet(m);
  if (m.cervical_share > 0.5) {  // the pillar's upper end: a plate under the facet
    constexpr double kPlateMm = 5.5;
    const Vec3 slope = Vec3::UnitX().cross(facet.normal);  // forward and up
    const Vec3 middle = facet.centre_mm - 0.5 * kPlateMm * facet.normal;
    anatomy.facet = {300.0, 0.3};
    anatomy.superior_articular = {
        middle - 3.0 * slope, middle + 1.5 * slope, facet.normal, kPlateMm, kPlateMm, 1.9, 1.5};
    anatomy.mammillary = {middle, 2.5, 1.0};  // inside
    return;
  }
  const double inward = std::clamp(m.facet_inward_deg / 45.0, 0.0, 1.0);  // 1 where the facet is hollow
  anatomy.facet = {lerp(300.0, 15.0, inward), lerp(0.3, 1.6, inward)};
  const double root_mm = lerp(4.8, 8.4, inward), tip_mm = lerp(4.4, 7.4, inward);
  const Vec3 tip = facet.centre_mm - (0.5 * tip_mm - anatomy.facet.hollow_mm) * facet.normal +
                   lerp(1.5, 0.5, inward) * Vec3::UnitZ();
  const Vec3 root(lerp(facet.centre_mm.x(), plan.isthmus_mm.x() + 1.8, inward),
                  plan.arch_y_mm + lerp(-0.6, 1.2, inward), plan.isthmus_mm.z() + 0.5);
  anatomy.superior_articular = {root, tip, facet.normal, root_mm, tip_mm, lerp(2.2, 1.5, inward), 2.2};
  anatomy.mammillary = {
      facet.centre_mm + lerp(0.0, 1.0, inward) * Vec3(4.0, 0.4, -3.3) + lerp(1.0, 0.0, inward) * Vec3(2.0, -2.5, -6.0),
      lerp(1.5, 3.0, inward), 2.5};
}

}  // namespace

FacetPlace superior_facet(const LevelMeasures& m) {
  const Plan plan(m);
  const double inward = m.facet_inward_deg * kDegree, upward = m.facet_upward_deg * kDegree;
  const Vec3 normal(-std::sin(inward) * std::cos(upward), std::cos(inward) * std::cos(upward), std::sin(upward));
  const double share = std::clamp(m.facet_inward_deg / 45.0, 0.0, 1.0);
  const double behind = lerp(lerp(1.2, 3.6, share), 2.0, m.cervical_share);
  const double above = lerp(lerp(3.6, 2.5, share), 0.5, m.cervical_share);
  return {Vec3(m.facet_x_mm, plan.arch_y_mm + behind, 0.5 * m.body_height_mm + above + m.back_rise_mm),
          normal.normalized()};
}

VertebraAnatomy level_anatomy(const LevelMeasures& m) {
  const Plan plan(m);
  VertebraAnatomy anatomy;
  anatomy.body = make_body(m);
  anatomy.pedicle = make_pedicle(m, plan);
  anatomy.canal = {m.canal_width_mm - 3.8,       0.5 * m.body_depth_mm - 1.3, plan.canal_back_mm,
                   of_arch(m, 40.0, 47.0, 36.0), lerp(5.0, 6.0, plan.lumbar), lerp(1.3, 1.7, plan.lumbar)};
  anatomy.transverse = make_transverse(m, plan);
  anatomy.pars = make_pars(m, plan);
  VertebraAnatomy::Lamina& lamina = anatomy.lamina;
  lamina.thickness_mm = of_arch(m, 5.4, 6.5, 4.2);
  const double rise = plan.ridge_y_mm - plan.side_mm.y();
  lamina.slope_deg = std::atan2(rise, plan.side_mm.x()) / kDegree;
  lamina.length_mm = std::hypot(rise, plan.side_mm.x()) + 2.0;
  lamina.centre_mm = Vec3(0.5 * plan.side_mm.x(), plan.lamina_y_mm(0.5 * plan.side_mm.x()), plan.lamina_z_mm);
  lamina.height_mm = m.lamina_height_mm;
  lamina.lean_deg = of_arch(m, 17.0, 14.0, 20.0);
  lamina.blend_mm = of_arch(m, 2.6, 3.3, 2.2);
  anatomy.spinous = make_spinous(m, plan);
  make_superior(anatomy, m, plan);
  FacetPlace below = superior_facet(m);
  below.centre_mm.z() -= m.body_height_mm + m.disc_below_mm;
  aim_inferior_processes(anatomy, below, 0.0, m.cervical_share);
  return anatomy;
}

void aim_inferior_processes(VertebraAnatomy& anatomy, const FacetPlace& facet, double overlap_mm,
                            double cervical_share) {
  const double inward = std::clamp(-facet.normal.x() / std::sin(45.0 * kDegree), 0.0, 1.0);
  const double root_mm = lerp(5.2, 8.0, inward), tip_mm = lerp(5.0, 7.4, inward);
  const VertebraAnatomy::Lamina& lamina = anatomy.lamina;
  const double x = 0.7 * anatomy.pedicle.isthmus_mm.x();
  const double slope = std::tan(lamina.slope_deg * kDegree), lean = std::tan(lamina.lean_deg * kDegree);
  const double z = lamina.centre_mm.z() - 0.12 * lamina.height_mm;
  Vec3 root(x, lamina.centre_mm.y() - (x - lamina.centre_mm.x()) * slope + (lamina.centre_mm.z() - z) * lean, z);
  if (cervical_share > 0.5) root = anatomy.pars.tip_mm + Vec3(0.0, 0.5, 1.0);
  const Vec3 behind = (0.5 * tip_mm - overlap_mm) * facet.normal;
  Vec3 tip = facet.centre_mm + behind - lerp(1.0, 0.5, inward) * Vec3::UnitZ();
  tip.z() = std::min(tip.z(), root.z() - 2.0);
  anatomy.inferior_articular = {
      root, tip, -facet.normal, root_mm, tip_mm, lerp(2.0, 1.6, inward), lerp(3.0, 4.5, inward)};
}

LevelMeasures scaled(const LevelMeasures& measures, double by) {
  LevelMeasures m = measures;
  for (double* length :
       {&m.body_width_mm, &m.body_depth_mm, &m.body_height_mm, &m.pedicle_width_mm, &m.pedicle_height_mm,
        &m.canal_width_mm, &m.canal_depth_mm, &m.transverse_span_mm, &m.transverse_rise_mm, &m.spinous_length_mm,
        &m.spinous_tip_height_mm, &m.lamina_height_mm, &m.facet_x_mm, &m.disc_below_mm, &m.back_rise_mm}) {
    *length *= by;
  }
  return m;
}

}  // namespace spinaltap
