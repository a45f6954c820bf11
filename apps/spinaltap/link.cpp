#include <CLI/CLI.hpp>

#include <array>
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "apps/link/link_exchange.h"
#include "apps/link/linked_session.h"
#include "apps/report/session_report.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/drill_options.h"
#include "apps/spinaltap/level_output.h"
#include "apps/spinaltap/link_figures.h"
#include "apps/spinaltap/plan_check.h"
#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/base/text_writer.h"
#include "core/files/data_files.h"
#include "core/files/material_file.h"
#include "core/files/plan_file.h"
#include "core/files/registration_file.h"
#include "core/tool/tool_speed.h"

namespace spinaltap {
namespace {

struct LinkCommandOptions {
  std::filesystem::path bone;
  Level level = Level::kNone;
  std::filesystem::path plan;
  std::string path_name;
  std::filesystem::path density, material, registration;
  SessionSetup setup;
  std::string region;
  bool leaves_clearances = false;
  int port = 18944;
  bool accepts_nobody = false;
  std::string connect;
  std::vector<double> tip_mm{0.0, 0.0, 0.0}, axis{0.0, 0.0, 1.0};
  LinkedOptions linked;
  PlanCheckOptions check;
};

void add_link_options(CLI::App& app, LinkCommandOptions& options) {
  LinkServerOptions& server = options.linked.server;
  TrackingOptions& tracking = options.linked.loop.tracking;
  app.add_option("--port", options.port, "Port to listen at; 0: any that is free, which is printed")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str()
      ->type_name("PORT");
  app.add_option("--bind", server.bind_address,
                 "Address to listen at; 0.0.0.0: all of this machine's. Who may connect may steer the drill")
      ->capture_default_str()
      ->type_name("ADDRESS");
  app.add_flag("--no-server", options.accepts_nobody, "With --connect: let nobody connect");
  app.add_option("--connect", options.connect,
                 "Also connect to this server, of a tracker for example, and again when it comes back")
      ->type_name("HOST:PORT");
  app.add_option("--tool-name", server.names.tool, "Device whose TRANSFORM moves the bit")
      ->capture_default_str()
      ->type_name("NAME");
  app.add_option("--reference-name", server.names.reference, "Device of the body that is fixed to the patient")
      ->capture_default_str()
      ->type_name("NAME");
  app.add_option("--patient-name", server.names.patient, "Device of the registration: the reference in the CT, RAS")
      ->capture_default_str()
      ->type_name("NAME");
  app.add_option("--command-name", server.names.command, "Device of the STRINGs that are commands")
      ->capture_default_str()
      ->type_name("NAME");
  app.add_option("--bit-name", server.names.bit, "Device of the bit's TRANSFORM that is sent")
      ->capture_default_str()
      ->type_name("NAME");
  app.add_option("--bone-name", server.names.bone, "Device of the bone's POLYDATA that is sent")
      ->capture_default_str()
      ->type_name("NAME");
  app.add_flag("--wait-for-reference", tracking.needs_reference, "Drill nothing before the reference has come");
  app.add_flag("--wait-for-patient", tracking.needs_patient, "Drill nothing before the registration has come");
  CLI::Option* registration =
      app.add_option("--registration", options.registration,
                     "Where the patient is, of `register`, until a TRANSFORM of it comes: of points measured in the "
                     "reference's frame")
          ->type_name("REGISTRATION");
  app.add_flag("--tracked-patient", tracking.is_patient_tracked,
               "The patient's TRANSFORM goes stale as the others do; without it it holds until the next");
  app.get_option("--tracked-patient")->excludes(registration);
  app.add_option("--tool-tip", options.tip_mm, "The bit's tip in the tracked tool's own frame, mm")
      ->delimiter(',')
      ->expected(3)
      ->capture_default_str()
      ->type_name("X,Y,Z");
  app.add_option("--tool-axis", options.axis, "Which way the bit points there, from its base to its tip")
      ->delimiter(',')
      ->expected(3)
      ->capture_default_str()
      ->type_name("X,Y,Z");
  app.add_option("--max-pose-age", tracking.stale_s,
                 "A pose older than this does not count; what lies between is not cut, s")
      ->capture_default_str()
      ->type_name("S");
  app.add_option("--rate", options.linked.loop.rate_hz, "Poses a second that are expected, Hz; at most twice as many")
      ->capture_default_str()
      ->type_name("HZ");
  app.add_option("--state-rate", server.state_rate_hz, "STRINGs with the state a second, Hz; 0: none")
      ->capture_default_str()
      ->type_name("HZ");
  app.add_option("--send-bone", options.linked.mesh.kind,
                 "How the bone is sent: whole (default), as one model, again each second while it changes; blocks: "
                 "one each, and again those that changed; none")
      ->transform(one_of(std::map<std::string, LinkMeshKind>{
          {"whole", LinkMeshKind::whole}, {"blocks", LinkMeshKind::blocks}, {"none", LinkMeshKind::none}}))
      ->type_name("NAME");
  app.add_option("--bone-rate", options.linked.mesh.rate_hz, "Updates of the bone a second, Hz")
      ->capture_default_str()
      ->type_name("HZ");
  app.add_option("--seconds", options.linked.loop.longest_s, "How long at most, s")
      ->capture_default_str()
      ->type_name("S");
  app.add_option("--record", options.linked.record, "Write every cycle into this HDF5 file; see `replay`")
      ->type_name("FILE");
}

void add_bone_options(CLI::App& app, LinkCommandOptions& options) {
  app.add_option("--density", options.density,
                 "Density calibration: a line, or measured pairs; default: the shipped densities/vertebra.json")
      ->type_name("FILE");
  app.add_option("--material", options.material, "Cutting model; default: the shipped materials/vertebra.json")
      ->type_name("FILE");
  app.add_option("--spacing", options.setup.volume.spacing_mm, "Distance between voxels or points, mm")
      ->capture_default_str()
      ->type_name("MM");
  app.add_option("--region", options.region, "Fill voxels only this near the path, mm; default: the whole bone")
      ->type_name("MM");
  app.add_option("--engine", options.setup.engine,
                 "Drilling engine: voxel (default), for any way of the tool; or ring, leaf, arc, reference: of points "
                 "in a cylinder around the path")
      ->transform(one_of(engine_kinds()))
      ->type_name("NAME");
  app.add_option("--radius", options.setup.volume.radius_mm, "Of that cylinder, mm")
      ->capture_default_str()
      ->type_name("MM");
  app.add_option("--spindle", options.setup.options.spindle.rpm, "Speed of the spindle, rpm")
      ->capture_default_str()
      ->type_name("RPM");
  add_stop_rules(app, options.setup.options.stop);
  app.add_flag("--no-clearances", options.leaves_clearances,
               "Do not look for the bone's walls: begins sooner; no breaches");
}

/// What a registration leaves open, where it matters.
Json tell_registration(const Registration& registration, const DrillPath& path) {
  const double entry_mm = target_error_mm(registration.covariance, path.entry_mm);
  const double target_mm = target_error_mm(registration.covariance, path.target_mm);
  print_figure("registration's error at the entry", entry_mm, "mm", 2);
  print_figure("registration's error at the target", target_mm, "mm", 2);
  for (const std::string& warning : registration.warnings) print_figure("warning", warning);
  return {{"error_at_entry_mm", entry_mm}, {"error_at_target_mm", target_mm}, {"warnings", registration.warnings}};
}

Json link(LinkCommandOptions& options, bool is_forced, int& exit_code, const Progress& progress) {
  LinkServerOptions& server = options.linked.server;
  if (!options.connect.empty()) set_server_to_connect(options.connect, server);
  if (options.accepts_nobody && options.connect.empty()) fail("expected --connect with --no-server");
  server.port = static_cast<std::uint16_t>(options.port);
  if (options.accepts_nobody) server.bind_address.clear();
  options.linked.loop.tracking.frame = tool_frame(Vec3(options.tip_mm[0], options.tip_mm[1], options.tip_mm[2]),
                                                  Vec3(options.axis[0], options.axis[1], options.axis[2]));
  options.linked.may_replace_record = is_forced;
  std::optional<Registration> registration;
  if (!options.registration.empty()) {
    registration = read_registration(options.registration);
    options.linked.loop.tracking.registration = registration->ct_from_patient;
  }
  SessionSetup& setup = options.setup;
  if (options.leaves_clearances && (setup.options.stop.on_breach || setup.options.stop.clearance_mm > -1e300)) {
    fail("expected clearances with --stop-at-clearance and --stop-on-breach: leave --no-clearances away");
  }
  const std::vector<DrillPath> paths = read_plan(options.plan);
  setup.path = choose_path(paths, options.path_name);
  setup.has_clearances = !options.leaves_clearances;
  if (!options.region.empty()) {
    const std::optional<double> margin_mm = parse_number(options.region);
    if (!margin_mm) fail("expected --region as a distance from the path, mm; found ", in_quotes(options.region));
    if (setup.engine != EngineKind::voxel) fail("expected --engine voxel with --region");
    setup.region_mm = region_around(setup.path, setup.volume.lead_in_mm, *margin_mm);
  }
  const DensityCalibration density =
      read_density_calibration(options.density.empty() ? data_file("densities/vertebra.json") : options.density);
  setup.material =
      read_material(options.material.empty() ? data_file("materials/vertebra.json") : options.material, density.line);
  const Json told = registration ? tell_registration(*registration, setup.path) : Json();
  const Bone bone = Bone::load(options.bone, options.level);
  PlanFindings findings = check_plan(bone, {&setup.path, 1}, options.check);
  if (registration) {
    options.check.check_registration(options.registration.filename().string(), registration->bone, bone.identity(),
                                     findings.notes);
  }
  const std::vector<std::string> speeds = speed_warnings(setup.path.bit, {}, setup.options.spindle.rpm);
  findings.warnings.insert(findings.warnings.end(), speeds.begin(), speeds.end());
  setup.takes_other_ct = options.check.takes_other_ct;
  exit_code = say_findings(findings, options.check.accepts_warnings);  // before anybody connects
  options.linked.ready = [&](std::uint16_t port) {
    if (port != 0) std::printf("listening at %s, port %d\n", server.bind_address.c_str(), static_cast<int>(port));
    if (!server.connect_host.empty()) {
      std::printf("connecting to %s, port %d\n", server.connect_host.c_str(), static_cast<int>(server.connect_port));
    }
    std::fflush(stdout);  // whoever started it waits for the port
  };
  const LinkedSession linked = drill_linked(bone, setup, options.linked, progress);
  print_linked(linked);
  if (!linked.record_trouble.empty()) fail(linked.record_trouble);
  Json figures = linked_json(linked);
  add_findings(bone, findings, figures);
  if (registration) figures["registration"] = told;
  return figures;
}

}  // namespace

void add_link(CLI::App& program, Command& command) {
  const auto options = std::make_shared<LinkCommandOptions>();
  set_linked_defaults(options->setup);
  CLI::App* app = add_command(
      program, command, "link", "Drill with a tracked tool or a robot over OpenIGTLink, against the clock",
      "Examples: spinaltap link bone.vdb plan.json --stop-at-clearance 1 --record run.h5\n"
      "          spinaltap link bone.vdb plan.json --connect tracker:18944 --tool-name DrillToTracker\n"
      "          spinaltap link bone.vdb plan.json --bind 0.0.0.0 --send-bone blocks --seconds 60\n"
      "Takes TRANSFORMs and commands, sends the bit, the state, events, the bone, the plan and when to stop. All\n"
      "places on the link are RAS, mm, as 3D Slicer has them. Nothing of the CT but the bone's shape goes out.");
  app->add_option("bone", options->bone, "bone.vdb or spine.vdb")->required()->type_name("FILE");
  add_level(*app, options->level);
  app->add_option("plan", options->plan, "plan.json")->required()->type_name("FILE");
  app->add_option("--path", options->path_name, "Name of the path in the plan; default: the first")->type_name("NAME");
  add_link_options(*app, *options);
  add_bone_options(*app, *options);
  options->check.add_other_ct(*app);
  options->check.add_from_front(*app);
  options->check.add_accept_warnings(*app);
  command.outputs = [options] { return std::vector{options->linked.record}; };
  command.run = [options, &command](const Progress& progress) {
    return link(*options, command.is_forced, command.exit_code, progress);
  };
}

}  // namespace spinaltap
