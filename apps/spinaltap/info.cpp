#include <algorithm>
#include <memory>
#include <numbers>

#include "apps/report/contact_sheet.h"
#include "apps/report/png.h"
#include "apps/report/slice_frame.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/ct_options.h"
#include "apps/spinaltap/input_warnings.h"
#include "apps/spinaltap/level_output.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/base/text_writer.h"
#include "core/ct/dicom_read.h"
#include "core/segment/bone_levels.h"
#include "core/session/record/session_record.h"
#include "vdb/grid/spine_file.h"

namespace spinaltap {
namespace {

std::string triple(const Vec3& v, const char* unit) {
  TextWriter text;
  text << v.x() << ", " << v.y() << ", " << v.z() << ' ' << unit;
  return text.str();
}

/// Lists of places are as long as a page: --json has all of it.
std::string in_a_line(const std::string& value) {
  constexpr std::size_t kMost = 100, kBegin = 60;
  if (value.size() <= kMost) return value;
  return joined(value.substr(0, kBegin), " ... (", value.size(), " characters, all in --json)");
}

/// But for warnings and severity.
Json info_of_grids(const BoneModel& bone) {
  const Box3 bounds_mm = bone.bounds_mm();
  print_figure("grid voxels", static_cast<double>(bone.active_voxels()), "", 0);
  print_figure("voxel", bone.voxel_mm(), "mm", 3);
  print_figure("from", triple(bounds_mm.min(), "mm"));
  print_figure("to", triple(bounds_mm.max(), "mm"));
  Json metadata = Json::object();
  for (const auto& [key, value] : bone.metadata()) {
    if (key != "warnings" && key != "severity" && key != "input_warnings") print_figure(key, in_a_line(value));
    metadata[key] = value;
  }
  Json json{{"active_voxels", bone.active_voxels()},
            {"voxel_mm", bone.voxel_mm()},
            {"low_mm", to_json(bounds_mm.min())},
            {"high_mm", to_json(bounds_mm.max())},
            {"metadata", metadata}};
  report_input_warnings(bone, json);
  return json;
}

Json info_of_bone(const BoneModel& bone) {
  Json json = info_of_grids(bone);
  if (const std::optional<LevelWarnings> warnings = warnings_in(bone.metadata())) {
    print_warnings(*warnings);
    json["warnings"] = warnings->warnings;
    json["severity"] = warnings->severity;
  }
  return json;
}

Json info_of_level(const SpineBone& one) {
  print_figure("level", level_name(one.level));
  Json json = info_of_grids(one.bone);
  json["level"] = level_name(one.level);
  json["warnings"] = one.notes.warnings;
  json["severity"] = one.notes.severity;
  print_warnings({one.notes.warnings, one.notes.severity});
  if (!one.notes.landmarks.empty()) {
    const Json landmarks = Json::parse(one.notes.landmarks, nullptr, false);
    if (landmarks.is_discarded()) fail("expected JSON as the landmarks of ", level_name(one.level));
    json["landmarks"] = landmarks;
  }
  if (!one.notes.no_landmarks.empty()) {
    print_figure("no landmarks", one.notes.no_landmarks);
    json["no_landmarks"] = one.notes.no_landmarks;
  }
  return json;
}

/// A bone.vdb, or one level of a spine.vdb, or all of them, one at a time.
Json info_of_vdb(const std::filesystem::path& file, Level level) {
  const std::vector<Level> levels = levels_in(file);
  if (levels.empty()) return info_of_bone(read_bone(file, level));
  if (level != Level::kNone) return info_of_level(read_spine_level(file, level));
  Json list = Json::array();
  print_figure("levels", level_names(levels));
  for (const Level each : levels) list.push_back(info_of_level(read_spine_level(file, each)));
  return {{"levels", list}};
}

Json info_of_record(const std::filesystem::path& file) {
  const SessionRecord record = read_record(file);
  const double seconds = record.cycles.empty() ? 0.0 : record.cycles.back().time_s;
  print_figure("record", record.is_whole ? "whole" : "being written, or cut short");
  print_figure("cycles", static_cast<double>(record.cycles.size()), "", 0);
  print_figure("time", seconds, "s", 3);
  if (record.lost > 0) print_figure("cycles lost", static_cast<double>(record.lost), "", 0);
  Json events = Json::array();
  for (const SessionEvent& event : record.events) {
    TextWriter text;
    text << event.time_s << " s, depth " << event.depth_mm << " mm, value " << event.value;
    print_figure(std::string(name_of(event.kind)), text.str());
    events.push_back({{"kind", name_of(event.kind)},
                      {"cycle", event.cycle},
                      {"time_s", event.time_s},
                      {"depth_mm", event.depth_mm},
                      {"place_mm", to_json(event.place_mm)},
                      {"value", event.value}});
  }
  for (const auto& [key, value] : record.setup) print_figure(key, value);
  return {{"is_whole", record.is_whole},
          {"cycles", record.cycles.size()},
          {"seconds", seconds},
          {"lost", record.lost},
          {"events", events},
          {"setup", record.setup}};
}

Json info_of_ct(const CtVolume& ct) {
  const GridGeometry& geometry = ct.geometry;
  const auto [lowest, highest] = std::minmax_element(ct.hu.begin(), ct.hu.end());
  TextWriter size;
  size << geometry.size[0] << " x " << geometry.size[1] << " x " << geometry.size[2];
  const Vec3 far_corner(geometry.size[0] - 1, geometry.size[1] - 1, geometry.size[2] - 1);
  const std::string plane = plane_name(geometry.directions.col(2));
  print_figure("voxels", size.str());
  print_figure("slices", plane);
  print_figure("voxel step", triple(geometry.spacing_mm, "mm"));
  print_figure("first voxel", triple(geometry.origin_mm, "mm"));
  print_figure("last voxel", triple(geometry.to_patient(far_corner), "mm"));
  for (int axis = 0; axis < 3; ++axis) {
    print_figure(std::string("direction of ") + "ijk"[axis], triple(geometry.directions.col(axis), ""));
  }
  const double noise_hu = estimate_noise_hu(ct);
  print_figure("lowest CT number", *lowest, "HU", 0);
  print_figure("highest CT number", *highest, "HU", 0);
  print_figure("noise in soft tissue, about", noise_hu, "HU", 0);
  print_figure("hash", ct.source_hash);
  return {{"size", geometry.size},
          {"plane", plane},
          {"spacing_mm", to_json(geometry.spacing_mm)},
          {"origin_mm", to_json(geometry.origin_mm)},
          {"direction_i", to_json(geometry.directions.col(0))},
          {"direction_j", to_json(geometry.directions.col(1))},
          {"direction_k", to_json(geometry.directions.col(2))},
          {"lowest_hu", *lowest},
          {"highest_hu", *highest},
          {"noise_hu", noise_hu},
          {"hash", ct.source_hash}};
}

/// One series of a folder, from its headers alone.
Json info_of_series(const SeriesInfo& series) {
  const std::string name = "series " + std::to_string(series.number);
  TextWriter text;
  text << series.modality << ", " << series.slices << " slices of " << series.columns << " x " << series.rows << " in "
       << series.files.size() << (series.files.size() == 1 ? " file" : " files") << ", UID "
       << (series.uid.empty() ? "none" : series.uid);
  print_figure(name, text.str());
  print_figure("  stored as", series.transfer_syntax);
  if (!series.told_apart_by.empty()) {
    print_figure("  stack", std::to_string(series.stack) + " of " + std::to_string(series.stacks) +
                                " of this series, told apart by " + series.told_apart_by);
  }
  Json json{{"number", series.number},
            {"modality", series.modality},
            {"files", series.files.size()},
            {"slices", series.slices},
            {"columns", series.columns},
            {"rows", series.rows},
            {"transfer_syntax", series.transfer_syntax},
            {"stack", series.stack},
            {"stacks", series.stacks},
            {"told_apart_by", series.told_apart_by},
            {"notes", series.notes},
            {"input_warnings", series.warnings}};
  if (!series.layout) {
    print_figure("  slices", "without a place in space, or only one");
    return json;
  }
  const StackLayout& layout = *series.layout;
  const std::string plane = plane_name(layout.directions.col(2));
  const double tilt_deg = layout.tilt_rad * 180.0 / std::numbers::pi;
  TextWriter step;
  step << layout.min_step_mm << " mm";
  if (layout.max_step_mm > layout.min_step_mm) step << " to " << layout.max_step_mm << " mm";
  print_figure("  slices", plane + ", columns grow to " + orientation_letters(layout.directions.col(0)) + ", rows to " +
                               orientation_letters(layout.directions.col(1)));
  print_figure("  slice step", step.str());
  print_figure("  gantry tilt", tilt_deg, "degrees", 1);
  json["plane"] = plane;
  json["min_step_mm"] = layout.min_step_mm;
  json["max_step_mm"] = layout.max_step_mm;
  json["tilt_deg"] = tilt_deg;
  return json;
}

void write_contact_sheet(const CtVolume& ct, const std::filesystem::path& file) {
  StagedOutput output;
  output.write(file, encode_png(contact_sheet(ct)));
  output.commit();
  print_figure("written", file.string());
}

}  // namespace

void add_info(CLI::App& program, Command& command) {
  struct Options {
    CtOptions ct;
    Level level = Level::kNone;
    std::filesystem::path contact_sheet;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* app = add_command(program, command, "info", "Show what a CT, a bone.vdb or a recorded drilling holds",
                              "Example: spinaltap info ct/ --contact-sheet ct.png --json ct.json");
  app->add_option(
         "path", options->ct.folder,
         "Folder with DICOM files, a NIfTI, NRRD or MetaImage file, a bone.vdb or spine.vdb, or a record (.h5)")
      ->required()
      ->type_name("PATH");
  add_level(*app, options->level);
  app->add_option("--contact-sheet", options->contact_sheet,
                  "Write up to 20 slices of the CT, evenly chosen, as one PNG picture at a bone window")
      ->type_name("FILE");
  options->ct.add_reading(*app);
  app->add_flag("--accept-warnings", options->ct.finding.accepts_warnings,
                "Exit with 0 also where a CT is doubtful; without it the exit code is then 1");

  command.run = [options, &command](const Progress& progress) -> Json {
    const std::filesystem::path& path = options->ct.folder;
    if (path.extension() == ".vdb") {
      if (!options->contact_sheet.empty()) fail("expected a CT for a contact sheet, found ", path.string());
      return info_of_vdb(path, options->level);
    }
    if (path.extension() == ".h5" || path.extension() == ".hdf5") {
      if (!options->contact_sheet.empty()) fail("expected a CT for a contact sheet, found ", path.string());
      return info_of_record(path);
    }
    Json figures = Json::object();
    // Of several series, only the chosen one is read. A contact sheet needs one: reading then says which there are.
    bool is_one = true;
    if (!is_one_volume(path)) {
      check_ct_file(path);
      const std::vector<SeriesInfo> series = list_dicom_series(path, progress);
      Json list = Json::array();
      for (const SeriesInfo& one : series) list.push_back(info_of_series(one));
      figures["series"] = list;
      figures["passed_over"] = series.front().passed_over;
      is_one = series.size() == 1 || !options->ct.reading.series.empty() || options->ct.reading.stack != 0 ||
               !options->contact_sheet.empty();
      if (!is_one && !series.front().passed_over.empty()) print_figure("note", series.front().passed_over);
    }
    if (!is_one) return figures;
    const CtVolume ct = options->ct.read(progress);
    figures["ct"] = info_of_ct(ct);
    figures["notes"] = ct.notes;
    report_input_warnings(ct.warnings, figures);
    command.exit_code = say_input_warnings(ct.warnings, options->ct.finding.accepts_warnings);
    if (!options->contact_sheet.empty()) write_contact_sheet(ct, options->contact_sheet);
    return figures;
  };
}

}  // namespace spinaltap
