#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/long_call.h"
#include "apps/python/names.h"
#include "apps/python/one_at_a_time.h"
#include "apps/python/planned_operator.h"
#include "core/files/material_file.h"
#include "core/files/thermal_bone_file.h"
#include "core/session/operator/force_controlled.h"
#include "core/session/operator/path_motion.h"
#include "vdb/sim/session.h"

namespace py = pybind11;
using namespace py::literals;

namespace spinaltap {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class MotionPlan final : public PlannedOperator {
 public:
  MotionPlan(const DrillPath& path, const PathMotionOptions& options)
      : path_(path), options_(options), motion_(path, options) {}

  std::unique_ptr<Operator> begin(const Spindle&) const override {
    return std::make_unique<PlannedMotion>(path_, options_);
  }
  const PathMotion& motion() const { return motion_; }

 private:
  DrillPath path_;
  PathMotionOptions options_;
  PathMotion motion_;
};

class ForcePlan final : public PlannedOperator {
 public:
  ForcePlan(const DrillPath& path, const ForceControlOptions& options) : path_(path), options_(options) {
    const ForceControlled checked(path, options);
  }
  std::unique_ptr<Operator> begin(const Spindle& spindle) const override {
    ForceControlOptions options = options_;
    options.spindle = spindle;
    return std::make_unique<ForceControlled>(path_, options);
  }

