#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <array>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/names.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/base/text_writer.h"
#include "core/files/bit_file.h"
#include "core/files/plan_file.h"
#include "core/tool/drill_path.h"
#include "vdb/sim/bone.h"

namespace py = pybind11;
using namespace py::literals;

namespace spinaltap {

namespace {

DrillBit make_bit(double diameter_mm, double length_mm, double tip_length_mm, const std::string& shape,
                  double tip_diameter_mm, double shank_diameter_mm, double helix_deg, double wear_mm) {
  DrillBit bit{diameter_mm,     length_mm,        tip_length_mm, named(bit_shapes(), shape, "a shape"),
               tip_diameter_mm, shank_diameter_mm};
  bit.helix_deg = helix_deg;
  bit.wear_mm = wear_mm;
  check_bit(bit);
  return bit;
}

DrillBit make_plate(double width_mm, double thickness_mm, double length_mm, double stroke_mm,
                    const Numbers& width_along) {
  DrillBit plate = plate_bit(width_mm, thickness_mm, length_mm, stroke_mm);
  const Vec3 along = vec3_of(width_along, "width_along");
  if (!(along.norm() > 0.0)) fail("expected width_along as a direction that is not zero");
  plate.width_along = along.normalized();
  check_bit(plate);
  return plate;
}

/// Of tuples (back_mm, radius_mm), or (back_mm, radius_mm, is_arc).
DrillBit make_profile(const std::vector<py::tuple>& outline) {
  std::vector<OutlinePoint> points;
  constexpr const char* kExpected = "outline: expected places of (back_mm, radius_mm) or (back_mm, radius_mm, is_arc)";
  for (const py::tuple& place : outline) {
    if (place.size() != 2 && place.size() != 3) fail(kExpected, ", found one of ", place.size());
    try {
      points.push_back({place[0].cast<double>(), place[1].cast<double>(), place.size() == 3 && place[2].cast<bool>()});
    } catch (const py::cast_error&) {
      fail(kExpected, ", found ", py::repr(place).cast<std::string>());
    }
  }
  return profile_bit(std::move(points));
}

std::vector<std::tuple<double, double, bool>> outline_of(const DrillBit& bit) {
  std::vector<std::tuple<double, double, bool>> places;
  for (const OutlinePoint& point : bit.outline) places.emplace_back(point.back_mm, point.radius_mm, point.is_arc);
  return places;
}

PedicleScrew make_screw(double diameter_mm, double length_mm, double tip_length_mm, const std::string& name,
                        std::optional<double> core_diameter_mm, std::optional<double> pitch_mm) {
  PedicleScrew screw{name, diameter_mm, length_mm, tip_length_mm};
  if (core_diameter_mm || pitch_mm) {
    ScrewThread thread = usual_thread(diameter_mm);
    thread.core_diameter_mm = core_diameter_mm.value_or(thread.core_diameter_mm);
    thread.pitch_mm = pitch_mm.value_or(thread.pitch_mm);
    screw.thread = thread;
  }
  check_screw(screw);
  return screw;
}

DrillPath make_path(const Numbers& entry_mm, const Numbers& target_mm, const std::optional<DrillBit>& bit,
                    const std::string& name, const std::optional<PedicleScrew>& screw,
                    const std::vector<Numbers>& via_mm) {
  DrillPath path{name, vec3_of(entry_mm, "entry_mm"), vec3_of(target_mm, "target_mm"), bit.value_or(DrillBit{}), screw};
  for (const Numbers& place : via_mm) path.via_mm.push_back(vec3_of(place, "via_mm"));
  if (!bit && path.is_curved()) path.bit = steerable_head();
  check_path(path);
  return path;
}

std::string text_of(const Vec3& v) {
  TextWriter text;
  text << '(' << v.x() << ", " << v.y() << ", " << v.z() << ')';
  return text.str();
}

void save_plan(const std::vector<DrillPath>& paths, const std::filesystem::path& file) {
  StagedOutput output;
  write_plan(paths, output.stage(file));
  output.commit();
}

}  // namespace

void bind_plan(py::module_& module) {
  py::class_<DrillBit>(module, "Bit", "A tool: a drill, a burr or a plate. Lengths in mm. Nothing changes it.")
      .def(py::init(&make_bit), "diameter_mm"_a = 3.0, "length_mm"_a = 50.0, "tip_length_mm"_a = 5.0,
           "shape"_a = "drill", "tip_diameter_mm"_a = 0.0, "shank_diameter_mm"_a = 0.0, "helix_deg"_a = 25.0,
           "wear_mm"_a = 0.0,
           "`shape`: \"drill\", \"round-burr\", \"conical-burr\" or \"tapered-screw\". Raises Error on sizes that make "
           "no sense.")
      .def_static("twist_drill", &twist_drill, "diameter_mm"_a, "length_mm"_a = 50.0, "point_angle_deg"_a = 118.0,
                  py::kw_only(), "chisel_edge_mm"_a,
                  "A twist drill, by the angle of its whole tip and the width of its chisel edge.")
      .def_static("profile", &make_profile, "outline"_a,
                  "A bit of any outline: places from the tip to the base, each (back_mm, radius_mm), or with True as a "
                  "third where a ball's arc leads there. Raises Error on an outline that makes no sense.")
      .def_static("plate", &make_plate, "width_mm"_a, "thickness_mm"_a, "length_mm"_a, py::kw_only(),
                  "stroke_mm"_a = 0.0, "width_along"_a = std::array{0.0, 0.0, 1.0},
                  "A saw, or without a stroke an osteotome: a box whose edge cuts, as wide and as thick as what it "
                  "cuts. `width_along`: how it is held where poses say no side, patient LPS: its width as nearly along "
                  "this as the axis lets it. Only voxels are cut by it. Raises Error on sizes that make no sense.")
      .def_static(
          "read", [](const std::string& name_or_file) { return read_bit_profile(name_or_file).bit; }, "name_or_file"_a,
          "A bit of any outline: a shipped one by its name, such as \"match-head\", else a file.")
      .def_readonly("diameter_mm", &DrillBit::diameter_mm, "Where it is widest; of a plate its width.")
      .def_readonly("length_mm", &DrillBit::length_mm)
      .def_readonly("tip_length_mm", &DrillBit::tip_length_mm)
      .def_property_readonly("shape", [](const DrillBit& bit) { return name_of(bit.shape); })
      .def_readonly("tip_diameter_mm", &DrillBit::tip_diameter_mm)
      .def_readonly("shank_diameter_mm", &DrillBit::shank_diameter_mm)
      .def_readonly("helix_deg", &DrillBit::helix_deg, "Of a drill's flutes at the rim.")
      .def_readonly("wear_mm", &DrillBit::wear_mm, "Height of the flat behind a drill's lips.")
      .def_readonly("thickness_mm", &DrillBit::thickness_mm, "Of a plate; else 0.")
      .def_readonly("stroke_mm", &DrillBit::stroke_mm, "Of a saw, how far its teeth go to and fro; else 0.")
      .def_property_readonly(
          "width_along", [](const DrillBit& bit) { return array_of(bit.width_along); },
          "How a plate is held where poses say no side, unit, patient LPS.")
      .def_property_readonly("outline", &outline_of,
                             "Of a profile: (back_mm, radius_mm, is_arc) from the tip to the base; else empty.");

  py::class_<PedicleScrew>(module, "Screw", "A screw for a pedicle. Lengths in mm. Nothing changes it.")
      .def(
          py::init(&make_screw), "diameter_mm"_a = 6.5, "length_mm"_a = 45.0, "tip_length_mm"_a = 4.0, "name"_a = "",
          "core_diameter_mm"_a = py::none(), "pitch_mm"_a = py::none(),
          "`length_mm`: from under the head to the tip. The thread's core and pitch are the usual ones of the diameter "
          "where they are not given. Raises Error on sizes that make no sense.")
      .def_readonly("name", &PedicleScrew::name)
      .def_readonly("diameter_mm", &PedicleScrew::diameter_mm)
      .def_readonly("length_mm", &PedicleScrew::length_mm)
      .def_readonly("tip_length_mm", &PedicleScrew::tip_length_mm)
      .def_property_readonly(
          "core_diameter_mm", [](const PedicleScrew& screw) { return screw.thread_or_usual().core_diameter_mm; },
          "Between the threads.")
      .def_property_readonly(
          "pitch_mm", [](const PedicleScrew& screw) { return screw.thread_or_usual().pitch_mm; },
          "From thread to thread.");

  py::class_<DrillPath>(module, "Path", "A planned hole, straight or curved, patient LPS, mm. Nothing changes it.")
      .def("__copy__", [](const DrillPath& self) { return DrillPath(self); })
      .def(
          "__deepcopy__", [](const DrillPath& self, const py::dict&) { return DrillPath(self); }, "memo"_a)
      .def(py::init(&make_path), "entry_mm"_a, "target_mm"_a, "bit"_a = py::none(), "name"_a = "",
           "screw"_a = py::none(), "via_mm"_a = std::vector<Numbers>{},
           "From the entry on the bone's surface to the target inside; 3 numbers each. `via_mm`: places between, which "
           "a smooth curve passes, as a steerable drill goes. `bit`: Bit() where none is said, a ball of 3 mm where "
           "the path is curved. Raises Error on a path shorter than 0.1 mm or longer than 500 mm, and on a curve that "
           "the "
           "bit cannot go.")
      .def_readonly("name", &DrillPath::name)
      .def_property_readonly("entry_mm", [](const DrillPath& path) { return array_of(path.entry_mm); })
      .def_property_readonly("target_mm", [](const DrillPath& path) { return array_of(path.target_mm); })
      .def_property_readonly(
          "direction", [](const DrillPath& path) { return array_of(path.direction()); },
          "Unit, from the entry to the target: of a curved path its chord's.")
      .def_property_readonly(
          "via_mm",
          [](const DrillPath& path) {
            py::list places;
            for (const Vec3& via_mm : path.via_mm) places.append(array_of(via_mm));
            return places;
          },
          "Places between entry and target of a curved path; empty where it is straight.")
      .def_property_readonly("length_mm", &DrillPath::length_mm)
      .def_readonly("bit", &DrillPath::bit)
      .def_readonly("screw", &DrillPath::screw)
      .def_property_readonly(
          "ct_hash", [](const DrillPath& path) { return path.bone.ct_hash; },
          "Of the CT that it is planned in, as Bone.ct_hash; empty: not known. A bone of another is refused.")
      .def_property_readonly(
          "level", [](const DrillPath& path) { return level_name(path.bone.level); },
          "The vertebra that it is planned for; empty: not known.")
      .def(
          "for_bone",
          [](DrillPath path, const Bone& bone) {
            path.bone = bone.identity();
            return path;
          },
          "bone"_a, "The same path, planned for this bone: to take one of another CT or vertebra all the same.")
      .def("__repr__", [](const DrillPath& path) {
        return "<Path \"" + path.name + "\" from " + text_of(path.entry_mm) + " to " + text_of(path.target_mm) + " mm>";
      });

  module.def("read_plan", &read_plan, "file"_a,
             "Paths of a plan: JSON, or lines from 3D Slicer's markups. Raises Error that names the key at fault.");
  module.def("write_plan", &save_plan, "paths"_a, "file"_a,
             "Writes a plan, whole or not at all; markups where the name ends in \".mrk.json\".");
}

}  // namespace spinaltap
