#include <map>
#include <memory>
#include <optional>

#include "apps/spinaltap/command.h"
#include "apps/spinaltap/level_output.h"
#include "apps/spinaltap/plan_check.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/files/measured_points_file.h"
#include "core/files/registration_file.h"
#include "core/registration/register_fiducials.h"
#include "core/registration/register_surface.h"
#include "vdb/sim/bone.h"

namespace spinaltap {
namespace {

struct RegisterCommandOptions {
  std::filesystem::path bone, fiducials, patient, touched, start, output = "registration.json";
  Level level = Level::kNone;
  MeasuredFrame frame = MeasuredFrame::lps;
  FiducialOptions marks;
  TouchedOptions surface;
  double max_slide_mm = 1.0;
  double max_tre_mm = 2.0;
  PlanCheckOptions check;
};

Registration register_marks(const RegisterCommandOptions& options) {
  const PairedPoints pairs = pair_points(read_measured_points(options.fiducials, MeasuredFrame::lps),
                                         read_measured_points(options.patient, options.frame));
  FiducialOptions marks = options.marks;
  marks.max_slide_mm = options.max_slide_mm;
  return register_fiducials(pairs.first_mm, pairs.second_mm, marks);
}

Registration registration_of(const RegisterCommandOptions& options, const std::optional<Bone>& bone,
                             std::vector<std::string>& notes, const Progress& progress) {
  if (options.touched.empty()) {
    if (options.fiducials.empty())
      fail("register: expected --fiducials with --patient, or --surface-points, found neither");
    return register_marks(options);
  }
  if (!bone) fail("register: expected a bone for --surface-points, found none");
  TouchedOptions surface = options.surface;
  surface.max_slide_mm = options.max_slide_mm;
  if (!options.start.empty()) {
    const Registration start = read_registration(options.start);
    options.check.check_registration(options.start.filename().string(), start.bone, bone->identity(), notes);
    surface.start = start.ct_from_patient;
  }
  if (!options.fiducials.empty()) surface.start = register_marks(options).ct_from_patient;
  std::vector<Vec3> touched_mm;
  for (const MeasuredPoint& point : read_measured_points(options.touched, options.frame)) {
    touched_mm.push_back(point.p_mm);
  }
  return register_surface(bone->shape(progress), touched_mm, surface, progress);
}

/// What it means at a pedicle.
Json pedicle_figures(const std::string& name, const PedicleLandmarks& pedicle, const RegisterCommandOptions& options,
                     Registration& found) {
  const double error_mm = target_error_mm(found.covariance, pedicle.isthmus_mm);
  const auto along = [&](const Vec3& direction) {
    return target_error_along_mm(found.covariance, pedicle.isthmus_mm, direction);
  };
  const double axis_mm = along(pedicle.axis), width_mm = along(pedicle.width_axis),
               height_mm = along(pedicle.height_axis);
  print_figure("TRE at the " + name + " pedicle", error_mm, "mm");
  print_figure("  along its axis, width, height",
               fixed_text(axis_mm, 2) + ", " + fixed_text(width_mm, 2) + ", " + fixed_text(height_mm, 2) + " mm");
  if (!(error_mm <= options.max_tre_mm)) {
    found.warnings.push_back(joined("at the ", name, " pedicle an error of ", fixed_text(error_mm, 1),
                                    " mm is to be expected, over ", options.max_tre_mm, " mm"));
  }
  return {{"place", name + " pedicle"},
          {"tre_mm", error_mm},
          {"along_axis_mm", axis_mm},
          {"along_width_mm", width_mm},
          {"along_height_mm", height_mm}};
}

Json register_patient(const RegisterCommandOptions& options, const Progress& progress, int& exit_code) {
  std::optional<Bone> bone;
  if (!options.bone.empty()) bone = Bone::load(options.bone, options.level);
  std::vector<std::string> notes;
  Registration found = registration_of(options, bone, notes, progress);
  if (bone) found.bone = bone->identity();
  print_figure("registered by", name_of(found.kind));
  print_figure("points", joined(found.residuals_mm.size() - found.rejected.size(), " of ", found.residuals_mm.size()));
  const bool is_surface = found.kind == Registration::Kind::surface;
  print_figure(is_surface ? "residual, root mean square" : "FRE", found.residual_rms_mm, "mm");
  print_figure(found.noise_was_told ? "noise to each side, as told" : "noise to each side, from residuals",
               found.noise_mm, "mm");
  Json targets = Json::array();
  if (bone && bone->no_landmarks(progress).empty()) {
    const Landmarks& marks = bone->landmarks(progress);
    targets.push_back(pedicle_figures("left", marks.left_pedicle, options, found));
    targets.push_back(pedicle_figures("right", marks.right_pedicle, options, found));
  } else if (bone) {
    print_figure("TRE at the pedicles", "not known: " + bone->no_landmarks(progress));
  }
  StagedOutput output;
  write_registration(found, output.stage(options.output));
  output.commit();
  for (const std::string& note : notes) print_figure("note", note);
  for (const std::string& warning : found.warnings) print_figure("warning", warning);
  print_figure("registration", options.output.string());
  exit_code = found.warnings.empty() ? kDone : kAnswerIsNo;
  return {{"kind", name_of(found.kind)},
          {"residual_rms_mm", found.residual_rms_mm},
          {"noise_mm", found.noise_mm},
          {"rejected", found.rejected},
          {"targets", targets},
          {"warnings", found.warnings},
          {"notes", notes}};
}

struct PivotCommandOptions {
  std::filesystem::path poses, output = "pivot.json";
  PivotOptions pivot;
};

Json calibrate(const PivotCommandOptions& options, int& exit_code) {
  const PivotCalibration found = calibrate_pivot(read_tool_poses(options.poses), options.pivot);
  const auto in_mm = [](const Vec3& v) {
    return "(" + fixed_text(v.x(), 3) + ", " + fixed_text(v.y(), 3) + ", " + fixed_text(v.z(), 3) + ") mm";
  };
  print_figure("tip in the tool's frame", in_mm(found.tip_mm));
  print_figure("known to, each axis", in_mm(found.tip_covariance_mm2.diagonal().cwiseMax(0.0).cwiseSqrt()));
  print_figure("pivot in the tracker's frame", in_mm(found.pivot_mm));
  print_figure("residual, root mean square", found.residual_rms_mm, "mm", 3);
  print_figure("cone to each side", found.cone_deg, "degrees", 1);
  print_figure("condition", found.condition, "", 1);
  StagedOutput output;
  write_pivot(found, output.stage(options.output));
  output.commit();
  for (const std::string& warning : found.warnings) print_figure("warning", warning);
  print_figure("calibration", options.output.string());
  exit_code = found.warnings.empty() ? kDone : kAnswerIsNo;
  return {{"tip_mm", to_json(found.tip_mm)},
          {"pivot_mm", to_json(found.pivot_mm)},
          {"residual_rms_mm", found.residual_rms_mm},
          {"cone_deg", found.cone_deg},
          {"condition", found.condition},
          {"warnings", found.warnings}};
}

}  // namespace

void add_register(CLI::App& program, Command& command) {
  const auto options = std::make_shared<RegisterCommandOptions>();
  CLI::App* app = add_command(
      program, command, "register",
      "Find where the patient is, from marks or from points touched on the bone; writes a registration",
      "Example: spinaltap register bone.vdb --surface-points touched.csv --start rough.json --noise 0.3 -o "
      "registration.json\n"
      "Points: 3D Slicer's markups (.mrk.json, .fcsv), or CSV (x_mm,y_mm,z_mm). The exit code is 1, with all written,\n"
      "where the registration may be wrong: the warnings say why.");
  app->add_option("bone", options->bone, "bone.vdb or spine.vdb; for --surface-points, and for errors at its pedicles")
      ->type_name("BONE");
  add_level(*app, options->level);
  CLI::Option* fiducials =
      app->add_option("--fiducials", options->fiducials, "Marks in the CT: alone, or as a start for --surface-points")
          ->type_name("FILE");
  CLI::Option* patient =
      app->add_option("--patient", options->patient, "The same marks as measured on the patient")->type_name("FILE");
  fiducials->needs(patient);
  patient->needs(fiducials);
  app->add_option("--surface-points", options->touched, "Points touched on the bone's surface, as measured")
      ->type_name("FILE");
  app->add_option("--start", options->start, "An earlier registration, about right; default: both frames are one")
      ->excludes(fiducials)
      ->type_name("REGISTRATION");
  app->add_option("--frame", options->frame, "Axes of CSV files that were measured on the patient")
      ->transform(
          one_of(std::map<std::string, MeasuredFrame>{{"LPS", MeasuredFrame::lps}, {"RAS", MeasuredFrame::ras}}))
      ->default_str("LPS")
      ->type_name("NAME");
  app->add_option("--fle", options->marks.fle_mm, "How marks are located, root mean square, mm; 0: from the residuals")
      ->capture_default_str()
      ->type_name("MM");
  app->add_option("--noise", options->surface.noise_mm,
                  "Deviation of a touched point to each side, mm; 0: from the residuals")
      ->capture_default_str()
      ->type_name("MM");
  app->add_option("--search", options->surface.search_mm, "How far from the start touched points may lie, mm")
      ->capture_default_str()
      ->type_name("MM");
  app->add_option("--search-angle", options->surface.search_deg, "And how far they may be turned, degrees")
      ->capture_default_str()
      ->type_name("DEG");
  app->add_option("--max-slide", options->max_slide_mm, "Warn of motions of the points that may be larger, mm")
      ->capture_default_str()
      ->type_name("MM");
  app->add_option("--max-tre", options->max_tre_mm, "Warn of a larger error to expect at a pedicle, mm")
      ->capture_default_str()
      ->type_name("MM");
  options->check.add_other_ct(*app);
  app->add_option("-o,--output", options->output, "Where the registration is written")
      ->capture_default_str()
      ->type_name("FILE");
  command.run = [options, &command](const Progress& progress) {
    return register_patient(*options, progress, command.exit_code);
  };
}

void add_pivot(CLI::App& program, Command& command) {
  const auto options = std::make_shared<PivotCommandOptions>();
  CLI::App* app =
      add_command(program, command, "pivot", "Find a tracked tool's tip, from poses while it stood still in a dimple",
                  "Example: spinaltap pivot poses.csv -o pivot.json\n"
                  "A line a pose: x, y, z (mm), qw, qx, qy, qz; or the 12 or 16 numbers of a matrix. The\n"
                  "exit code is 1, with all written, where the tip may be wrong: the warnings say why.");
  app->add_option("poses", options->poses, "Poses of the tool in the tracker's frame, CSV")
      ->required()
      ->type_name("FILE");
  app->add_option("--min-cone", options->pivot.min_cone_deg, "Reject poses that turn less to each side, degrees")
      ->capture_default_str()
      ->type_name("DEG");
  app->add_option("--max-error", options->pivot.max_tip_mm, "Warn of a tip that is known worse, mm")
      ->capture_default_str()
      ->type_name("MM");
  app->add_option("-o,--output", options->output, "Where the calibration is written")
      ->capture_default_str()
      ->type_name("FILE");
  command.run = [options, &command](const Progress&) { return calibrate(*options, command.exit_code); };
}

}  // namespace spinaltap
