#include "apps/spinaltap/drill_options.h"

#include <map>
#include <sstream>
#include <vector>

#include "apps/spinaltap/command.h"
#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/engine/drill_engine.h"
#include "core/session/choose_engine.h"

namespace spinaltap {
namespace {

/// A distance, or the six numbers of two corners.
std::vector<double> region_numbers(const std::string& text) {
  std::vector<double> numbers;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::optional<double> number = parse_number(part);
    if (!number) {
      numbers.clear();
      break;
    }
    numbers.push_back(*number);
  }
  if (numbers.size() != 1 && numbers.size() != 6) {
    fail("expected --region as a distance from the path, or as X0,Y0,Z0,X1,Y1,Z1, in mm; found \"", text, "\"");
  }
  return numbers;
}

}  // namespace

void add_straight_motion(CLI::App& app, OperatorChoice& tool_operator) {
  app.add_option("--step", tool_operator.step_mm, "Advance a cycle, mm; default: 0.001")->type_name("MM");
  app.add_option("--offset", tool_operator.offset_mm, "Sideways shift of the bit from the path, mm; default: 0")
      ->type_name("MM");
  app.add_option("--tilt", tool_operator.tilt_deg, "Angle between bit and path, degrees; default: 0")->type_name("DEG");
}

void add_operator(CLI::App& app, OperatorChoice& tool_operator) {
  app.add_option(
         "--operator", tool_operator.name,
         "Who moves the bit: on-path (default), off-path (by 1.2 mm), tilted (by 3 degrees), tremor (of 0.1 mm, "
         "8 to 12 Hz), push (with a force: feed follows from the bone), a file of poses, FILE.csv, or a milling, "
         "FILE.json")
      ->type_name("NAME");
  app.add_option("--feed", tool_operator.feed,
                 "Feed, mm/s; default: 1. Or by depth: 1,5:0.5 is 1, and 0.5 from 5 mm on")
      ->type_name("MM_S");
  app.add_option("--rate", tool_operator.rate_hz,
                 "Poses a second, Hz; in real time also collision cycles; default: 1000")
      ->type_name("HZ");
  app.add_option("--tremor", tool_operator.tremor_mm,
                 "Amplitude of the operator's tremor, mm; default: 0, of the operator tremor 0.1")
      ->type_name("MM");
  app.add_option("--peck", tool_operator.peck_mm, "Draw back by 2 mm each so many mm of depth; default: never")
      ->type_name("MM");
  app.add_option("--peck-pause", tool_operator.peck_pause_s,
                 "With --peck: wait so long each time, drawn back, s; default: 0")
      ->type_name("S");
  app.add_option("--withdraw", tool_operator.withdraw_mm_s, "Draw back to the start at the end, mm/s; default: stay")
      ->type_name("MM_S");
  app.add_option("--push", tool_operator.push_n, "With --operator push: force along the path, N; default: 40")
      ->type_name("N");
  app.add_option("--max-push", tool_operator.max_push_n,
                 "With --operator push: what it leans on the drill with at most where the bit stands, N; default: 200")
      ->type_name("N");
  app.add_option("--seed", tool_operator.seed, "Seed of the tremor; default: 1")->type_name("N");
}

namespace {

void add_device(CLI::App& app, OperatorChoice& tool_operator) {
  app.add_option("--device", tool_operator.device,
                 "A hand moves the bit, at a device: a plug-in, FILE.so, or a simulated one, loopback; "
                 "button 1 is the spindle, button 2 ends it")
      ->type_name("FILE.so[:SETTINGS]");
  app.add_option("--force-scale", tool_operator.force_scale,
                 "With --device: how much of the bone's force it gives; default: 0.1")
      ->type_name("SHARE");
}

}  // namespace

void add_stop_rules(CLI::App& app, StopRules& stop) {
  app.add_option("--stop-at-thrust", stop.thrust_n, "Ask the operator to stop at this thrust, N; default: never")
      ->type_name("N");
  app.add_option("--stop-at-clearance", stop.clearance_mm,
                 "Ask it to stop at this clearance of the bit to the outer surface or the canal, mm; default: never")
      ->type_name("MM");
  app.add_flag("--stop-on-breach", stop.on_breach,
               "Ask it to stop where the bit breaks through either wall; the exit code is then 1");
}

