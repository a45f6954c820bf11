#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "apps/spinaltap/command.h"
#include "apps/spinaltap/ct_options.h"
#include "apps/spinaltap/input_warnings.h"
#include "apps/spinaltap/level_output.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/base/text_writer.h"
#include "core/files/bake_cache.h"
#include "vdb/sim/bake_levels.h"

namespace spinaltap {
namespace {

struct BakeCommandOptions {
  CtOptions ct;
  std::filesystem::path output;
  std::filesystem::path cache;
  bool is_all = false;
  bool is_strict = false;
  int exit_code = 0;

  std::filesystem::path output_or_default() const {
    if (!output.empty()) return output;
    return is_all ? "spine.vdb" : "bone.vdb";
  }
};

Json bake_one(BakeCommandOptions& options, StagedOutput& output, const Progress& progress) {
  // Before the work: a place that cannot be written to is said at once.
  const std::filesystem::path staged = output.stage(options.output_or_default());
  const CtVolume ct = options.ct.read(progress);
  const BakedCt baked = options.ct.make_bone(ct, progress);
  write_bone(baked.bone, staged);
  output.commit();
  Json figures = report_baked(ct, baked);
  const bool accepts_warnings = options.ct.finding.accepts_warnings;
  const std::vector<std::string> of_input = input_warnings_in(baked.bone.metadata());
  report_input_warnings(of_input, figures);
  options.exit_code = say_input_warnings(of_input, accepts_warnings);
  if (baked.warnings) {
    options.exit_code =
        std::max(options.exit_code, say_suspect(level_name(baked.level), *baked.warnings, accepts_warnings));
  }
  return figures;
}

/// The vertebrae to bake, and what is known of them.
struct MarkedLevels {
  LabelVolume labels;
  std::map<Level, LevelWarnings> warnings;
  std::vector<std::string> gaps;  ///< where vertebrae may have been missed
};

MarkedLevels find_levels(const CtVolume& ct, const FindingOptions& finding, const Progress& progress) {
  SpineSegmentation found = segment_spine(ct, finding.complete(ct), progress);
  MarkedLevels marked{std::move(found.labels), {}, std::move(found.gaps)};
  marked.labels.names.clear();
  std::string unnamed;
  for (const LevelReport& level : found.levels) {
    if (level.level == Level::kNone) {
      TextWriter text;
      const Vec3& p = level.body_centre_mm;
      text << level.name << " at " << std::lround(p.x()) << ',' << std::lround(p.y()) << ',' << std::lround(p.z());
      unnamed += (unnamed.empty() ? "" : ", ") + text.str();
      continue;
    }
    marked.labels.names[level.label] = {level.name, level.level};
    marked.warnings[level.level] = warnings_of(level);
  }
  if (marked.warnings.empty()) {
    fail(
        "expected names of the vertebrae to bake, found none; name one by a point in its body, such as --level "
        "T11=X,Y,Z; there are: ",
        unnamed);
  }
  if (!unnamed.empty()) print_figure("left out, without a name", unnamed);
  print_figure("names", words_of(found.levels.front().name_source, finding.segment.names));
  return marked;
}

Json bake_all(BakeCommandOptions& options, StagedOutput& output, const Progress& progress) {
  const std::filesystem::path target = options.output_or_default();
  // Named twice where it is a file: this tells at once that it cannot be written to.
  if (target.extension() == ".vdb") StagedOutput().stage(target);
  const CtVolume ct = options.ct.read(progress);
  const MarkedLevels marked = options.ct.labels.empty() ? find_levels(ct, options.ct.finding, progress)
                                                        : MarkedLevels{options.ct.read_labels(ct), {}, {}};
  const BakedLevels baked =
      bake_levels(ct, marked.labels,
                  {.bake = options.ct.bake, .warnings = marked.warnings, .is_strict = options.is_strict}, progress);
  write_levels(baked, target, output);
  if (target.extension() != ".vdb") output.list_in(target);
  output.commit();
  std::vector<std::string> suspect;
  std::map<std::string, std::string> inputs;  // of all levels: those of one CT are the same for all
  Json figures{{"ct_hash", ct.source_hash}, {"levels", Json::array()}, {"skipped", Json::array()}};
  for (const BakedLevel& one : baked.levels) {
    Json level = report_baked(ct, one.baked);
    level["level"] = level_name(one.level);
    level["warnings"] = one.notes.warnings;
    level["severity"] = one.notes.severity;
    const std::vector<std::string> of_input = input_warnings_in(one.baked.bone.metadata());
    level["input_warnings"] = of_input;
    add_input_warnings(of_input, inputs);
    if (!one.notes.landmarks.empty()) level["landmarks"] = Json::parse(one.notes.landmarks);
    if (!one.notes.no_landmarks.empty()) level["no_landmarks"] = one.notes.no_landmarks;
    // The first ones are those of the mask, which are printed.
    const std::size_t printed = one.baked.warnings ? one.baked.warnings->warnings.size() : 0;
    for (std::size_t n = printed; n < one.notes.warnings.size(); ++n) print_figure("warning", one.notes.warnings[n]);
    if (one.baked.warnings && one.baked.warnings->is_suspect()) suspect.push_back(level_name(one.level));
    if (!one.notes.no_landmarks.empty()) print_figure("no landmarks", one.notes.no_landmarks);
    figures["levels"].push_back(level);
  }
  for (const SkippedLevel& one : baked.skipped) {
    print_figure(level_name(one.level), "left out: " + one.reason);
    figures["skipped"].push_back({{"level", level_name(one.level)}, {"reason", one.reason}});
  }
  const bool accepts_warnings = options.ct.finding.accepts_warnings;
  const std::vector<std::string> of_inputs = input_warnings_in(inputs);
  report_input_warnings(of_inputs, figures);
  options.exit_code = std::max({say_input_warnings(of_inputs, accepts_warnings), say_suspect(suspect, accepts_warnings),
                                say_gaps(marked.gaps, accepts_warnings, figures)});
  return figures;
}

Json bake(BakeCommandOptions options, const Progress& progress, int& exit_code) {
  const bool keep_cache = !options.cache.empty();
  options.ct.bake.cache =
      keep_cache ? options.cache : std::filesystem::path(options.output_or_default().string() + ".cache");
  const auto remove_cache = [&] {
    if (!keep_cache) BakeCache(options.ct.bake.cache).remove();
  };
  StagedOutput output;  // outlives the cache, which may lie in a folder that it made
  try {
    Json figures = options.is_all ? bake_all(options, output, progress) : bake_one(options, output, progress);
    remove_cache();
    exit_code = options.exit_code;
    print_figure("written", options.output_or_default().string());
    return figures;
  } catch (const Cancelled&) {
    throw;  // the next run goes on from what is finished
  } catch (...) {
    remove_cache();
    throw;
  }
}

}  // namespace

void add_bake(CLI::App& program, Command& command) {
  const auto options = std::make_shared<BakeCommandOptions>();
  CLI::App* app = add_command(
      program, command, "bake", "Make bone.vdb (distance and CT numbers) from a CT, or spine.vdb of several bones",
      "Examples: spinaltap bake ct/ --seed-point -9,222,-638 -o bone.vdb\n"
      "          spinaltap bake ct/ --all --level T11=-9,222,-638 -o spine.vdb\n"
      "          spinaltap bake ct/ --labels vertebrae.nii.gz --label L3 -o bone.vdb\n"
      "          spinaltap bake ct/ --labels vertebrae.nii.gz --all -o spine.vdb\n"
      "With --all, vertebrae that the CT's border cuts and those that cannot be baked are told and left\n"
      "out; the exit code is 2 where none is left, and 1 where one is suspect (docs/segmentation.md) or the CT\n"
      "is doubtful (docs/reading.md), with all written, unless --accept-warnings.\n"
      "docs/label-maps.md tells how vertebrae get their names.");
  app->add_option("ct", options->ct.folder, "Folder with a DICOM CT series, or a NIfTI, NRRD or MetaImage file")
      ->required()
      ->type_name("PATH");
  app->add_option("-o,--output", options->output,
                  "The .vdb file to write; default: bone.vdb, or spine.vdb with --all, where another name than of a\n"
                  ".vdb is a folder for a file a vertebra")
      ->type_name("FILE");
  app->add_option(
         "--cache", options->cache,
         "Folder to keep finished stages in, for bakes with other options; default: OUTPUT.cache, from which a "
         "stopped bake goes on, removed at the end")
      ->type_name("FOLDER");
  options->ct.add_reading(*app);
  options->ct.add_baking(*app);
  CLI::Option* all =
      app->add_flag("--all", options->is_all, "Bake each vertebra of the label map, or of the CT without one");
  all->excludes("--label")->excludes("--crop-margin");
  app->add_flag("--strict", options->is_strict, "With --all: write nothing where a vertebra would be left out")
      ->needs(all);
  command.after_stop = "what is finished is kept; the same command goes on";
  command.outputs = [options]() -> std::vector<std::filesystem::path> {
    const std::filesystem::path output = options->output_or_default();
    if (!options->is_all || output.extension() == ".vdb") return {output};
    std::vector<std::filesystem::path> levels;
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator(output, none)) {
      if (entry.path().extension() == ".vdb") levels.push_back(entry.path());
    }
    return levels;
  };
  command.run = [options, &command](const Progress& progress) { return bake(*options, progress, command.exit_code); };
}

}  // namespace spinaltap
