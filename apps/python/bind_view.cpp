#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "core/base/error.h"
#include "core/base/view.h"
#include "core/session/record/session_record.h"

namespace py = pybind11;
using namespace py::literals;

namespace spinaltap {

namespace {

using Square = py::array_t<double, py::array::c_style | py::array::forcecast>;

Eigen::Matrix4d pose_of(const Square& numbers) {
  if (numbers.ndim() != 2 || numbers.shape(0) != 4 || numbers.shape(1) != 4) {
    fail("expected a camera's pose of shape (4, 4), found ", numbers.ndim(), " dimensions and ", numbers.size(),
         " numbers");
  }
  Eigen::Matrix4d pose;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) pose(row, column) = numbers.at(row, column);
  }
  return pose;
}

py::array_t<double> pose_array(const Eigen::Matrix4d& m) {
  py::array_t<double> array({4, 4});
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) array.mutable_at(row, column) = m(row, column);
  }
  return array;
}

/// An array that shows the view's own memory and keeps it alive.
template <class T>
py::array shown(const py::object& view, const std::vector<T>& values, std::vector<py::ssize_t> shape) {
  if (values.empty()) return py::array_t<T>(std::vector<py::ssize_t>(shape.size(), 0));
  py::array array(py::dtype::of<T>(), std::move(shape), {}, values.data(), view);
  array.attr("setflags")("write"_a = false);
  return array;
}

py::array points_of_view(const View& view) {
  std::vector<Vec3> points;
  points.reserve(view.depth_mm.size());
  for (int row = 0; row < view.camera.height; ++row) {
    for (int column = 0; column < view.camera.width; ++column) {
      const bool is_seen = view.mask[view.pixel(column, row)] != 0;
      points.push_back(is_seen ? view.point_mm(column, row)
                               : Vec3(Vec3::Constant(std::numeric_limits<double>::quiet_NaN())));
    }
  }
  return array_of(std::move(points)).attr("reshape")(view.camera.height, view.camera.width, 3);
}

void bind_camera(py::module_& module) {
  py::class_<Camera>(module, "Camera",
                     R"(A pinhole without distortion, in OpenCV's convention: x to the right of the picture, y down, z
forward. The middle of the pixel in column u and row v, from 0, is (u, v). to_patient: from its frame to patient LPS, mm.)")
      .def(py::init([](int width, int height, double fx, double fy, const std::optional<double>& cx,
                       const std::optional<double>& cy, const py::object& to_patient) {
             Camera camera{.width = width, .height = height, .fx = fx, .fy = fy};
             camera.cx = cx.value_or(0.5 * (width - 1));
             camera.cy = cy.value_or(0.5 * (height - 1));
             if (!to_patient.is_none()) camera.to_patient = pose_of(to_patient.cast<Square>());
             check_camera(camera);
             return camera;
           }),
           py::kw_only(), "width"_a = 640, "height"_a = 480, "fx"_a = 600.0, "fy"_a = 600.0, "cx"_a = py::none(),
           "cy"_a = py::none(), "to_patient"_a = py::none(),
           "cx, cy: the picture's middle by default. Raises Error on what is no camera.")
      .def_static(
          "look_at",
          [](const Numbers& eye_mm, const Numbers& target_mm, const Numbers& up, double field_of_view_deg, int width,
             int height) {
            return look_at(vec3_of(eye_mm, "eye_mm"), vec3_of(target_mm, "target_mm"), vec3_of(up, "up"),
                           field_of_view_deg * kDegree, width, height);
          },
          "eye_mm"_a, "target_mm"_a, py::kw_only(), "up"_a = std::vector<double>{0.0, 0.0, 1.0},
          "field_of_view_deg"_a = 40.0, "width"_a = 640, "height"_a = 480,
          "At a place, with another in the middle of its picture; the field of view goes from left to right.")
      .def_readonly("width", &Camera::width)
      .def_readonly("height", &Camera::height)
      .def_property_readonly(
          "matrix", [](const Camera& camera) { return array_of(camera.matrix()); }, "Intrinsic, K: (3, 3), pixels.")
      .def_property_readonly(
          "to_patient", [](const Camera& camera) { return pose_array(camera.to_patient); },
          "(4, 4); the inverse of OpenCV's extrinsic matrix.")
      .def_property_readonly("eye_mm", [](const Camera& camera) { return array_of(camera.eye_mm()); });
}

}  // namespace

void bind_view(py::module_& module) {
  module.attr("SEEN") = py::make_tuple("nothing", "bone", "wall", "bit");
  bind_camera(module);
  py::class_<View>(module, "View", "What a camera sees; its arrays show the memory that C++ filled. docs/learning.md.")
      .def_readonly("camera", &View::camera)
      .def_property_readonly(
          "depth_mm",
          [](const py::object& self) {
            const auto& view = self.cast<const View&>();
            return shown(self, view.depth_mm, {view.camera.height, view.camera.width});
          },
          "Along the optical axis: (height, width), float32; 0 where there is nothing.")
      .def_property_readonly(
          "normals",
          [](const py::object& self) {
            const auto& view = self.cast<const View&>();
            return shown(self, view.normals, {view.camera.height, view.camera.width, 3});
          },
          "Unit, outward, patient LPS: (height, width, 3), float32; zeros where there is nothing; empty where a record "
          "has none.")
      .def_property_readonly(
          "mask",
          [](const py::object& self) {
            const auto& view = self.cast<const View&>();
            return shown(self, view.mask, {view.camera.height, view.camera.width});
          },
          "Counts through SEEN: (height, width), uint8.")
      .def("points_mm", &points_of_view, "What each pixel shows, patient LPS: (height, width, 3); NaN where nothing.");
  py::class_<RecordedFrame>(module, "Frame", "What a camera saw of a drilling after a cycle.")
      .def_readonly("cycle", &RecordedFrame::cycle, "Index of the last cycle before it.")
      .def_readonly("time_s", &RecordedFrame::time_s)
      .def_readonly("view", &RecordedFrame::view);
  module.def(
      "read_frames",
      [](const std::filesystem::path& file, std::uint64_t first, const std::optional<std::uint64_t>& count) {
        return read_frames(file, first, count.value_or(std::numeric_limits<std::uint64_t>::max()));
      },
      "file"_a, "first"_a = 0, "count"_a = py::none(), py::call_guard<py::gil_scoped_release>(),
      "Those of a record, all by default. Raises Error as read_record() does.");
}

}  // namespace spinaltap
