// The two transforms: nifti1.h, "3D IMAGE (VOLUME) ORIENTATION AND LOCATION IN SPACE", methods 1 to 3. What ITK takes,
// and 3D Slicer with it: itkNiftiImageIO.cxx, SetImageIOOrientationFromNIfTI(), from ITK 5.2 on; before that, the qform
// wherever there was one. ITK takes the length of steps from pixdim always. nibabel and FSL take the sform where there
// is one.

#include "core/ct/detail/nifti_place.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace spinaltap {
namespace {

constexpr int kScanner = 1;
constexpr int kAligned = 2;

bool is_template(const NiftiTransform& form) { return form.code > kAligned; }

const char* space_of(const NiftiTransform& form) {
  switch (form.code) {
    case kScanner:
      return "the scanner's";
    case kAligned:
      return "aligned to another scan";
    case 3:
      return "Talairach's template";
    case 4:
      return "the MNI 152 template";
    default:
      return "a template";
  }
}

Vec3 lengths_mm(const NiftiTransform& form) { return form.steps_mm.colwise().norm(); }

std::string by(const Vec3& v) { return joined(v.x(), " x ", v.y(), " x ", v.z()); }

/// "sform (code 4, the MNI 152 template; voxels of 1.65 x 1.65 x 1.65 mm)".
std::string described(const char* name, const NiftiTransform& form) {
  return joined(name, " (code ", form.code, ", ", space_of(form), "; voxels of ", by(lengths_mm(form)), " mm)");
}

Vec3 corner_index(const NiftiForms& forms, int corner) {
  Vec3 index;
  for (int axis = 0; axis < 3; ++axis) {
    index[axis] = (corner >> axis & 1) != 0 ? forms.size[static_cast<std::size_t>(axis)] - 1 : 0;
  }
  return index;
}

/// Where the two transforms are furthest apart.
struct Apart {
  double mm = 0.0;
  double diagonal_mm = 0.0;  ///< of the volume
  Vec3 by_sform_mm = Vec3::Zero();
  Vec3 by_qform_mm = Vec3::Zero();
};

Apart apart(const NiftiForms& forms) {
  Apart most;
  most.mm = -1.0;
  most.diagonal_mm = (forms.qform.steps_mm * corner_index(forms, 7)).norm();
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 index = corner_index(forms, corner);
    const Vec3 by_sform_mm = forms.sform.origin_mm + forms.sform.steps_mm * index;
    const Vec3 by_qform_mm = forms.qform.origin_mm + forms.qform.steps_mm * index;
    const double mm = (by_sform_mm - by_qform_mm).norm();
    if (mm > most.mm || std::isnan(mm)) most = {mm, most.diagonal_mm, by_sform_mm, by_qform_mm};
  }
  return most;
}

/// How an sform's steps go with pixdim.
enum class StepFit {
  fit,    ///< as long as pixdim says, at right angles
  lean,   ///< as long, the third axis leans
  other,  ///< neither
};

StepFit steps_of(const NiftiForms& forms) {
  constexpr double kSquare = 1e-3;  // cosine between axes that are at right angles but for rounding
  constexpr double kSameMm = 1e-3;  // as ITK has it
  const Vec3 length_mm = lengths_mm(forms.sform);
  const Mat3 axes = forms.sform.steps_mm * length_mm.cwiseInverse().asDiagonal();
  const Vec3 normal = axes.col(0).cross(axes.col(1)).normalized();
  const auto is_length = [&](int axis, double mm) {
    const double said_mm = forms.pixdim_mm[axis];
    return !(said_mm > 0.0 && std::isfinite(said_mm)) || std::abs(mm - said_mm) <= kSameMm;
  };
  const bool is_square = std::abs(axes.col(0).dot(axes.col(1))) < kSquare;
  const double upright = std::abs(axes.col(2).dot(normal));
  if (!is_square || !is_length(0, length_mm[0]) || !is_length(1, length_mm[1])) return StepFit::other;
  // Writers say the step along the third axis, or the distance of the slices.
  if (!is_length(2, length_mm[2]) && !is_length(2, length_mm[2] * upright)) return StepFit::other;
  const bool leans = std::hypot(axes.col(2).dot(axes.col(0)), axes.col(2).dot(axes.col(1))) >= kSquare;
  return leans ? StepFit::lean : StepFit::fit;
}

/// What ITK takes of two transforms that differ.
const char* itk_takes(const NiftiForms& forms) {
  const Mat3 axes = forms.sform.steps_mm * lengths_mm(forms.sform).cwiseInverse().asDiagonal();
  const bool is_orthonormal = (axes * axes.transpose()).isIdentity(1e-4);
  return is_orthonormal && forms.sform.code == kScanner ? "sform" : "qform";
}

std::string both_places(const NiftiForms& forms, const Apart& most) {
  return joined(described("the sform", forms.sform), " and ", described("the qform", forms.qform), " are ", most.mm,
                " mm apart at the farthest corner, which lies at ", most.by_sform_mm.transpose(), " or at ",
                most.by_qform_mm.transpose(), " mm (LPS)");
}

std::string what_others_take(const NiftiForms& forms) {
  return joined("ITK from 5.2 on and 3D Slicer from 5.0 on take the ", itk_takes(forms),
                " with the steps of pixdim, nibabel and FSL the sform");
}

