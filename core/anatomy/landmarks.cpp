#include "core/anatomy/landmarks.h"

#include <algorithm>
#include <cmath>

#include "core/anatomy/body_landmarks.h"
#include "core/anatomy/canal_search.h"
#include "core/anatomy/detail/canal_wall.h"
#include "core/anatomy/detail/landmark_warnings.h"
#include "core/anatomy/detail/pedicle_search.h"
#include "core/anatomy/detail/symmetry_plane.h"
#include "core/base/error.h"

namespace spinaltap {
namespace {

/// A right-handed frame with exactly this left and about this top.
Mat3 frame_of(const Vec3& left, const Vec3& about_superior) {
  Mat3 axes;
  axes.col(0) = left;
  axes.col(1) = about_superior.cross(left).normalized();
  axes.col(2) = left.cross(axes.col(1));
  return axes;
}

void reject_several_pieces(const BoneShape& bone) {
  constexpr double kMinMm3 = 3000.0, kShare = 0.15;
  const std::vector<double> volumes_mm3 = piece_volumes_mm3(bone);
  if (volumes_mm3.empty()) fail("landmarks: expected a vertebra, found no bone");
  if (volumes_mm3.size() < 2 || volumes_mm3[1] < std::max(kMinMm3, kShare * volumes_mm3[0])) return;
  fail("landmarks: expected one vertebra, found pieces of ", 1e-3 * volumes_mm3[0], " and ", 1e-3 * volumes_mm3[1],
       " cm³ that do not touch: two vertebrae, or one in parts; bake one vertebra alone");
}

void reject_cut_bone(const CutFace& face) {
  constexpr double kMaxMm2 = 350.0;
  if (face.area_mm2 < kMaxMm2) return;
  fail("landmarks: expected a whole vertebra, but it ends at the patient's ", side_of_patient(face.normal),
       " in a flat face of ", std::round(face.area_mm2),
       " mm²: a part is cut away there; crop and segment the CT so that the whole vertebra is in it");
}

CanalView canal_or_error(const SurfaceSample& surface) {
  const std::optional<CanalView> canal = find_canal(surface);
  if (canal) return *canal;
  fail(
      "landmarks: no canal: from no direction within 45 degrees of the patient's superior axis can one look through "
      "the bone in a circle of 3 mm radius; expected a whole vertebra with a closed arch, its top nearest to the "
      "patient's");
}

/// Axes from the canal's direction and the way from canal to body.
Mat3 first_axes(const CanalView& canal, const Core& core) {
  constexpr double kNearMm = 8.0, kFarMm = 60.0;
  const Vec3 to_body_mm = core.centre_mm - canal.point_mm;
  const Vec3 level_mm = to_body_mm - to_body_mm.dot(canal.axis) * canal.axis;
  if (!(level_mm.norm() >= kNearMm && level_mm.norm() <= kFarMm)) {
    fail("landmarks: no vertebral body: the thickest part of the bone lies ", level_mm.norm(),
         " mm from the canal's axis, expected ", kNearMm, " to ", kFarMm, " mm");
  }
  const Vec3 posterior = -level_mm.normalized();
  return frame_of(posterior.cross(canal.axis), canal.axis);
}

void reject_two_bodies(const BoneShape& bone, const Core& core, const Mat3& axes) {
  const int bodies = count_bodies(bone, core.centre_mm, axes);
  if (bodies > 1) fail("landmarks: expected one vertebra, found ", bodies, " vertebral bodies one above the other");
}

void reject_tall_body(const Landmarks::Body& body) {
  constexpr double kMaxHeightOverDepth = 1.5;
  if (body.height_mm <= kMaxHeightOverDepth * body.depth_mm) return;
  fail("landmarks: expected one vertebra, found a body ", body.height_mm, " mm high and only ", body.depth_mm,
       " mm deep: two that touch or have grown together");
}

/// The body of a vertebra is the thickest part by far: a ring of even thickness has none. A pedicle is as thick as its
/// section is at its narrowest: those of L5 may be almost as wide as the body is high.
void reject_thin_body(const Landmarks& found) {
  constexpr double kMinOverPedicle = 1.3;
  const double body_mm = std::min({found.body.width_mm, found.body.depth_mm, found.body.height_mm});
  const auto thickness_mm = [](const PedicleLandmarks& pedicle) {
    return std::min(pedicle.width_mm, pedicle.height_mm);
  };
  const double pedicle_mm = std::max(thickness_mm(found.left_pedicle), thickness_mm(found.right_pedicle));
  if (body_mm >= kMinOverPedicle * pedicle_mm) return;
  fail("landmarks: no vertebral body: the thickest part of the bone is only ", body_mm,
       " mm thick, where a pedicle is ", pedicle_mm, " mm thick; expected a whole vertebra");
}

PedicleLandmarks pedicle_or_error(const BoneShape& bone, const PedicleRegion& region, double side) {
  const std::optional<PedicleLandmarks> pedicle = find_pedicle(bone, region, side);
  if (pedicle) return *pedicle;
  fail("landmarks: no ", side > 0.0 ? "left" : "right",
       " pedicle: beside the canal no bone joins the arch to the body; expected a whole vertebra");
}

/// The point of the canal's axis that lies at the level of `p_mm`, moved into the midsagittal plane.
Vec3 on_canal_at(const CanalView& canal, const SymmetryPlane& middle, const Vec3& superior, const Vec3& p_mm) {
  const double way_mm = (p_mm - canal.point_mm).dot(superior) / canal.axis.dot(superior);
  const Vec3 at_mm = canal.point_mm + way_mm * canal.axis;
  return at_mm - (at_mm - middle.point_mm).dot(middle.normal) * middle.normal;
}

/// A direction turned into the midsagittal plane.
Vec3 in_middle(const Vec3& direction, const SymmetryPlane& middle) {
  return (direction - direction.dot(middle.normal) * middle.normal).normalized();
}

}  // namespace

Landmarks find_landmarks(const BoneShape& bone, const Progress& progress) {
  constexpr const char* kStage = "finding the vertebra's landmarks";
  progress.report(kStage, 0.0);
  reject_several_pieces(bone);
  const SurfaceSample surface = sample_surface(bone);
  const CutFace cut_face = find_cut_face(surface);
  reject_cut_bone(cut_face);
  progress.report(kStage, 0.1);
  const CanalView canal = canal_or_error(surface);
  progress.report(kStage, 0.4);
  const Core core = find_core(bone);
  const Mat3 start = first_axes(canal, core);
  reject_two_bodies(bone, core, start);
  const SymmetryPlane middle =
      find_symmetry_plane(bone, surface, {canal.point_mm, start.col(0), 0.0}, start.col(1), start.col(2));
  progress.report(kStage, 0.6);

  Landmarks found;
  // The endplates' mean direction is the top, and the endplates are found along it.
  found.axes = frame_of(middle.normal, canal.axis);
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    found.body = measure_body(bone, core.centre_mm, found.axes);
    found.axes = frame_of(middle.normal, found.body.upper.normal - found.body.lower.normal);
  }
  reject_tall_body(found.body);
  PedicleRegion region;
  region.axes = found.axes;
  region.canal_mm = on_canal_at(canal, middle, found.superior(), found.body.centre_mm);
  region.canal_radius_mm = canal.radius_mm;
  region.lowest_mm = found.superior().dot(found.body.lower.centre_mm - region.canal_mm);
  region.highest_mm = found.superior().dot(found.body.upper.centre_mm - region.canal_mm);
  found.left_pedicle = pedicle_or_error(bone, region, 1.0);
  found.right_pedicle = pedicle_or_error(bone, region, -1.0);
  reject_thin_body(found);
  progress.report(kStage, 0.8);

