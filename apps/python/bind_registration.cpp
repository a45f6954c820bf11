#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/long_call.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/files/registration_file.h"
#include "core/registration/register_fiducials.h"
#include "core/registration/register_surface.h"
#include "vdb/sim/bone.h"

namespace py = pybind11;
using namespace pybind11::literals;

namespace spinaltap {
namespace {

std::vector<RigidPose> tracked_poses(const Numbers& matrices) {
  if (matrices.ndim() != 3 || matrices.shape(1) != 4 || matrices.shape(2) != 4) {
    fail("poses: expected an array of shape (n, 4, 4)");
  }
  std::vector<RigidPose> poses;
  const auto at = matrices.unchecked<3>();
  for (py::ssize_t n = 0; n < matrices.shape(0); ++n) {
    RigidPose pose;
    for (py::ssize_t row = 0; row < 3; ++row) {
      for (py::ssize_t column = 0; column < 3; ++column) pose.rotation(row, column) = at(n, row, column);
      pose.translation_mm[row] = at(n, row, 3);
    }
    poses.push_back(pose);
  }
  return poses;
}

Registration surface_registration(const Bone& bone, const Numbers& touched_mm, const std::optional<Registration>& start,
                                  double noise_mm, double search_mm, double search_deg, const py::object& progress) {
  TouchedOptions options;
  if (start) {
    check_same_bone("the registration to start with", start->bone, bone.identity());
    options.start = start->ct_from_patient;
  }
  options.noise_mm = noise_mm;
  options.search_mm = search_mm;
  options.search_deg = search_deg;
  const std::vector<Vec3> points_mm = points_of(touched_mm);
  Registration found = long_call(
      progress, [&](const Progress& heard) { return register_surface(bone.shape(heard), points_mm, options, heard); });
  found.bone = bone.identity();
  return found;
}

std::vector<Vec3> applied(const Registration& registration, const Numbers& points_mm) {
  std::vector<Vec3> points = points_of(points_mm);
  for (Vec3& p_mm : points) p_mm = registration.ct_from_patient.apply(p_mm);
  return points;
}

void save_registration(const Registration& registration, const std::filesystem::path& file) {
  StagedOutput output;
  write_registration(registration, output.stage(file));
  output.commit();
}

}  // namespace

void bind_registration(py::module_& module) {
  py::class_<Registration>(module, "Registration", "Where the patient is: a pose with what is known of its error.")
      .def_static("load", &read_registration, "file"_a)
      .def("save", &save_registration, "file"_a, "Writes it as JSON, whole or not at all.")
      .def_property_readonly(
          "ct_hash", [](const Registration& found) { return found.bone.ct_hash; },
          "Of the CT that it places the patient in, as Bone.ct_hash; empty: not known.")
      .def_property_readonly("level", [](const Registration& found) { return level_name(found.bone.level); })
      .def_property_readonly("kind", [](const Registration& found) { return name_of(found.kind); })
      .def_property_readonly(
          "rotation", [](const Registration& found) { return array_of(found.ct_from_patient.rotation); },
          "3 by 3, of ct_from_patient.")
      .def_property_readonly("translation_mm",
                             [](const Registration& found) { return array_of(found.ct_from_patient.translation_mm); })
      .def(
          "to_ct",
          [](const Registration& found, const Numbers& points_mm) { return array_of(applied(found, points_mm)); },
          "points_mm"_a, "Measured points, N by 3, as patient LPS of the CT.")
      .def(
          "error_mm",
          [](const Registration& found, const Numbers& place_mm) {
            return target_error_mm(found.covariance, vec3_of(place_mm, "place_mm"));
          },
          "place_mm"_a, "The target registration error to expect at a place of the CT, root mean square.")
      .def(
          "error_covariance_mm2",
          [](const Registration& found, const Numbers& place_mm) {
            return array_of(target_covariance_mm2(found.covariance, vec3_of(place_mm, "place_mm")));
          },
          "place_mm"_a, "The same by direction: its covariance, 3 by 3.")
      .def_readonly("residuals_mm", &Registration::residuals_mm)
      .def_readonly("residual_rms_mm", &Registration::residual_rms_mm, "The FRE, of marks.")
      .def_readonly("rejected", &Registration::rejected, "Places of touched points that were left out.")
      .def_readonly("noise_mm", &Registration::noise_mm, "Deviation of a point to each side.")
      .def_readonly("warnings", &Registration::warnings, "Why it may be wrong; empty: nothing speaks against it.");
  module.def(
      "register_fiducials",
      [](const Numbers& ct_mm, const Numbers& patient_mm, double fle_mm) {
        return register_fiducials(points_of(ct_mm), points_of(patient_mm), {.fle_mm = fle_mm});
      },
      "ct_mm"_a, "patient_mm"_a, "fle_mm"_a = 0.0,
      "From marks in the CT and the same, in the same order, as measured; N by 3. `fle_mm`: how they are located, root "
      "mean square; 0: from the residuals. Raises Error on fewer than 3, and on marks on one line.");
  module.def("register_surface", &surface_registration, "bone"_a, "touched_mm"_a, "start"_a = py::none(),
             "noise_mm"_a = 0.0, "search_mm"_a = 20.0, "search_deg"_a = 20.0, "progress"_a = py::none(),
             "From points touched on the bone's surface, as measured, N by 3. `start`: a registration that is about "
             "right. Look at its warnings. Raises Error on fewer than 12 points.");
  py::class_<PivotCalibration>(module, "PivotCalibration", "Where a tracked tool's tip is.")
      .def_property_readonly(
          "tip_mm", [](const PivotCalibration& found) { return array_of(found.tip_mm); }, "In the tool's frame.")
      .def_property_readonly(
          "pivot_mm", [](const PivotCalibration& found) { return array_of(found.pivot_mm); }, "In the tracker's.")
      .def_property_readonly("tip_covariance_mm2",
                             [](const PivotCalibration& found) { return array_of(found.tip_covariance_mm2); })
      .def_readonly("residuals_mm", &PivotCalibration::residuals_mm)
      .def_readonly("residual_rms_mm", &PivotCalibration::residual_rms_mm)
      .def_readonly("cone_deg", &PivotCalibration::cone_deg)
      .def_readonly("condition", &PivotCalibration::condition)
      .def_readonly("warnings", &PivotCalibration::warnings);
  module.def(
      "calibrate_pivot",
      [](const Numbers& poses, double min_cone_deg) {
        return calibrate_pivot(tracked_poses(poses), {.min_cone_deg = min_cone_deg});
      },
      "poses"_a, "min_cone_deg"_a = 10.0,
      "From poses of the tool in the tracker's frame, N by 4 by 4, while its tip stood still. Raises Error where they "
      "turn too little.");
}

}  // namespace spinaltap