void check_steps(const NiftiTransform& form, int unit, const std::string& file) {
  constexpr double kMinMm = 0.005;
  constexpr double kMaxMm = 25.0;
  if (!form.steps_mm.allFinite() || !form.origin_mm.allFinite() || !(std::abs(form.steps_mm.determinant()) > 1e-12)) {
    fail("expected a NIfTI transform that gives voxels a volume, found one that does not in ", file);
  }
  const Vec3 length_mm = lengths_mm(form);
  if (length_mm.minCoeff() >= kMinMm && length_mm.maxCoeff() <= kMaxMm) return;
  const char* const said = unit == 1 ? "metres" : unit == 3 ? "microns" : unit == 2 ? "mm" : "no unit, taken as mm";
  fail("expected voxels of ", kMinMm, " to ", kMaxMm, " mm, found ", by(length_mm),
       " mm; the header says its lengths are in ", said, " (xyzt_units), which they seem not to be: ", file);
}

[[noreturn]] void fail_unsure(const NiftiForms& forms, const Apart& most, const std::string& why,
                              const std::string& file) {
  fail("expected an sform and a qform that agree, found that ", both_places(forms, most), ": ", why, "; ",
       what_others_take(forms),
       "; say which is meant, sform or qform, or convert the file anew from its DICOM slices: ", file);
}

NiftiPlace taken(const NiftiTransform& form, std::vector<std::string> warnings = {}) {
  return {form.steps_mm, form.origin_mm, std::move(warnings)};
}

NiftiPlace place_by_sform(const NiftiForms& forms, const std::string& file) {
  if (steps_of(forms) == StepFit::other) {
    const std::string known_cause =
        is_template(forms.sform) ? "as of a scan that was scaled to a template" : "as of shear that is half undone";
    fail(
        "expected an sform whose steps are as long as pixdim says, ", by(forms.pixdim_mm), " mm, found ",
        by(lengths_mm(forms.sform)), " mm or axes that are not at right angles, ", known_cause,
        ", and no qform; ITK takes pixdim's steps, nibabel and FSL the sform's; to take the sform as it is, say so; or "
        "convert the file anew from its DICOM slices: ",
        file);
  }
  if (!is_template(forms.sform)) return taken(forms.sform);
  return taken(forms.sform, {joined("it lies in the space of ", space_of(forms.sform), " (sform code ",
                                    forms.sform.code, ", no qform), not where the scanner saw it")});
}

NiftiPlace place_by_either(const NiftiForms& forms, const std::string& file) {
  constexpr double kSameMm = 0.1;
  const Apart most = apart(forms);
  if (most.mm <= kSameMm + forms.qform_rounding_rad * most.diagonal_mm) return taken(forms.sform);
  if (forms.sform.steps_mm.determinant() * forms.qform.steps_mm.determinant() < 0.0) {
    fail_unsure(forms, most, "one mirrors the other, left and right change places", file);
  }
  const std::string places = both_places(forms, most);
  if (is_template(forms.sform) && !is_template(forms.qform)) {
    return taken(forms.qform, {places + ": the qform is taken, which is the scanner's; " + what_others_take(forms)});
  }
  const StepFit steps = steps_of(forms);
  if (steps == StepFit::lean) {
    return taken(forms.sform, {places +
                               ": the sform is taken, whose slices lean as of a tilted gantry, which a qform "
                               "cannot hold; " +
                               what_others_take(forms)});
  }
  if (steps == StepFit::fit && forms.sform.code == kScanner) {
    return taken(forms.sform, {places + ": the sform is taken; " + what_others_take(forms)});
  }
  fail_unsure(forms, most,
              steps == StepFit::other ? joined("pixdim says ", by(forms.pixdim_mm),
                                               " mm, which the sform contradicts, as of shear of a tilted gantry that "
                                               "is half undone (dcm2niix of 2022) or of scaling")
                                      : std::string("neither is sure"),
              file);
}

}  // namespace

NiftiPlace place_nifti(const NiftiForms& forms, NiftiAffine choice, const std::string& file) {
  const bool has_sform = forms.sform.is_there();
  const bool has_qform = forms.qform.is_there();
  if (!has_sform && !has_qform) {
    fail(
        "expected a NIfTI sform or qform that says where the voxels lie, found neither (both codes are 0): left and "
        "right, up and down are unknown; convert it anew, or give it the qform that it should have: ",
        file);
  }
  if (has_sform) check_steps(forms.sform, forms.unit, file);
  if (has_qform) check_steps(forms.qform, forms.unit, file);
  if (has_qform && choice != NiftiAffine::sform && !(forms.pixdim_mm.allFinite() && forms.pixdim_mm.minCoeff() > 0.0)) {
    fail("expected steps above 0 as pixdim, which a qform needs, found ", by(forms.pixdim_mm), " in ", file);
  }
  if (choice != NiftiAffine::automatic) {
    const bool is_sform = choice == NiftiAffine::sform;
    const NiftiTransform& form = is_sform ? forms.sform : forms.qform;
    const char* const name = is_sform ? "sform" : "qform";
    if (!form.is_there()) fail("expected a NIfTI ", name, ", found none (", name, "_code is 0) in ", file);
    return taken(form);
  }
  if (!has_qform) return place_by_sform(forms, file);
  if (!has_sform) return taken(forms.qform);
  return place_by_either(forms, file);
}

}  // namespace spinaltap