  const Vec3 level_mm = 0.5 * (found.left_pedicle.isthmus_mm + found.right_pedicle.isthmus_mm);
  const Vec3 in_canal_mm = on_canal_at(canal, middle, found.superior(), level_mm);
  found.canal = measure_canal(bone, in_canal_mm, in_middle(canal.axis, middle), found.axes);
  found.canal.axis = in_middle(direction_of_canal(bone, surface, found), middle);
  found.canal = measure_canal(bone, in_canal_mm, found.canal.axis, found.axes);
  found.origin_mm = found.canal.centre_mm;
  found.is_canal_wall = canal_wall_flags(bone, found);
  found.warnings = warnings_about(found, middle.residual_mm, cut_face);
  progress.report(kStage, 1.0);
  return found;
}

const char* name_of(VertebraPart part) {
  switch (part) {
    case VertebraPart::body:
      return "body";
    case VertebraPart::pedicle:
      return "pedicle";
    case VertebraPart::lamina:
      return "lamina";
    case VertebraPart::spinous_process:
      return "spinous process";
    case VertebraPart::transverse_process:
      return "transverse process";
    case VertebraPart::superior_articular_process:
      return "superior articular process";
    case VertebraPart::superior_joint:
      return "joint surface of the superior articular process";
    case VertebraPart::other_vertebra:
      return "other vertebra";
    case VertebraPart::inferior_articular_process:
      break;
  }
  return "inferior articular process";
}

Vec3 Landmarks::to_own(const Vec3& p_patient) const { return axes.transpose() * (p_patient - origin_mm); }

Vec3 Landmarks::to_patient(const Vec3& p_own) const { return origin_mm + axes * p_own; }

}  // namespace spinaltap
