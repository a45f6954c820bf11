#include "core/files/study_spec_file.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/files/data_files.h"
#include "core/files/detail/placement_errors_json.h"
#include "core/files/detail/session_json.h"
#include "core/files/detail/study_json.h"
#include "core/files/detail/tool_json.h"
#include "core/files/material_file.h"
#include "core/files/placement_errors_file.h"
#include "core/files/plan_file.h"
#include "core/files/registration_file.h"
#include "core/files/thermal_bone_file.h"

namespace spinaltap {
namespace {

constexpr FileFormat kSpecFormat{"spinaltap-study", "study", "see docs/studies.md for the names of its keys"};

std::filesystem::path beside(const std::filesystem::path& file, const std::string& name) {
  constexpr std::size_t kMaxName = 500;  // messages repeat it
  const bool is_name =
      name.size() <= kMaxName && std::none_of(name.begin(), name.end(), [](unsigned char c) { return c < ' '; });
  if (!is_name) fail("expected the name of a file in ", file.string(), ", found ", in_quotes(name));
  return (file.parent_path() / name).lexically_normal();
}

/// "path" is a path as plan files list it, or the name of one in "plan".
DrillPath read_path_of(const JsonObject& object, const std::filesystem::path& file) {
  if (object.has("path") && object.at("path").is_object()) {
    if (object.has("plan"))
      fail("expected either \"plan\" or a \"path\" of its own in ", file.string(), ", found both");
    DrillPath path = read_path(object.at("path"), file);
    try {
      check_path(path);
    } catch (const Error& error) {
      fail(file.string(), ": \"path\": ", error.what());
    }
    return path;
  }
  const std::vector<DrillPath> paths = read_plan(beside(file, object.text("plan")));
  return choose_path(paths, object.has("path") ? object.text("path") : "");
}

Material read_material_of(const JsonObject& object, const std::filesystem::path& file) {
  const DensityCalibration density = read_density_calibration(
      object.has("density") ? beside(file, object.text("density")) : data_file("densities/vertebra.json"));
  return read_material(
      object.has("material") ? beside(file, object.text("material")) : data_file("materials/vertebra.json"),
      density.line);
}

void read_volume(const Json& json, const std::filesystem::path& file, StudySpec& spec) {
  check_keys(json, {"radius_mm", "spacing_mm", "lead_in_mm", "lead_out_mm"}, file, "a key of \"volume\"");
  const JsonObject object(json, file);
  PointVolumeOptions& volume = spec.volume;
  for (const auto& [key, value] : {std::pair{"radius_mm", &volume.radius_mm}, {"spacing_mm", &volume.spacing_mm}}) {
    if (!object.has(key)) continue;
    *value = object.number(key);
    if (!(*value > 0.0)) fail("expected a number above 0 for \"", key, "\" in ", file.string(), ", found ", *value);
  }
  for (const auto& [key, value] : {std::pair{"lead_in_mm", &volume.lead_in_mm}, {"lead_out_mm", &spec.lead_out_mm}}) {
    *value = object.number_or(key, *value);
    if (!(*value >= 0.0) || !(*value <= 100.0)) {
      fail("expected 0 to 100 for \"", key, "\" in ", file.string(), ", found ", *value);
    }
  }
}

Level read_level_of(const JsonObject& object, const std::filesystem::path& file) {
  if (!object.has("level")) return Level::kNone;
  const std::optional<Level> level = level_from_name(object.text("level"));
  if (!level) {
    fail("expected a vertebra such as \"L3\" for \"level\" in ", file.string(), ", found ",
         in_quotes(object.text("level")));
  }
  return *level;
}

/// One of "bones": a file's name, or {"bone", "level", "patient", "plan", "paths"}. Without a plan its paths are to be
/// suggested.
StudyBone read_bone_of(const Json& json, std::size_t place, const std::filesystem::path& file) {
  StudyBone bone;
  bone.patient = place;
  if (json.is_string()) {
    bone.file = beside(file, json.get<std::string>());
    return bone;
  }
  const JsonObject object(json, file);
  check_keys(json, {"bone", "level", "patient", "plan", "paths"}, file, "a key of one of \"bones\"");
  bone.file = beside(file, object.text("bone"));
  bone.level = read_level_of(object, file);
  if (object.has("patient")) bone.patient = checked_patient(object.whole_number("patient"), file);
  if (object.has("paths") && !object.has("plan")) fail("expected a \"plan\" for \"paths\" in ", file.string());
  if (!object.has("plan")) return bone;
  bone.paths = read_plan(beside(file, object.text("plan")));
  if (!object.has("paths")) return bone;
  const Json& names = object.at("paths");
  if (!names.is_array() || names.empty()) fail("expected a list of names for \"paths\" in ", file.string());
  std::vector<DrillPath> chosen;
  for (const Json& name : names) {
    if (!name.is_string()) fail("expected a list of names for \"paths\" in ", file.string());
    chosen.push_back(choose_path(bone.paths, name.get<std::string>()));
  }
  bone.paths = std::move(chosen);
  return bone;
}

/// "bones" and "plans", or one "bone" with its "level", and "plan" and "path".
std::vector<StudyBone> read_bones_of(const JsonObject& object, const std::filesystem::path& file) {
  if (!object.has("bones")) {
    if (object.has("plans")) fail("expected \"plans\" only beside \"bones\" in ", file.string());
    return {{beside(file, object.text("bone")), read_level_of(object, file), 0, {read_path_of(object, file)}}};
  }
  for (const char* other : {"bone", "level", "plan", "path"}) {
    if (object.has(other))
      fail("expected either \"bones\" or ", in_quotes(other), " in ", file.string(), ", found both");
  }
  const Json& list = object.at("bones");
  constexpr std::size_t kMostBones = 100'000;
  if (!list.is_array() || list.empty() || list.size() > kMostBones) {
    fail("expected a list of 1 to ", kMostBones, " bones for \"bones\" in ", file.string());
  }
  const bool is_auto = object.has("plans");
  if (is_auto && object.text("plans") != "auto") {
    fail("expected \"auto\" for \"plans\" in ", file.string(), ", found ", in_quotes(object.text("plans")),
         ": bones that have a plan of their own name it");
  }
  std::vector<StudyBone> bones;
  for (const Json& item : list) {
    bones.push_back(read_bone_of(item, bones.size(), file));
    if (bones.back().paths.empty() && !is_auto) {
      fail("expected a \"plan\" for each of \"bones\" in ", file.string(), ", or \"plans\": \"auto\", found ",
           bones.back().file.filename().string(), " without one");
    }
  }
  return bones;
}

/// A shipped model's name, a file's, "MM,DEG", or a model itself.
PlacementErrors read_errors_of(const Json& json, const std::filesystem::path& file) {
  if (json.is_object()) return placement_errors_in(json, file);
  if (!json.is_string()) fail("expected a model of errors for \"errors\" in ", file.string());
  const std::string name = json.get<std::string>();
  return name.ends_with(".json") ? read_placement_errors(beside(file, name)) : placement_errors_of(name);
}

/// {"file": a registration, "per": "run", "screw" or "patient"}.
StudyRegistration read_registration_of(const Json& json, const std::filesystem::path& file) {
  check_keys(json, {"file", "per"}, file, "a key of \"registration\"");
  const JsonObject object(json, file);
  const Registration registration = read_registration(beside(file, object.text("file")));
  return {registration.covariance, read_drawn_per(object, file), registration.bone};
}

StopRules read_stop(const Json& json, const std::filesystem::path& file) {
  check_keys(json, {"thrust_n", "clearance_mm", "on_breach"}, file, "a key of \"stop\"");
  const JsonObject object(json, file);
  StopRules stop;
  stop.thrust_n = object.number_or("thrust_n", stop.thrust_n);
  if (!(stop.thrust_n > 0.0)) {
    fail("expected a number above 0 for \"thrust_n\" in ", file.string(), ", found ", stop.thrust_n);
  }
  stop.clearance_mm = object.number_or("clearance_mm", stop.clearance_mm);
  if (object.has("on_breach")) stop.on_breach = object.flag("on_breach");
  return stop;
}

HeatOptions read_heat_of(const Json& json, const std::filesystem::path& file) {
  check_keys(json, {"thermal_bone", "irrigation", "distance_mm"}, file, "a key of \"heat\"");
  const JsonObject object(json, file);
  HeatOptions heat;
  heat.bone = object.has("thermal_bone") ? read_thermal_bone(beside(file, object.text("thermal_bone")))
                                         : shipped_thermal_bone();
  if (object.has("irrigation")) heat.is_irrigated = object.flag("irrigation");
  heat.distance_mm = object.number_or("distance_mm", heat.distance_mm);
  try {
    check_heat_options(heat);
  } catch (const Error& error) {
    fail(file.string(), ": \"heat\": ", error.what());
  }
  return heat;
}

/// A factor that the study does not know would change nothing without a word.
void check_factors(const StudySpec& spec, const std::filesystem::path& file) {
  for (const FactorDistribution& distribution : spec.design.distributions) {
    const StudyFactor factor = distribution.factor;
    if (applies(spec, factor)) continue;
    const bool is_of_errors = factor == StudyFactor::entry_error_scale ||
                              factor == StudyFactor::direction_error_scale || factor == StudyFactor::registration_scale;
    fail("expected no factor \"", name_of(factor), "\" in ", file.string(), ": ",
         is_of_errors                       ? "the study has no such errors"
         : spec.kind == StudyKind::geometry ? "the study drills nothing"
         : factor == StudyFactor::push_n    ? "the operator is one that feeds"
                                            : "the operator is one that pushes");
  }
}

}  // namespace

StudySpec read_study_spec(const std::filesystem::path& file) {
  const Json json = read_json(file);
  const JsonObject object(json, file);
  check_format(json, kSpecFormat, file);
  check_keys(json,
             {"format",       "version", "name",   "bone",        "level",  "plan",           "path",      "material",
              "density",      "volume",  "engine", "spindle_rpm", "stop",   "heat",           "operator",  "design",
              "registration", "kind",    "bones",  "plans",       "errors", "takes_other_ct", "from_front"},
             file, kStudyKey);
  StudySpec spec;
  spec.name = object.has("name") ? object.text("name") : file.stem().string();
  spec.kind = read_study_kind(object, file);
  spec.bones = read_bones_of(object, file);
  spec.material = read_material_of(object, file);
  if (object.has("volume")) read_volume(object.at("volume"), file, spec);
  if (object.has("engine")) spec.engine = read_engine(object, file);
  spec.options.spindle.rpm = object.number_or("spindle_rpm", spec.options.spindle.rpm);
  if (!(spec.options.spindle.rpm > 0.0)) {
    fail("expected a number above 0 for \"spindle_rpm\" in ", file.string(), ", found ", spec.options.spindle.rpm);
  }
  if (object.has("stop")) spec.options.stop = read_stop(object.at("stop"), file);
  if (object.has("heat")) spec.options.heat = read_heat_of(object.at("heat"), file);
  if (spec.kind == StudyKind::geometry) {
    for (const char* key : {"volume", "engine", "spindle_rpm", "stop", "heat", "operator"}) {
      if (object.has(key)) fail("expected no ", in_quotes(key), " in ", file.string(), ": the study drills nothing");
    }
  } else {
    spec.tool_operator = read_study_operator(object.at("operator"), file);
  }
  spec.design = read_study_design(object.at("design"), file, spec.material);
  if (object.has("errors")) spec.errors = read_errors_of(object.at("errors"), file);
  if (object.has("registration")) spec.registration = read_registration_of(object.at("registration"), file);
  if (object.has("takes_other_ct")) spec.takes_other_ct = object.flag("takes_other_ct");
  if (object.has("from_front")) spec.from_the_front = object.flag("from_front");
  check_factors(spec, file);
  return spec;
}

}  // namespace spinaltap
