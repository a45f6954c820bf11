#include <algorithm>
#include <array>
#include <memory>
#include <span>

#include "apps/report/contact_sheet.h"
#include "apps/report/levels_picture.h"
#include "apps/report/png.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/ct_options.h"
#include "apps/spinaltap/input_warnings.h"
#include "apps/spinaltap/level_output.h"
#include "apps/spinaltap/stage_times.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/ct/dicom_source.h"
#include "core/ct/label_map.h"
#include "vdb/sim/label_warnings.h"

namespace spinaltap {
namespace {

struct SegmentCommandOptions {
  CtOptions ct;
  int label = 1;        ///< of the map that is read
  int write_label = 0;  ///< 0: the level's number, or 1
  bool is_all = false;
  std::filesystem::path output;
  std::filesystem::path picture;
  bool hides_ct = false;

  /// What a DICOM object names of its CT; nothing for other formats.
  DicomSource source(const CtVolume& ct, const Progress& progress) const {
    if (hides_ct || !is_dicom_label_name(output_or_default())) return {};
    return find_dicom_source(this->ct.folder, this->ct.reading.series, this->ct.reading.stack, ct.geometry, progress);
  }
  std::filesystem::path output_or_default() const {
    if (!output.empty()) return output;
    return is_all ? "spine.seg.nrrd" : "vertebra.seg.nrrd";
  }
};

void add_options(CLI::App& app, SegmentCommandOptions& options) {
  app.add_option("ct", options.ct.folder, "Folder with a DICOM CT series, or a NIfTI, NRRD or MetaImage file")
      ->required()
      ->type_name("PATH");
  app.add_option("-o,--output", options.output,
                 "The label map to write: .nii.gz, .nii, .nrrd, .seg.nrrd, .dcm (DICOM SEG) or .rtstruct.dcm (DICOM "
                 "RTSTRUCT); default: vertebra.seg.nrrd, or spine.seg.nrrd with --all")
      ->type_name("FILE");
  CLI::Option* all = app.add_flag("--all", options.is_all, "All vertebrae, with the sacrum and ribs that were seen");
  options.ct.add_reading(app);
  CLI::Option* labels = app.add_option("--labels", options.ct.labels,
                                       "Take the bone from this label map instead: NIfTI, NRRD, MetaImage, "
                                       "DICOM SEG or RTSTRUCT")
                            ->type_name("FILE");
  app.add_option("--label", options.label, "Which label of that map is the bone")
      ->needs(labels)
      ->excludes(all)
      ->type_name("N");
  add_convention(app, options.ct.convention, labels);
  options.ct.finding.add_to(app, labels);
  app.add_flag("--no-ct-references", options.hides_ct,
               "DICOM SEG and RTSTRUCT: do not name the CT's study, frame of reference and images by their UIDs");
  app.add_option("--write-label", options.write_label,
                 "The value that the vertebra gets in the map; default: 1 to 24 for C1 to L5, 28 for T13, or 1")
      ->check(CLI::Range(1, 32767))
      ->excludes(all)
      ->type_name("N");
  app.add_option("--picture", options.picture, "Write slices with the outlines and the warnings, as PNG")
      ->type_name("FILE");
}

/// The mean of a label's voxels, patient LPS, mm.
Vec3 middle_of(const LabelVolume& map, int label) {
  Vec3 sum = Vec3::Zero();
  double count = 0.0;
  std::size_t at = 0;
  for (int k = 0; k < map.geometry.size[2]; ++k) {
    for (int j = 0; j < map.geometry.size[1]; ++j) {
      for (int i = 0; i < map.geometry.size[0]; ++i) {
        if (map.labels[at++] != label) continue;
        sum += Vec3(i, j, k);
        count += 1.0;
      }
    }
  }
  return map.geometry.to_patient(sum / count);
}

/// The middle of a body may lie beyond the CT: slices go through the nearest voxels of the vertebra then.
Vec3 in_box_of(const LabelVolume& map, int label, const Vec3& p_mm) {
  Box3 box;
  std::size_t at = 0;
  for (int k = 0; k < map.geometry.size[2]; ++k) {
    for (int j = 0; j < map.geometry.size[1]; ++j) {
      for (int i = 0; i < map.geometry.size[0]; ++i) {
        if (map.labels[at++] == label) box.extend(Vec3(i, j, k));
      }
    }
  }
  return map.geometry.to_patient(map.geometry.to_index(p_mm).cwiseMax(box.min()).cwiseMin(box.max()));
}

PictureLevel picture_level(const LevelReport& report, const LabelVolume& map, int label) {
  return {label, in_box_of(map, label, report.body_centre_mm), report.is_suspect(), warnings_of(report).warnings};
}

void write_picture(const CtVolume& ct, const LabelVolume& map, const LevelsPicture& what,
                   const SegmentCommandOptions& options, StagedOutput& output) {
  if (!options.picture.empty()) output.write(options.picture, encode_png(levels_picture(ct, map, what)));
}

/// Prints what was found, and gives it as JSON.
Json report_found(std::span<const LevelReport> levels, const BoneReport& bone, const SegmentCommandOptions& options,
                  int& exit_code) {
  print_figure("bone, at least", bone.threshold_hu, "HU", 0);
  print_figure("noise in soft tissue, about", bone.noise_hu, "HU", 0);
  print_figure("names", words_of(levels.front().name_source, options.ct.finding.segment.names));
  print_levels(levels);
  std::vector<std::string> suspect;
  for (const LevelReport& level : levels) {
    if (level.is_suspect()) suspect.push_back(level.name);
  }
  exit_code = say_suspect(suspect, options.ct.finding.accepts_warnings);
  if (!suspect.empty() && options.picture.empty()) print_figure("look at it", "add --picture warnings.png");
  return {
      {"threshold_hu", bone.threshold_hu}, {"sure_threshold_hu", bone.sure_threshold_hu}, {"noise_hu", bone.noise_hu}};
}

/// A map of one bone. It carries the level's name where there is one and a byte holds the label.
std::string encode_one(const BoneMask& mask, int label, Level level, const std::filesystem::path& name,
                       const DicomSource& source) {
  const bool is_dicom = is_dicom_label_name(name);  // there segments count from 1, and name their CT
  if (is_dicom) label = 1;
  if (!is_dicom && (level == Level::kNone || label > 255)) return encode_label_map(mask, label, name);
  const std::string bone = level == Level::kNone ? "vertebra" : level_name(level);
  LabelVolume map{mask.geometry, mask.inside, {{label, {bone, level}}}};
  for (std::uint8_t& voxel : map.labels) voxel = static_cast<std::uint8_t>(voxel != 0 ? label : 0);
  return encode_label_volume(map, name, source);
}

Json segment_one(const CtVolume& ct, const SegmentCommandOptions& options, StagedOutput& output,
                 const Progress& progress, int& exit_code) {
  std::optional<LabelChoice> labels;
  if (!options.ct.labels.empty()) {
    labels =
        LabelChoice{options.ct.labels, options.label, Level::kNone, options.ct.convention, options.ct.reading.affine};
  }
  const ChosenBone bone = choose_bone(ct, labels, options.ct.finding.complete(ct), progress);
  const int number = bone.level == Level::kNone ? 1 : static_cast<int>(bone.level);
  const int label = options.write_label != 0 ? options.write_label : number;
  output.write(options.output_or_default(),
               encode_one(bone.mask, label, bone.level, options.output_or_default(), options.source(ct, progress)));

  const std::string name = bone.found ? bone.found->report.name : level_name(bone.level);
  const LabelVolume map{bone.mask.geometry, bone.mask.inside, {{1, {name.empty() ? "bone" : name, bone.level}}}};
  LevelsPicture what;
  what.levels = {bone.found ? picture_level(bone.found->report, map, 1)
                            : PictureLevel{1, middle_of(map, 1), false, {}}};
  what.seed_mm = bone.found ? std::optional(bone.found->seed_mm) : std::nullopt;
  write_picture(ct, map, what, options, output);
  output.commit();

  Json figures = Json::object();
  if (bone.found) {
    LevelReport report = bone.found->report;
    report.label = label;
    figures = report_found(std::span(&report, 1), bone.found->bone, options, exit_code);
    figures.update(to_json(report));
    figures["seed_mm"] = to_json(bone.found->seed_mm);
  }
  if (labels) {
    print_warnings(bone.warnings);
    figures["warnings"] = bone.warnings.warnings;
    figures["severity"] = bone.warnings.severity;
    if (bone.level != Level::kNone) {
      print_figure("vertebra", level_name(bone.level));
      print_figure("vertebra known by", bone.level_source);
      figures["level"] = level_name(bone.level);
      figures["level_source"] = bone.level_source;
    }
    exit_code = say_suspect(level_name(bone.level), bone.warnings, options.ct.finding.accepts_warnings);
  }
  const auto voxels = std::count(bone.mask.inside.begin(), bone.mask.inside.end(), std::uint8_t{1});
  const double volume_mm3 = static_cast<double>(voxels) * ct.geometry.spacing_mm.prod();
  print_figure("voxels", static_cast<double>(voxels), "", 0);
  print_figure("volume", volume_mm3, "mm3", 0);
  figures["voxels"] = voxels;
  figures["volume_mm3"] = volume_mm3;
  figures["label"] = label;
  return figures;
}

/// The vertebrae of a map, with VerSe's numbers and names.
LabelVolume renumbered(const LabelVolume& map) {
  LabelVolume result{map.geometry, map.labels, {}};
  std::array<std::uint8_t, 256> numbers{};
  for (const auto& [label, name] : map.names) {
    if (name.level == Level::kNone) continue;
    const int number = static_cast<int>(name.level);
    numbers[static_cast<std::size_t>(label)] = static_cast<std::uint8_t>(number);
    result.names[number] = {level_name(name.level), name.level};
  }
  if (result.names.empty()) fail("expected vertebrae in the label map, found no label that is known to be one");
  for (std::uint8_t& label : result.labels) label = numbers[label];
  return result;
}

Json copy_all(const CtVolume& ct, const SegmentCommandOptions& options, StagedOutput& output, const Progress& progress,
              int& exit_code) {
  const LabelVolume read = options.ct.read_labels(ct);
  const LabelVolume map = renumbered(read);
  output.write(options.output_or_default(),
               encode_label_volume(map, options.output_or_default(), options.source(ct, progress)));
  LevelsPicture what;
  Json levels = Json::array();
  std::vector<std::string> suspect;
  print_figure("vertebrae known by", read.level_source);
  for (const Level level : levels_of(map)) {
    const int label = static_cast<int>(level);
    const auto voxels = std::count(map.labels.begin(), map.labels.end(), static_cast<std::uint8_t>(label));
    const double volume_mm3 = static_cast<double>(voxels) * ct.geometry.spacing_mm.prod();
    const LevelWarnings warnings = warnings_of_label(ct, mask_of(map, label), level, read.warnings, progress);
    if (warnings.is_suspect()) suspect.push_back(level_name(level));
    what.levels.push_back({label, middle_of(map, label), warnings.is_suspect(), warnings.warnings});
    print_figure(level_name(level), volume_mm3, "mm3", 0);
    print_warnings(warnings);
    levels.push_back({{"label", label},
                      {"level", level_name(level)},
                      {"volume_mm3", volume_mm3},
                      {"warnings", warnings.warnings},
                      {"severity", warnings.severity}});
  }
  write_picture(ct, map, what, options, output);
  output.commit();
  exit_code = say_suspect(suspect, options.ct.finding.accepts_warnings);
  return {{"levels", levels}, {"level_source", read.level_source}};
}

Json segment_all(const CtVolume& ct, const SegmentCommandOptions& options, StagedOutput& output,
                 const Progress& progress, int& exit_code) {
  const SpineSegmentation found = segment_spine(ct, options.ct.finding.complete(ct), progress);
  if (found.levels.empty()) {
    fail_as(ErrorKind::geometry, "expected vertebrae in the CT, found none above the sacrum");
  }
  output.write(options.output_or_default(),
               encode_label_volume(found.labels, options.output_or_default(), options.source(ct, progress)));
  LevelsPicture what;
  what.seed_mm = options.ct.finding.given_seed();
  for (const LevelReport& level : found.levels) {
    if (level.volume_mm3 > 0.0) what.levels.push_back(picture_level(level, found.labels, level.label));
  }
  write_picture(ct, found.labels, what, options, output);
  output.commit();
  Json figures = report_found(found.levels, found.bone, options, exit_code);
  exit_code = std::max(exit_code, say_gaps(found.gaps, options.ct.finding.accepts_warnings, figures));
  if (!found.transitional.empty()) print_figure("names are doubtful", found.transitional);
  figures["transitional"] = found.transitional.empty() ? Json() : Json(found.transitional);
  figures["levels"] = Json::array();
  for (const LevelReport& level : found.levels) figures["levels"].push_back(to_json(level));
  return figures;
}

/// Where nothing was found a person may see why: the picture that was asked for shows the CT's slices then.
[[noreturn]] void fail_with_slices(const CtVolume& ct, const Error& error, const SegmentCommandOptions& options) {
  if (options.picture.empty()) fail_as(error.kind(), error.what(), "; --picture slices.png shows the CT");
  StagedOutput output;
  output.write(options.picture, encode_png(contact_sheet(ct)));
  output.commit();
  fail_as(error.kind(), error.what(), "; look at its slices in ", options.picture.string());
}

Json segment(const SegmentCommandOptions& options, const Progress& progress, int& exit_code) {
  // A bad name is said before the work is done.
  encode_label_map({{{1, 1, 1}}, {1}}, 1, options.output_or_default());
  StageClock clock;
  const CtVolume ct = options.ct.read(progress);
  clock.end("read");
  StagedOutput output;
  int code = 0;
  const auto cut = [&] {
    return !options.is_all             ? segment_one(ct, options, output, progress, code)
           : options.ct.labels.empty() ? segment_all(ct, options, output, progress, code)
                                       : copy_all(ct, options, output, progress, code);
  };
  Json figures;
  try {
    figures = cut();
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::geometry || !options.ct.labels.empty()) throw;
    fail_with_slices(ct, error, options);
  }
  clock.end("segmented and written");
  figures["ct_hash"] = ct.source_hash;
  report_input_warnings(ct.warnings, figures);
  code = std::max(code, say_input_warnings(ct.warnings, options.ct.finding.accepts_warnings));
  print_figure("written", options.output_or_default().string());
  report_times(clock);  // not in --json, which is the same each time
  exit_code = code;
  return figures;
}

}  // namespace