 private:
  DrillPath path_;
  ForceControlOptions options_;
};

/// Tips and axes, (n, 6).
py::array_t<double> poses_of(const MotionPlan& planned) {
  const PathMotion& motion = planned.motion();
  const std::size_t count = motion.cycle_count() + 1;
  py::array_t<double> array({count, std::size_t{6}});
  double* to = array.mutable_data();
  for (std::size_t n = 0; n < count; ++n) {
    const Pose pose = motion.pose(n);
    for (int k = 0; k < 3; ++k) *to++ = pose.tip_mm[k];
    for (int k = 0; k < 3; ++k) *to++ = pose.axis[k];
  }
  return array;
}

using OwnedSession = OneAtATime<Session>;

Material material_of(const std::filesystem::path& material, const std::filesystem::path& density) {
  Material model;
  if (!density.empty()) model.density = read_density_calibration(density).line;
  return material.empty() ? model : read_material(material, model.density);
}

std::unique_ptr<OwnedSession> make_session(const Bone& bone, const std::optional<DrillPath>& path,
                                           const std::optional<DrillBit>& bit, double radius_mm, double spacing_mm,
                                           double lead_in_mm, double fine_spacing_mm, const std::string& engine,
                                           const std::optional<Numbers>& region_mm, double rpm, bool clearances,
                                           double stop_thrust_n, double stop_clearance_mm, bool stop_on_breach,
                                           const std::filesystem::path& material, const std::filesystem::path& density,
                                           const std::vector<Bone>& also, bool follows_path, bool heat, bool irrigation,
                                           const std::filesystem::path& thermal_bone, bool other_ct,
                                           const py::object& progress) {
  SessionSetup setup;
  setup.takes_other_ct = other_ct;
  setup.material = material_of(material, density);
  setup.volume.radius_mm = radius_mm;
  setup.volume.spacing_mm = spacing_mm;
  setup.volume.lead_in_mm = lead_in_mm;
  setup.fine_spacing_mm = fine_spacing_mm;
  setup.engine = named(engine_kinds(), engine, "an engine");
  if (region_mm) {
    const std::vector<Vec3> corners = points_of(*region_mm);
    if (corners.size() != 2) fail("expected two corners of region_mm, (2, 3), found ", corners.size());
    setup.region_mm = Box3(corners[0], corners[1]);
  }
  setup.options.spindle.rpm = rpm;
  setup.options.stop = {stop_thrust_n, stop_clearance_mm, stop_on_breach};
  setup.options.follows_path = follows_path;
  setup.has_clearances = clearances;
  if (!heat && (irrigation || !thermal_bone.empty())) fail("expected heat=True with irrigation and thermal_bone");
  if (heat) {
    setup.options.heat.emplace();
    setup.options.heat->bone = thermal_bone.empty() ? shipped_thermal_bone() : read_thermal_bone(thermal_bone);
    setup.options.heat->is_irrigated = irrigation;
  }
  std::vector<Bone> bones{bone};
  bones.insert(bones.end(), also.begin(), also.end());
  if (path && bit) fail("expected the tool of the path, found another besides; set_tool() changes it");
  if (bit) setup.path.bit = *bit;
  return std::make_unique<OwnedSession>(long_call(progress, [&](const Progress& heard) {
    return path ? Session(bones, *path, setup, heard) : Session(bones, setup, heard);
  }));
}

py::array run_poses(OwnedSession& self, const Numbers& tips, const py::object& axes, const py::object& dt_s,
                    const py::object& spindle_on, const py::object& sides, const py::object& progress) {
  const std::vector<ToolInput> inputs = inputs_of(tips, axes, dt_s, spindle_on, sides);
  const OwnedSession::Turn session = self.take();
  // A thread takes some 50 µs to begin; so few cycles are done sooner than anyone presses Ctrl-C.
  constexpr std::size_t kFew = 512;
  if (inputs.size() <= kFew && progress.is_none()) {
    std::vector<RecordedCycle> rows = [&] {
      const py::gil_scoped_release unlocked;
      return session->run(inputs);
    }();
    return array_of(std::move(rows));
  }
  return array_of(long_call(progress, [&](const Progress& heard) { return session->run(inputs, heard); }));
}

py::array run_operator(OwnedSession& self, const PlannedOperator& planned, const py::object& progress) {
  const OwnedSession::Turn session = self.take();
  return array_of(long_call(progress, [&](const Progress& heard) {
    std::vector<RecordedCycle> rows;
    const std::unique_ptr<Operator> tool = planned.begin(session->setup().options.spindle);
    session->run(
        *tool, [&rows](const Cycle& cycle) { rows.push_back(recorded(cycle)); }, heard);
    return rows;
  }));
}

/// What a renderer keeps of a block: its buffers show the block's own memory.
py::tuple block_of(const SurfaceUpdate& update) {
  const py::tuple block = py::make_tuple(update.block[0], update.block[1], update.block[2]);
  if (!update.surface) return py::make_tuple(block, py::none());
  using Held = std::shared_ptr<const SurfaceBlock>;
  const py::capsule owner(new Held(update.surface), [](void* held) { delete static_cast<Held*>(held); });
  const auto show = [&owner](const auto* data, std::size_t rows, const py::dtype& type) {
    py::array array(type, {rows, std::size_t{3}}, {}, data, owner);
    array.attr("setflags")("write"_a = false);
    return array;
  };
  const SurfaceBlock& surface = *update.surface;
  return py::make_tuple(
      block,
      py::dict("vertices_mm"_a = show(surface.vertices_mm.data(), surface.vertices_mm.size(), py::dtype::of<float>()),
               "normals"_a = show(surface.normals.data(), surface.normals.size(), py::dtype::of<float>()),
               "triangles"_a = show(surface.triangles.data(), surface.triangles.size(), py::dtype::of<std::uint16_t>()),
               "wall_begin"_a = surface.wall_begin));
}

void bind_cycle(py::module_& module) {
  py::class_<Cycle>(module, "Cycle", "What one cycle was and did. Forces are what the operator feels, patient LPS.")
      .def_readonly("index", &Cycle::index)
      .def_readonly("time_s", &Cycle::time_s)
      .def_property_readonly("tip_mm", [](const Cycle& cycle) { return array_of(cycle.input.pose.tip_mm); })
      .def_property_readonly("axis", [](const Cycle& cycle) { return array_of(cycle.input.pose.axis); })
      .def_property_readonly(
          "side", [](const Cycle& cycle) { return array_of(cycle.input.pose.side); },
          "Of a plate, as it was given; zeros: not said.")
      .def_readonly("depth_mm", &Cycle::depth_mm, "Of the tip along the path: 0 at the entry.")
      .def_property_readonly("force_n", [](const Cycle& cycle) { return array_of(cycle.force.force_n); })
      .def_property_readonly("thrust_n", [](const Cycle& cycle) { return cycle.force.thrust_n; })
      .def_property_readonly("torque_n_mm", [](const Cycle& cycle) { return cycle.force.torque_n_mm; })
      .def_property_readonly(
          "p05_thrust_n", [](const Cycle& cycle) { return cycle.force.thrust_band_n.low; },
          "5 % of the thrust, as sources differ; then 95 %, and the torque's.")
      .def_property_readonly("p95_thrust_n", [](const Cycle& cycle) { return cycle.force.thrust_band_n.high; })
      .def_property_readonly("p05_torque_n_mm", [](const Cycle& cycle) { return cycle.force.torque_band_n_mm.low; })
      .def_property_readonly("p95_torque_n_mm", [](const Cycle& cycle) { return cycle.force.torque_band_n_mm.high; })
      .def_property_readonly("lateral_n", [](const Cycle& cycle) { return array_of(cycle.force.lateral_n); })
      .def_property_readonly("contact_n", [](const Cycle& cycle) { return array_of(cycle.force.contact_n); })
      .def_property_readonly("density_g_cm3", [](const Cycle& cycle) { return cycle.force.tip_density_g_cm3; })
      .def_property_readonly(
          "temperature_c", [](const Cycle& cycle) { return cycle.heat.temperature_c; },
          "Of the hottest bone beside the hole now; nan where the session works out no heat.")
      .def_property_readonly(
          "max_temperature_c", [](const Cycle& cycle) { return cycle.heat.max_temperature_c; }, "The same, so far.")
      .def_property_readonly(
          "max_temperature_depth_mm", [](const Cycle& cycle) { return cycle.heat.max_depth_mm; },
          "Where that was, along the path: 0 at the entry.")
      .def_property_readonly(
          "bone_w", [](const Cycle& cycle) { return cycle.heat.bone_w; }, "Heat that the bone gets of the cutting, W.")
      .def_property_readonly("clearance_outer_mm", [](const Cycle& cycle) { return cycle.clearance.outer_mm; })
      .def_property_readonly("clearance_canal_mm", [](const Cycle& cycle) { return cycle.clearance.canal_mm; })
      .def_property_readonly(
          "removed_points", [](const Cycle& cycle) { return cycle.step.removed; },
          "Points that died; with the engine \"voxel\" voxels.")
      .def_property_readonly("removed_mm3", [](const Cycle& cycle) { return cycle.step.removed_mm3; })
      .def_property_readonly(
          "state", [](const Cycle& cycle) { return std::string(name_of(cycle.state)); }, "One of STATES.");
}

void bind_operators(py::module_& module) {
  const py::class_<PlannedOperator> any_operator(module, "Operator", "What moves the tool; Session.drill() takes it.");
  py::class_<MotionPlan, PlannedOperator>(
      module, "PlannedMotion", "Goes its planned way, whatever it feels: beside the path or tilted, with a tremor.")
      .def(py::init([](const DrillPath& path, double feed_mm_s, double rate_hz, double lead_in_mm, double offset_mm,
                       double tilt_deg, double tremor_mm, std::uint64_t seed, double peck_every_mm, double peck_pause_s,
                       double withdraw_mm_s) {
             PathMotionOptions options{.line = {lead_in_mm, offset_mm, tilt_deg}, .rate_hz = rate_hz};
             options.feed.steps = {{0.0, feed_mm_s}};
             options.feed.pecking.every_mm = peck_every_mm;
             options.feed.pecking.pause_s = peck_pause_s;
             options.feed.withdraw_mm_s = withdraw_mm_s;
             options.tremor_mm = tremor_mm;
             options.seed = seed;
             return std::make_unique<MotionPlan>(path, options);
           }),
           "path"_a, py::kw_only(), "feed_mm_s"_a = 1.0, "rate_hz"_a = 1000.0, "lead_in_mm"_a = 3.0,
           "offset_mm"_a = 0.0, "tilt_deg"_a = 0.0, "tremor_mm"_a = 0.0, "seed"_a = 1, "peck_every_mm"_a = 0.0,
           "peck_pause_s"_a = 0.0, "withdraw_mm_s"_a = 0.0, "Raises Error on values out of range.")
      .def("poses", &poses_of, "Tips and axes, (n, 6), as Session.run() takes them.")
      .def_property_readonly(
          "dt_s", [](const MotionPlan& planned) { return 1.0 / planned.motion().rate_hz(); },
          "From one pose to the next.");
  py::class_<ForcePlan, PlannedOperator>(
      module, "ForceControlled", "Pushes along the path: how fast it goes follows from the bone, and it plunges.")
      .def(py::init([](const DrillPath& path, double push_n, double rate_hz, double lead_in_mm, double offset_mm,
                       double tilt_deg, double reaction_s, double noticed_share, double tremor_mm, std::uint64_t seed) {
             ForceControlOptions options;
             options.line = {lead_in_mm, offset_mm, tilt_deg};
             options.rate_hz = rate_hz;
             options.push_n = push_n;
             options.reaction_s = reaction_s;
             options.noticed_share = noticed_share;
             options.tremor_mm = tremor_mm;
             options.seed = seed;
             return std::make_unique<ForcePlan>(path, options);
           }),
           "path"_a, py::kw_only(), "push_n"_a = 40.0, "rate_hz"_a = 1000.0, "lead_in_mm"_a = 3.0, "offset_mm"_a = 0.0,
           "tilt_deg"_a = 0.0, "reaction_s"_a = 0.2, "noticed_share"_a = 0.2, "tremor_mm"_a = 0.0, "seed"_a = 1,
           "reaction_s: until it lets go of what it notices; noticed_share: of the push, below which the bone's "
           "resistance is taken for a breakthrough; 0: never. Raises Error on values out of range.");
}

}  // namespace

