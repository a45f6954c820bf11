#include "core/phantom/vertebra_anatomy.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/error.h"
#include "core/phantom/detail/check_within.h"
#include "core/phantom/detail/vertebra_parts.h"

namespace spinaltap {
namespace {

void in_range(const char* name, double value, double low, double high) {
  check_within("anatomy", name, value, low, high);
}

void position(const std::string& name, const Vec3& p, double limit = 200.0) {
  const char* axes[] = {".x", ".y", ".z"};
  for (int axis = 0; axis < 3; ++axis) in_range((name + axes[axis]).c_str(), p[axis], -limit, limit);
}

void check_process(const std::string& name, const VertebraAnatomy::Process& process) {
  position(name + ".root_mm", process.root_mm);
  position(name + ".tip_mm", process.tip_mm);
  position(name + ".thin_direction", process.thin_direction);
  in_range((name + ".root_thickness_mm").c_str(), process.root_thickness_mm, 1.0, 30.0);
  in_range((name + ".tip_thickness_mm").c_str(), process.tip_thickness_mm, 1.0, 30.0);
  in_range((name + ".width_over_thickness").c_str(), process.width_over_thickness, 1.0, 5.0);
  in_range((name + ".blend_mm").c_str(), process.blend_mm, 0.1, 15.0);
  const Vec3 along = process.tip_mm - process.root_mm;
  if (!(along.norm() >= 1.0)) fail("anatomy: ", name, ": root_mm and tip_mm must lie at least 1 mm apart");
  if (!(along.cross(process.thin_direction).norm() > 0.1 * along.norm() * process.thin_direction.norm())) {
    fail("anatomy: ", name, ".thin_direction must not be zero or along the process");
  }
}

void check_pedicle(const std::string& name, const VertebraAnatomy::Pedicle& pedicle) {
  const auto check = [&](const char* key, double value, double low, double high) {
    in_range((name + "." + key).c_str(), value, low, high);
  };
  check("width_mm", pedicle.width_mm, 2.0, 30.0);
  check("height_mm", pedicle.height_mm, pedicle.width_mm, 40.0);
  position(name + ".isthmus_mm", pedicle.isthmus_mm);
  check("isthmus_mm.x", pedicle.isthmus_mm.x(), pedicle.width_mm, 60.0);
  check("convergence_deg", pedicle.convergence_deg, -30.0, 45.0);
  check("tilt_deg", pedicle.tilt_deg, -30.0, 30.0);
  check("flare_mm", pedicle.flare_mm, 0.0, 15.0);
  check("flare_length_mm", pedicle.flare_length_mm, 1.0, 50.0);
  check("anterior_length_mm", pedicle.anterior_length_mm, 4.0, 40.0);
  check("posterior_length_mm", pedicle.posterior_length_mm, 4.0, 40.0);
  check("blend_mm", pedicle.blend_mm, 0.1, 15.0);
}

void check_spinous(const VertebraAnatomy::Spinous& spinous) {
  const std::size_t corners = spinous.outline_mm.size();
  for (std::size_t n = 0; n < corners; ++n) {
    const Eigen::Vector2d& a = spinous.outline_mm[n];
    position("spinous.outline_mm", Vec3(a.x(), a.y(), 0.0));
    const Eigen::Vector2d first = spinous.outline_mm[(n + 1) % corners] - a;
    const Eigen::Vector2d second = spinous.outline_mm[(n + 2) % corners] - spinous.outline_mm[(n + 1) % corners];
    if (!(first.x() * second.y() - first.y() * second.x() < -0.01)) {
      fail("anatomy: spinous.outline_mm must be convex and run clockwise, but turns the other way after corner ", n);
    }
  }
  in_range("spinous.rounding_mm", spinous.rounding_mm, 0.1, 15.0);
  in_range("spinous.root_thickness_mm", spinous.root_thickness_mm, 1.0, 30.0);
  in_range("spinous.tip_thickness_mm", spinous.tip_thickness_mm, 1.0, 30.0);
  in_range("spinous.blend_mm", spinous.blend_mm, 0.1, 15.0);
}

void check_bone(const VertebraAnatomy::Cortex& cortex, const VertebraAnatomy::Cancellous& bone) {
  in_range("cortex.hu", cortex.hu, -1000.0, 3000.0);
  in_range("cortex.body_wall_mm", cortex.body_wall_mm, 0.0, 10.0);
  in_range("cortex.endplate_mm", cortex.endplate_mm, 0.0, 10.0);
  in_range("cortex.pedicle_mm", cortex.pedicle_mm, 0.0, 10.0);
  in_range("cortex.posterior_mm", cortex.posterior_mm, 0.0, 10.0);
  in_range("cancellous.body_hu", bone.body_hu, -1000.0, 3000.0);
  in_range("cancellous.pedicle_hu", bone.pedicle_hu, -1000.0, 3000.0);
  in_range("cancellous.posterior_hu", bone.posterior_hu, -1000.0, 3000.0);
  in_range("cancellous.texture_hu", bone.texture_hu, 0.0, 1000.0);
  in_range("cancellous.texture_scale_mm", bone.texture_scale_mm, 0.05, 50.0);
  in_range("cancellous.texture_stretch", bone.texture_stretch, 0.1, 10.0);
}

}  // namespace

Mat3 rotation_from_degrees(const Vec3& degrees) {
  const auto turn = [&](int axis) {
    return Eigen::AngleAxisd(shapes::radians(degrees[axis]), Vec3::Unit(axis)).toRotationMatrix();
  };
  return turn(2) * turn(1) * turn(0);
}

Vec3 rotation_in_degrees(const Mat3& r) {
  return Vec3(std::atan2(r(2, 1), r(2, 2)), std::asin(std::clamp(-r(2, 0), -1.0, 1.0)), std::atan2(r(1, 0), r(0, 0))) /
         kDegree;
}

void check_anatomy(const VertebraAnatomy& anatomy) {
  const VertebraAnatomy::Body& body = anatomy.body;
  in_range("body.width_mm", body.width_mm, 10.0, 90.0);
  in_range("body.depth_mm", body.depth_mm, 8.0, body.width_mm);
  in_range("body.height_mm", body.height_mm, 5.0, 60.0);
  in_range("body.edge_mm", body.edge_mm, 0.1, 0.2 * body.height_mm);
  in_range("body.waist_mm", body.waist_mm, 0.0, 0.25 * body.depth_mm);
  in_range("body.kidney_mm", body.kidney_mm, 0.0, 0.25 * body.depth_mm);
  in_range("body.kidney_width_mm", body.kidney_width_mm, 2.0, 50.0);
  in_range("body.superior_hollow_mm", body.superior_hollow_mm, 0.0, 0.25 * body.height_mm);
  in_range("body.inferior_hollow_mm", body.inferior_hollow_mm, 0.0, 0.25 * body.height_mm);
  in_range("body.rim_mm", body.rim_mm, 0.0, 0.25 * body.depth_mm);
  in_range("body.wedge_deg", body.wedge_deg, -30.0, 30.0);
  in_range("body.side_wedge_deg", body.side_wedge_deg, -30.0, 30.0);

  check_pedicle("pedicle", anatomy.pedicle);
  if (anatomy.right_pedicle) check_pedicle("right_pedicle", *anatomy.right_pedicle);

  const VertebraAnatomy::Canal& canal = anatomy.canal;
  in_range("canal.width_mm", canal.width_mm, 4.0, 60.0);
  in_range("canal.front_mm", canal.front_mm, 0.0, 60.0);
  in_range("canal.back_mm", canal.back_mm, canal.front_mm + 4.0, 100.0);
  in_range("canal.roof_deg", canal.roof_deg, 5.0, 80.0);
  in_range("canal.rounding_mm", canal.rounding_mm, 0.1, 15.0);
  in_range("canal.blend_mm", canal.blend_mm, 0.1, 10.0);

  check_process("transverse", anatomy.transverse);
  check_process("superior_articular", anatomy.superior_articular);
  check_process("inferior_articular", anatomy.inferior_articular);
  check_process("pars", anatomy.pars);
  in_range("facet.radius_mm", anatomy.facet.radius_mm, 2.0, 1000.0);
  in_range("facet.hollow_mm", anatomy.facet.hollow_mm, -10.0, 10.0);
  position("mammillary.centre_mm", anatomy.mammillary.centre_mm);
  in_range("mammillary.radius_mm", anatomy.mammillary.radius_mm, 0.5, 15.0);
  in_range("mammillary.blend_mm", anatomy.mammillary.blend_mm, 0.1, 15.0);

  const VertebraAnatomy::Lamina& lamina = anatomy.lamina;
  position("lamina.centre_mm", lamina.centre_mm);
  in_range("lamina.slope_deg", lamina.slope_deg, 0.0, 80.0);
  in_range("lamina.lean_deg", lamina.lean_deg, -45.0, 45.0);
  in_range("lamina.thickness_mm", lamina.thickness_mm, 1.0, 20.0);
  in_range("lamina.length_mm", lamina.length_mm, lamina.thickness_mm, 60.0);
  in_range("lamina.height_mm", lamina.height_mm, lamina.thickness_mm, 60.0);
  in_range("lamina.blend_mm", lamina.blend_mm, 0.1, 15.0);
  check_spinous(anatomy.spinous);
  check_bone(anatomy.cortex, anatomy.cancellous);
  position("placement.position_mm", anatomy.placement.position_mm, 1e5);
  position("placement.rotation_deg", anatomy.placement.rotation_deg, 360.0);
}

}  // namespace spinaltap