void add_segment(CLI::App& program, Command& command) {
  const auto options = std::make_shared<SegmentCommandOptions>();
  CLI::App* app = add_command(
      program, command, "segment", "Cut one vertebra out of a CT, or all of them, and write a label map",
      "Examples: spinaltap segment ct/ --seed-point -9,222,-638 -o t11.seg.nrrd --picture t11.png\n"
      "          spinaltap segment ct/ --all --level T11=-9,222,-638 -o spine.seg.nrrd --picture spine.png\n"
      "          spinaltap segment ct/ --all --level T11=-9,222,-638 --include T11=-9,260,-650 --exclude 30,250,-640\n"
      "Points are patient LPS, mm (x to the left, y to the back, z to the head). Without --level, names are a\n"
      "hint from the sacrum, the ribs and the bodies' sizes, with its probability, or where none is 0.9 likely\n"
      "V1, V2, ... from the top. A seed takes its vertebra, with --all its column. The exit code is 1 where a\n"
      "vertebra is suspect or may be missed, or the CT is doubtful, with all written, unless --accept-warnings.\n"
      "Correct the map in 3D Slicer and go on: spinaltap bake ct/ --labels t11.seg.nrrd -o bone.vdb\n"
      "Or paint strokes there, in segments named T11, T12 and exclude, and add --strokes strokes.seg.nrrd.");
  add_options(*app, *options);
  command.outputs = [options] { return std::vector{options->output_or_default()}; };
  command.run = [options, &command](const Progress& progress) {
    return segment(*options, progress, command.exit_code);
  };
}

}  // namespace spinaltap
