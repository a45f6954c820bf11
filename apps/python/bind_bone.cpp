#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <string>
#include <vector>

#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/long_call.h"
#include "apps/python/names.h"
#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "vdb/sim/bone.h"
#include "vdb/sim/bone_path.h"
#include "vdb/sim/phantom_output.h"

namespace py = pybind11;
using namespace py::literals;

namespace spinaltap {

namespace {

/// The bone that a label map marks, by number or by name; none without a map.
std::optional<LabelChoice> label_choice(const std::filesystem::path& file, int label, const std::string& level,
                                        const std::string& convention, NiftiAffine affine) {
  if (file.empty()) return std::nullopt;
  const auto found = label_conventions().find(convention);
  if (found == label_conventions().end()) {
    std::string words;
    for (const auto& entry : label_conventions()) words += (words.empty() ? "" : ", ") + entry.first;
    fail("expected as convention one of ", words, ", found ", in_quotes(convention));
  }
  return LabelChoice{file, label, level_named(level), found->second, affine};
}

NiftiAffine affine_named(const std::string& name) {
  if (name == "automatic") return NiftiAffine::automatic;
  if (name == "sform") return NiftiAffine::sform;
  if (name == "qform") return NiftiAffine::qform;
  fail("expected as affine automatic, sform or qform, found ", in_quotes(name));
}

Bone bone_from_ct(const std::filesystem::path& ct, const std::optional<Numbers>& seed_mm,
                  const std::filesystem::path& labels, int label, const std::string& level, double voxel_mm,
                  const std::string& series, bool resample, const std::string& convention, const std::string& affine,
                  bool accept_warnings, const std::filesystem::path& cache, const py::object& progress) {
  BoneFromCt options;
  options.reading.series = series;
  options.reading.resample = resample;
  options.reading.affine = affine_named(affine);
  options.accepts_warnings = accept_warnings;
  options.bake.labels = label_choice(labels, label, level, convention, options.reading.affine);
  options.bake.bake.voxel_mm = voxel_mm;
  options.bake.cache = cache;
  if (seed_mm) options.bake.segment.seed_mm = vec3_of(*seed_mm, "seed_mm");
  return long_call(progress, [&](const Progress& heard) { return Bone::from_ct(ct, options, heard); });
}

/// Values at points, without Python's lock.
template <class Ask>
auto at_points(const Numbers& points_mm, const Ask& ask) {
  const std::vector<Vec3> points = points_of(points_mm);
  auto values = [&] {
    const py::gil_scoped_release unlocked;
    return ask(points);
  }();
  return array_of(std::move(values));
}

py::dict landmarks_of(const Bone& bone, const py::object& progress) {
  const Landmarks marks = long_call(progress, [&](const Progress& heard) { return bone.landmarks(heard); });
  const auto pedicle = [](const PedicleLandmarks& it) {
    return py::dict("isthmus_mm"_a = array_of(it.isthmus_mm), "axis"_a = array_of(it.axis), "width_mm"_a = it.width_mm,
                    "height_mm"_a = it.height_mm);
  };
  const auto endplate = [](const EndplateLandmarks& it) {
    return py::dict("centre_mm"_a = array_of(it.centre_mm), "normal"_a = array_of(it.normal));
  };
  return py::dict(
      "axes"_a = array_of(marks.axes), "origin_mm"_a = array_of(marks.origin_mm),
      "canal"_a = py::dict("centre_mm"_a = array_of(marks.canal.centre_mm), "axis"_a = array_of(marks.canal.axis),
                           "width_mm"_a = marks.canal.width_mm, "depth_mm"_a = marks.canal.depth_mm),
      "body"_a =
          py::dict("centre_mm"_a = array_of(marks.body.centre_mm), "width_mm"_a = marks.body.width_mm,
                   "depth_mm"_a = marks.body.depth_mm, "height_mm"_a = marks.body.height_mm,
                   "upper_endplate"_a = endplate(marks.body.upper), "lower_endplate"_a = endplate(marks.body.lower)),
      "left_pedicle"_a = pedicle(marks.left_pedicle), "right_pedicle"_a = pedicle(marks.right_pedicle),
      "warnings"_a = marks.warnings);
}

void bind_fixation(py::module_& module) {
  py::class_<ScrewFixation> fixation(
      module, "Fixation",
      "How well a path's screw holds; docs/screws.md. Medians, and the bounds that 90 of 100 "
      "keep to.");
  const auto add = [&](const std::string& name, FixationFigure ScrewFixation::*figure, const char* doc) {
    fixation.def_property_readonly(
        name.c_str(), [figure](const ScrewFixation& it) { return (it.*figure).median; }, doc);
    fixation.def_property_readonly(("p05_" + name).c_str(),
                                   [figure](const ScrewFixation& it) { return (it.*figure).p05; });
    fixation.def_property_readonly(("p95_" + name).c_str(),
                                   [figure](const ScrewFixation& it) { return (it.*figure).p95; });
  };
  add("pullout_n", &ScrewFixation::pullout_n, "Axial force that pulls it out, N.");
  add("stiffness_n_mm", &ScrewFixation::stiffness_n_mm,
      "Axial, N/mm: of elastic bone that grips all over, never more.");
  add("max_torque_n_mm", &ScrewFixation::max_torque_n_mm, "The largest insertion torque, N mm.");
  fixation
      .def_readonly("cortical_share", &ScrewFixation::cortical_share, "Of the pull-out strength, by cortex; 0 to 1.")
      .def_readonly("engaged_mm", &ScrewFixation::engaged_mm, "Length of thread in bone, mm.")
      .def_property_readonly(
          "depth_mm",
          [](const ScrewFixation& it) {
            std::vector<double> depths;
            for (const FixationRow& row : it.rows) depths.push_back(row.depth_mm);
            return depths;
          },
          "Depths of the tip, mm, of `torque_n_mm`.")
      .def_property_readonly(
          "torque_n_mm",
          [](const ScrewFixation& it) {
            std::vector<double> torques;
            for (const FixationRow& row : it.rows) torques.push_back(row.torque_n_mm);
            return torques;
          },
          "Insertion torque with the tip there, N mm.");
}

void bind_grade(py::module_& module) {
  py::class_<PathGrade>(module, "Grade", "How safe a path is; docs/grading.md.")
      .def_property_readonly(
          "letter", [](const PathGrade& grade) { return std::string(1, letter_of(grade.grade)); },
          "Gertzbein and Robbins: \"A\" (no breach) to \"E\" (6 mm and more).")
      .def_readonly("breach_mm", &PathGrade::breach_mm)
      .def_readonly("breach_depth_mm", &PathGrade::breach_depth_mm)
      .def_readonly("bearing_mm", &PathGrade::bearing_mm, "Depth from which on bone bears the whole section, mm.")
      .def_readonly("entry_slant_deg", &PathGrade::entry_slant_deg)
      .def_property_readonly(
          "rampersaud", [](const PathGrade& grade) { return std::string(1, grade.rampersaud); }, "\"A\" to \"D\".")
      .def_property_readonly(
          "heary", [](const PathGrade& grade) { return std::string(name_of(grade.heary)); }, "\"I\" to \"V\".")
      .def_readonly("facet", &PathGrade::facet, "Babu's, 0 to 3.")
      .def_property_readonly(
          "warnings",
          [](const PathGrade& grade) {
            std::vector<std::string> words;
            for (const Finding& finding : grade.findings) {
              if (finding.is_warning) words.push_back(finding.words);
            }
            return words;
          },
          "What the instrument touches where it should not, a line each.")
      .def_readonly("breaches_canal", &PathGrade::breaches_canal)
      .def_property_readonly("clearance_outer_mm", [](const PathGrade& grade) { return grade.outer.clearance_mm; })
      .def_property_readonly("clearance_canal_mm", [](const PathGrade& grade) { return grade.canal.clearance_mm; })
      .def_readonly("is_left", &PathGrade::is_left)
      .def_readonly("hu", &PathGrade::hu, "Mean of the tool's volume in bone; NaN where there is none.")
      .def_readonly("max_thrust_n", &PathGrade::max_thrust_n)
      .def_readonly("fixation", &PathGrade::fixation, "How well the path's screw holds; None without one.")
      .def_property_readonly(
          "p05_thrust_n", [](const PathGrade& grade) { return grade.max_thrust_band_n.low; },
          "5 % of the greatest thrust, as sources differ; then 95 %.")
      .def_property_readonly("p95_thrust_n", [](const PathGrade& grade) { return grade.max_thrust_band_n.high; })
      .def("__repr__", [](const PathGrade& grade) { return "<Grade " + std::string(1, letter_of(grade.grade)) + ">"; });
  py::class_<Suggestion>(module, "Suggestion", "A pedicle's screw and path, or why there is none.")
      .def_readonly("side", &Suggestion::side, "\"left\" or \"right\", the patient's.")
      .def_property_readonly(
          "path", [](const Suggestion& it) { return it.best ? std::optional<DrillPath>(it.best->path) : std::nullopt; })
      .def_property_readonly(
          "grade",
          [](const Suggestion& it) { return it.best ? std::optional<PathGrade>(it.best->grade) : std::nullopt; })
      .def_property_readonly(
          "score", [](const Suggestion& it) { return it.best ? it.best->score : std::nan(""); }, "NaN without a path.")
      .def_property_readonly(
          "technique", [](const Suggestion& it) { return it.best ? name_of(it.best->technique) : std::string(); },
          "\"pedicle\", \"in-out-in\" or \"cortical\"; empty without a path.")
      .def_property_readonly(
          "reasons", [](const Suggestion& it) { return it.best ? it.best->reasons : std::vector<std::string>(); },
          "Why this path and no other, a sentence each.")
      .def_readonly("why_none", &Suggestion::rejection, "Empty where there is a path.");
}

}  // namespace

void bind_bone(py::module_& module) {
  bind_fixation(module);
  bind_grade(module);
  py::class_<Bone>(module, "Bone", R"(A baked bone and all that planning and drilling ask of it.

Nothing changes it; any number of threads may use it at once. Positions are patient LPS, mm, of shape (n, 3).)")
      .def_static(
          "phantom",
          [](double voxel_mm, const py::object& progress) {
            PhantomBone made =
                long_call(progress, [&](const Progress& heard) { return phantom_bone(voxel_mm, heard); });
            return std::make_pair(std::move(made.bone), std::move(made.paths));
          },
          "voxel_mm"_a = 0.5, "progress"_a = py::none(),
          "A bone to try things on, without a CT, and a path through each of its pedicles: the shipped vertebra by its "
          "own formula.")
      .def("__copy__", [](const Bone& self) { return Bone(self); })
      .def(
          "__deepcopy__", [](const Bone& self, const py::dict&) { return Bone(self); }, "memo"_a)
      .def_static("from_ct", &bone_from_ct, "ct"_a, py::kw_only(), "seed_mm"_a = py::none(), "labels"_a = "",
                  "label"_a = 1, "level"_a = "", "voxel_mm"_a = 0.25, "series"_a = "", "resample"_a = false,
                  "convention"_a = "automatic", "affine"_a = "automatic", "accept_warnings"_a = false, "cache"_a = "",
                  "progress"_a = py::none(),
                  R"(From a folder with a DICOM series, or a NIfTI file: reads, segments, fits and bakes.

seed_mm: a point in the body of the wanted vertebra; without it, the largest whole one.
labels: a label map (NIfTI or NRRD) that says which bone is meant, by the number `label` or by the name `level`.
convention: what the map's numbers mean, where it names no vertebrae, such as "verse"; without it an error where several
    are possible (docs/label-maps.md).
affine: "sform" or "qform", of a NIfTI CT or map whose two transforms differ (docs/reading.md).
cache: a folder for finished stages, which the next call takes from there.
accept_warnings: take a vertebra or a CT that is likely not right; see `warnings`.
progress: called as progress(stage, fraction). Ctrl-C cancels.
Raises Error on a CT that cannot be read, and without a vertebra.)")
      .def_static(
          "load",
          [](const std::filesystem::path& file, const std::string& level) {
            const Level its_level = level_named(level);
            const py::gil_scoped_release unlocked;
            return Bone::load(file, its_level);
          },
          "file"_a, "level"_a = "", "From a bone.vdb, or one level (\"L3\") of a spine.vdb.")
      .def("save", &Bone::save, "file"_a, py::call_guard<py::gil_scoped_release>(),
           "Writes a bone.vdb, whole or not at all.")
      .def_property_readonly("hash", &Bone::hash, "A fingerprint of its grids, however the file was written.")
      .def_property_readonly(
          "ct_hash", [](const Bone& bone) { return bone.identity().ct_hash; },
          "Of the CT that it was baked from, at whatever voxel size; of a bone without one its own. Plans name it.")
      .def_property_readonly(
          "level", [](const Bone& bone) { return level_name(bone.level()); }, "\"L3\" and the like; empty: not known.")
      .def_property_readonly("voxel_mm", [](const Bone& bone) { return bone.model().voxel_mm(); })
      .def_property_readonly(
          "band_mm", [](const Bone& bone) { return bone.model().band_mm(); },
          "Distances are clamped to it, on both sides of the surface.")
      .def_property_readonly(
          "bounds_mm",
          [](const Bone& bone) {
            const Box3 box = bone.model().bounds_mm();
            return array_of(std::vector<Vec3>{box.min(), box.max()});
          },
          "Its lowest and highest corner, (2, 3).")
      .def_property_readonly(
          "metadata", [](const Bone& bone) { return bone.model().metadata(); }, "What was baked and how, as text.")
      .def_property_readonly(
          "warnings",
          [](const Bone& bone) {
            std::vector<std::string> lines = bone.input_warnings();
            if (const std::optional<LevelWarnings> marked = bone.warnings()) {
              lines.insert(lines.end(), marked->warnings.begin(), marked->warnings.end());
            }
            return lines;
          },
          "What speaks against the files that it was made of, then against it, a line each; the latter are none where "
          "it was marked by hand.")
      .def(
          "distance",
          [](const Bone& bone, const Numbers& points_mm) {
            return at_points(points_mm, [&bone](const std::vector<Vec3>& points) { return bone.distance(points); });
          },
          "points_mm"_a, "To the surface, mm, negative inside, clamped to the band: (n,) float32.")
      .def(
          "hu",
          [](const Bone& bone, const Numbers& points_mm) {
            return at_points(points_mm, [&bone](const std::vector<Vec3>& points) { return bone.hu(points); });
          },
          "points_mm"_a, "CT numbers, HU: (n,) float32.")
      .def(
          "normals",
          [](const Bone& bone, const Numbers& points_mm) {
            return at_points(points_mm, [&bone](const std::vector<Vec3>& points) { return bone.normals(points); });
          },
          "points_mm"_a, "Unit, outward; zero further from the surface than the band: (n, 3).")
      .def(
          "surface",
          [](const Bone& bone) {
            TriangleMesh mesh = [&bone] {
              const py::gil_scoped_release unlocked;
              return bone.surface();
            }();
            return arrays_of(std::move(mesh));
          },
          "Vertices (n, 3), float32, mm, and triangles (m, 3), uint32, outward.")
      .def("view", &Bone::view, "camera"_a, py::call_guard<py::gil_scoped_release>(),
           "What a camera sees of it: depth, normals and a mask.")
      .def("landmarks", &landmarks_of, "progress"_a = py::none(),
           "Canal, body and pedicles, as dictionaries; positions in patient LPS, mm. Raises Error where it is no whole "
           "vertebra.")
      .def(
          "suggest",
          [](const Bone& bone, std::optional<double> margin_mm, const DrillBit& bit, bool bicortical,
             const std::string& sagittal, const std::string& technique, const py::object& progress) {
            AutoPlanOptions options;
            options.margin_mm = margin_mm;
            options.is_bicortical = bicortical;
            options.bit = bit;
            options.sagittal = named(sagittal_references(), sagittal, "a sagittal reference");
            if (!technique.empty()) options.technique = named(techniques(), technique, "a technique");
            return long_call(progress, [&](const Progress& heard) { return bone.suggest(options, heard); });
          },
          py::kw_only(), "margin_mm"_a = py::none(), "bit"_a = DrillBit{}, "bicortical"_a = false,
          "sagittal"_a = "anatomic", "technique"_a = "", "progress"_a = py::none(),
          "A screw and a path for each pedicle, with its grade. `margin_mm`: of bone around the screw, this and no "
          "less; "
          "None: that of the shipped rules, less in narrow pedicles. `sagittal`: \"anatomic\" or "
          "\"straight-forward\". `technique`: \"pedicle\", \"in-out-in\" or \"cortical\"; empty: what the vertebra "
          "needs. Raises Error without landmarks.")
      .def(
          "grade",
          [](const Bone& bone, const DrillPath& path, const py::object& progress) {
            return long_call(progress, [&](const Progress& heard) { return grade(bone, path, {}, {}, heard); });
          },
          "path"_a, "progress"_a = py::none(),
          "How safe a path is. Raises Error without landmarks, and on a path that names another CT or vertebra.")
      .def(
          "path_warnings",
          [](const Bone& bone, const DrillPath& path, bool from_front) {
            const py::gil_scoped_release unlocked;
            const PathCheck check = check_path_on_bone(bone, path, {.from_the_front = from_front});
            return check.fits() ? std::vector<std::string>() : std::vector{check.words(path)};
          },
          "path"_a, py::kw_only(), "from_front"_a = false,
          "Why a path does not fit the bone, with the likely cause: an entry more than 2 mm off its surface, ends that "
          "are swapped, RAS for LPS, another level; empty where it fits. from_front: it may come from there.");
}

}  // namespace spinaltap