void DrillOptions::add_to(CLI::App& app) {
  app.add_option("--density", density,
                 "Density calibration: a line, or measured pairs; default: the shipped densities/vertebra.json")
      ->type_name("FILE");
  app.add_option("--material", material, "Cutting model; default: the shipped materials/vertebra.json")
      ->type_name("FILE");
  PointVolumeOptions& volume = setup.volume;
  app.add_option("--radius", volume.radius_mm, "Radius of the point volume, mm")
      ->capture_default_str()
      ->type_name("MM");
  app.add_option("--spacing", volume.spacing_mm, "Distance between points, mm")->capture_default_str()->type_name("MM");
  app.add_option("--fine-spacing", setup.fine_spacing_mm,
                 "Distance between points near the bone's surface and the target, mm; 0: the same everywhere")
      ->capture_default_str()
      ->type_name("MM");
  app.add_option("--fine-near", setup.fine_near_mm, "How far along the path from the surface points are fine, mm")
      ->capture_default_str()
      ->type_name("MM");
  app.add_option("--fine-tip", setup.fine_tip_mm, "How far before the target points are fine, mm")
      ->capture_default_str()
      ->type_name("MM");
  app.add_option("--hu-bits", volume.hu_bits, "Bits for a point's CT number: 8 (steps of 16 HU) or 16 (default)")
      ->transform(one_of(std::map<std::string, HuBits>{{"8", HuBits::eight}, {"16", HuBits::sixteen}}))
      ->type_name("BITS");
  app.add_option("--subdivision", volume.subdivision, "How discs are divided: rings (default) or hexagons")
      ->transform(one_of(std::map<std::string, DiscSubdivision>{{"rings", DiscSubdivision::rings},
                                                                {"hexagons", DiscSubdivision::hexagons}}))
      ->type_name("NAME");
  app.add_option("--jitter", volume.jitter, "Random displacement of points, share of the spacing, 0 to 0.5")
      ->capture_default_str()
      ->type_name("SHARE");
  app.add_option("--jitter-seed", volume.jitter_seed, "Seed of the jitter")->capture_default_str()->type_name("N");
  app.add_option("--rbf", field,
                 "A surface that `fit` wrote: decides exactly which points are bone, in place of the grid; slower")
      ->type_name("FILE");
  app.add_option(
         "--engine", setup.engine,
         "Drilling engine: ring, leaf, arc, reference: the same result; or voxel: the whole bone's voxels, --spacing "
         "apart, for any tool and way. Default: auto: ring or leaf, whichever is faster; voxel for a milling, a "
         "device, a plate or a --region")
      ->transform(one_of(engine_kinds()))
      ->type_name("NAME");
  app.add_option("--region", region,
                 "Fill voxels only this near the path, mm, or only in this box, patient LPS, mm; default: the whole "
                 "bone. An event tells where the tool leaves it")
      ->type_name("MM|X0,Y0,Z0,X1,Y1,Z1");
  app.add_flag("--full-mesh", writes_full_mesh,
               "Write surfaces with triangles of a voxel's size, not display meshes within 0.05 mm of them");
  app.add_flag("--no-pictures", leaves_pictures,
               "Leave the report's shaded pictures out: drawing them takes seconds, whatever is drilled");
  app.add_flag("--points", writes_points, "Also write the points left as points.vdb, for Houdini, Blender, ParaView");
  app.add_flag(
      "--splats", writes_splats,
      "Also write the points that show as splats.ply, and the bone's surface around their cylinder as around.ply");
  app.add_flag("--voxels", writes_voxels,
               "Also write the voxels left as voxels.nii.gz, a label map for 3D Slicer and ParaView");
  app.add_option("--lead-in", volume.lead_in_mm, "How far before the entry the drilling starts, mm")
      ->capture_default_str()
      ->type_name("MM");
  add_straight_motion(app, tool_operator);
  app.add_option("--log-step", log_step_mm, "Depth for one row of log.csv, mm")->capture_default_str()->type_name("MM");
  app.add_option("--spindle", setup.options.spindle.rpm, "Speed of the spindle, rpm; 0: off, the bit only touches")
      ->capture_default_str()
      ->type_name("RPM");
}

void DrillOptions::add_session_to(CLI::App& app) {
  add_operator(app, tool_operator);
  add_device(app, tool_operator);
  add_stop_rules(app, setup.options.stop);
  ComplianceOptions& compliance = setup.options.compliance;
  app.add_flag("--compliant", compliance.is_on,
               "The bit bends, and its tip walks on a slope before it bites: it goes where it really would");
  app.add_option("--free-length", compliance.free_length_mm,
                 "With --compliant: of the bit out of its chuck, mm; default: all of its length")
      ->type_name("MM");
  app.add_option("--stall-torque", compliance.stall_n_mm,
                 "With --compliant: torque at which the motor stands, N mm; default: its speed is steady")
      ->type_name("N_MM");
  app.add_flag("--no-clearances", leaves_clearances, "Do not look for the bone's walls: begins sooner; no breaches");
  app.add_flag(
      "--heat", has_heat,
      "Work out how warm the bone beside the hole gets while it is drilled: in the log, the report, the record");
  app.add_flag("--heat-grid", solves_heat,
               "With --heat: solve it on a grid around the hole too, after the drilling; writes heat.vdb. See `heat`");
  heat.add_to(app);
  app.add_option("--heat-limit", heat_limit_c, "With --heat: an event tells where bone gets hotter, °C; default: 47")
      ->type_name("C");
  app.add_option("--record", record, "Write every cycle into this HDF5 file; see `replay`")->type_name("FILE");
  app.add_flag("--real-time", is_real_time,
               "By the clock, with threads for operator, collisions and display; prints their latencies");
  app.add_option("--seconds", seconds, "With --real-time or --device: how long at most, s; default: 600")
      ->type_name("S");
  app.add_option("--output-rate", output_rate_hz,
                 "With --real-time: extrapolate forces at this rate for a device, Hz; default: not")
      ->type_name("HZ");
}