void bind_session(py::module_& module) {
  bind_cycle(module);
  bind_operators(module);
  py::class_<OwnedSession>(module, "Session",
                           R"(A bone being drilled along a path, cycle by cycle. One thread at a time.

The drilling of one hole is one session: it begins at time 0 and cycle 0; end_hole() begins the next.)")
      .def(py::init(&make_session), "bone"_a, "path"_a = py::none(), py::kw_only(), "bit"_a = py::none(),
           "radius_mm"_a = 3.0, "spacing_mm"_a = 0.1, "lead_in_mm"_a = 3.0, "fine_spacing_mm"_a = 0.0,
           "engine"_a = "auto", "region_mm"_a = py::none(), "rpm"_a = 1250.0, "clearances"_a = true,
           "stop_thrust_n"_a = kInfinity, "stop_clearance_mm"_a = -kInfinity, "stop_on_breach"_a = false,
           "material"_a = "", "density"_a = "", "also"_a = std::vector<Bone>(), "follows_path"_a = true,
           "heat"_a = false, "irrigation"_a = false, "thermal_bone"_a = "", "other_ct"_a = false,
           "progress"_a = py::none(),
           R"(path: None for any tool anywhere, in voxels: then `bit` is the tool, Bit() where none is said, depths are
those of its tip below the bone's surface, and clearances the canal's alone. radius_mm, spacing_mm, lead_in_mm: of the cylinder of points around the path; fine_spacing_mm: near the
surface and the target, 0: the same. engine: "ring", "leaf", "arc" or "reference", with the same results; "voxel", for
any tool and way: voxels of the whole bone, spacing_mm apart, in place of the points; or "auto": "voxel" of a plate or where
there is a region, else a fast one of points. region_mm: voxels only in this box, its two corners, (2, 3), patient LPS, as
Bone.bounds_mm has them; an event tells where the tool leaves it. rpm: of the spindle; 0: off.
clearances: look for the walls, which takes seconds the first time. stop_...: when is_stopped becomes true. material,
density: files of cutting models and density calibrations; the shipped ones by default. also: further bones of the same
patient, which are drilled wherever the tool meets them; voxels only. follows_path: False of a milling, whose way leaves
the path: neither states nor breakthroughs nor plunges are told, and "auto" takes voxels. heat: work out how warm the bone beside the hole gets, live;
irrigation: with water along its wall; thermal_bone: a file of how bone takes up heat; the shipped one by default. other_ct: take a path that names another CT or
vertebra, which the record says. Raises Error where the path misses the bone, or names another.)")
      .def(
          "step",
          [](OwnedSession& self, const Numbers& tip_mm, const Numbers& axis, double dt_s, bool spindle_on,
             const std::optional<Numbers>& side) {
            const Vec3 turned = side ? vec3_of(*side, "side") : Vec3(Vec3::Zero());
            const ToolInput input{{vec3_of(tip_mm, "tip_mm"), vec3_of(axis, "axis"), turned}, spindle_on, dt_s};
            return Cycle(self.take()->step_input(input));
          },
          "tip_mm"_a, "axis"_a, "dt_s"_a = 0.001, "spindle_on"_a = true, py::kw_only(), "side"_a = py::none(),
          "One cycle: the bit goes straight from where it was to here. `axis`: unit, from the base to the tip. `side`: "
          "of a plate, unit, across the axis, along its width; None: by its width_along. Poses "
          "that make no sense do nothing but leave an event. Keeps Python's lock: it takes microseconds.")
      .def("run", &run_poses, "tips_mm"_a, "axes"_a = py::none(), "dt_s"_a = 0.001, "spindle_on"_a = true,
           py::kw_only(), "sides"_a = py::none(), "progress"_a = py::none(),
           R"(Many cycles, as fast as it goes, whatever the stop rules say. Gives a row for each, of dtype CYCLE.

tips_mm: (n, 3), with axes (n, 3) or one for all; or tips and axes together, (n, 6). dt_s, spindle_on: one, or (n,).
sides: of a plate, along its width, (n, 3) or one for all; None: by its width_along.
Ctrl-C cancels; the cycles until then are done.)")
      .def("drill", &run_operator, "operator"_a, "progress"_a = py::none(),
           "An operator until it ends. Gives a row for each cycle, of dtype CYCLE. Ctrl-C cancels.")
      .def(
          "set_tool", [](OwnedSession& self, const DrillBit& bit) { self.take()->set_tool(bit); }, "bit"_a,
          py::call_guard<py::gil_scoped_release>(),
          "Another tool from the next cycle on, which has come from nowhere: a pedal changes a burr. A record takes "
          "it. "
          "Raises Error with heat, and of a plate where there are points.")
      .def_property_readonly(
          "tool", [](OwnedSession& self) { return self.take()->tool(); }, "In use.")
      .def_property_readonly(
          "chosen", [](OwnedSession& self) { return self.take()->chosen(); },
          "What it drills, and why: \"voxels of 0.1 mm of the whole bone, for no path\".")
      .def_property_readonly(
          "motion_off_mm", [](OwnedSession& self) { return self.take()->motion_off_mm(); },
          "By how much a hole of more than 294,912 cycles may be off what the tool did; 0 of shorter ones.")
      .def_property_readonly(
          "last", [](OwnedSession& self) { return Cycle(self.take()->last()); }, "Before the first cycle, zeros.")
      .def_property_readonly(
          "events",
          [](OwnedSession& self) {
            const auto session = self.take();
            return array_of(std::vector<SessionEvent>(session->events().begin(), session->events().end()));
          },
          "In the order in which they began, of dtype EVENT; `kind` counts through EVENT_KINDS.")
      .def_property_readonly("is_stopped", [](OwnedSession& self) { return self.take()->is_stopped(); })
      .def(
          "record",
          [](OwnedSession& self, const std::filesystem::path& file, const std::optional<std::array<int, 2>>& frames,
             bool frame_normals) {
            RecordOptions options;
            if (frames) options.frames = FrameFormat{(*frames)[0], (*frames)[1], frame_normals};
            self.take()->record(file, options);
          },
          "file"_a, py::kw_only(), "frames"_a = py::none(), "frame_normals"_a = true,
          "From here on each cycle goes to a record, an HDF5 file. `frames`: width and height of what record_view() "
          "adds. Raises Error after the first cycle, and where the file is there already.")
      .def(
          "view", [](OwnedSession& self, const Camera& camera) { return self.take()->view(camera); }, "camera"_a,
          py::call_guard<py::gil_scoped_release>(), "What a camera sees of the remaining bone, and of the bit.")
      .def(
          "record_view", [](OwnedSession& self, const Camera& camera) { return self.take()->record_view(camera); },
          "camera"_a, py::call_guard<py::gil_scoped_release>(),
          "The same, and puts it into the record, beside the last cycle. Raises Error where no record takes frames of "
          "this size.")
      .def(
          "end_record", [](OwnedSession& self) { self.take()->end_record(); }, py::call_guard<py::gil_scoped_release>(),
          "Writes what is left, and marks the record as whole.")
      .def(
          "end_hole", [](OwnedSession& self) { self.take()->end_hole(); }, py::call_guard<py::gil_scoped_release>(),
          "What is drilled from here on is another hole. Ends a record.")
      .def(
          "undo", [](OwnedSession& self) { return self.take()->undo(); }, py::call_guard<py::gil_scoped_release>(),
          "The bone as before the last hole, or as before what was drilled of this one; False where nothing was. "
          "Raises "
          "Error while a record runs.")
      .def(
          "surface_changes",
          [](OwnedSession& self, std::size_t bone) {
            const std::vector<SurfaceUpdate> changes = [&self, bone] {
              const py::gil_scoped_release unlocked;
              return self.take()->surface_changes(bone);
            }();
            py::list blocks;
            for (const SurfaceUpdate& update : changes) blocks.append(block_of(update));
            return blocks;
          },
          "bone"_a = 0,
          R"(Blocks of the remaining bone's surface that changed since the last call; the first time all of them. Of
several bones `bone` says which; each has blocks of its own.

A list of (block, surface): three whole numbers, and None where no surface is left, or a dictionary of vertices_mm,
normals (n, 3) float32 and triangles (m, 3) uint16, from row wall_begin on of drilled walls. Arrays show the block's own
memory, which never changes.)")
      .def(
          "drilled", [](OwnedSession& self) { return self.take()->drilled(); },
          py::call_guard<py::gil_scoped_release>(), "The bone without all holes; of several the first.")
      .def(
          "drilled_bones", [](OwnedSession& self) { return self.take()->drilled_bones(); },
          py::call_guard<py::gil_scoped_release>(), "All of them without all holes: the first, then those of `also`.")
      .def_property_readonly("bone", [](OwnedSession& self) { return self.take()->bone(); })
      .def_property_readonly("path", [](OwnedSession& self) { return self.take()->path(); })
      .def_property_readonly(
          "engine", [](OwnedSession& self) { return name_of(self.take()->setup().engine); },
          "Its name: what \"auto\" came to, too.");
}

}  // namespace spinaltap