void DrillOptions::check(const DrillBit& tool) const {
  tool_operator.check(is_real_time);
  if (!is_real_time && ((seconds && !tool_operator.has_device()) || output_rate_hz)) {
    fail("expected --real-time with --seconds and --output-rate: without it drilling goes as fast as it goes");
  }
  if (tool_operator.has_device() && output_rate_hz) {
    fail("expected no --output-rate with --device: the device gets a force of its own each cycle");
  }
  if (!has_heat && (solves_heat || heat.is_given() || heat_limit_c)) {
    fail("expected --heat with --heat-grid, --irrigation, --thermal-bone and --heat-limit");
  }
  if (has_heat && tool_operator.is_milling())
    fail("expected no --heat with a milling: only a hole along the path has it");
  if (has_heat && tool.is_plate()) fail("expected no --heat with a plate: it drills no hole");
  if (has_heat && bones > 1) fail("expected no --heat with --additional-bone: heat is solved in one bone");
  const ComplianceOptions& compliance = setup.options.compliance;
  if (!compliance.is_on && (compliance.free_length_mm > 0.0 || compliance.stall_n_mm > 0.0)) {
    fail("expected --compliant with --free-length and --stall-torque");
  }
  if (leaves_clearances && (setup.options.stop.on_breach || setup.options.stop.clearance_mm > -1e300)) {
    fail("expected clearances with --stop-at-clearance and --stop-on-breach: leave --no-clearances away");
  }
  if (tool_operator.is_milling() && (setup.options.stop.on_breach || setup.options.stop.clearance_mm > -1e300)) {
    fail("expected no --stop-at-clearance and no --stop-on-breach with a milling: it takes the walls away");
  }
  SessionSetup session = setup;
  session.path.bit = tool;
  const auto check_for_voxels = [&](const char* with) {
    if (setup.engine == EngineKind::automatic || setup.engine == EngineKind::voxel) return;
    fail("expected no --engine ", name_of(setup.engine), " with ", with);
  };
  if (!region.empty()) {
    region_numbers(region);
    session.region_mm.emplace();
    check_for_voxels("--region: only voxels can fill one");
  }
  if (bones > 1) {
    session.further_bone_hashes.resize(bones - 1);
    check_for_voxels("--additional-bone: only voxels can fill several bones");
  }
  if (tool.is_plate()) check_for_voxels("a plate: only voxels can be cut by one");
  if (tool_operator.has_device()) check_for_voxels("--device: a hand leaves the cylinder that points fill");
  const bool drills_voxels = chosen_engine(session, tool_operator.motion_class()) == EngineKind::voxel;
  if (writes_voxels && !drills_voxels) {
    fail("expected voxels with --voxels: a milling, a device, a plate, a --region, several bones, or --engine voxel");
  }
  if (drills_voxels && (writes_points || writes_splats || !field.empty())) {
    fail(
        "expected an engine of points with --points, --splats and --rbf, found voxels: a milling, "
        "a device, a plate, a --region, several bones, or --engine voxel");
  }
  if (!record.empty() && !field.empty()) {
    fail("expected --record without --rbf: a record does not hold the fitted surface, so it could not be replayed");
  }
}

std::optional<Box3> DrillOptions::region_mm(const DrillPath& path) const {
  if (region.empty()) return std::nullopt;
  const std::vector<double> numbers = region_numbers(region);
  if (numbers.size() == 1) return region_around(path, setup.volume.lead_in_mm, numbers.front());
  const Box3 box(Vec3(numbers[0], numbers[1], numbers[2]), Vec3(numbers[3], numbers[4], numbers[5]));
  check_region(box);
  return box;
}

std::optional<RealTimeOptions> DrillOptions::real_time(const OperatorPlan& plan) const {
  if (!is_real_time) return std::nullopt;
  RealTimeOptions options;
  options.rate_hz = plan.cycle_rate_hz;
  options.tool_rate_hz = plan.rate_hz;
  options.output_rate_hz = output_rate_hz.value_or(0.0);
  options.longest_s = seconds.value_or(options.longest_s);
  options.wants_priority = true;
  return options;
}

}  // namespace spinaltap
