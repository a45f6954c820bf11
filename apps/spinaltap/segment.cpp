#include <algorithm>
#include <memory>

#include "apps/report/levels_picture.h"
#include "apps/report/png.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/ct_options.h"
#include "core/base/staged_output.h"
#include "core/ct/label_map.h"

namespace spinaltap {
namespace {

struct SegmentCommandOptions {
  CtOptions ct;
  std::optional<double> threshold_hu;
  int from_label = 1;
  int label = 1;
  std::filesystem::path output = "vertebra.seg.nrrd";
  std::filesystem::path picture;
};

void add_options(CLI::App& app, SegmentCommandOptions& options) {
  app.add_option("ct", options.ct.folder, "Folder with a DICOM CT series")->required()->type_name("FOLDER");
  app.add_option("-o,--output", options.output, "The label map to write: .nii.gz, .nii, .nrrd or .seg.nrrd")
      ->capture_default_str()
      ->type_name("FILE");
  options.ct.add_reading(app);
  CLI::Option* labels =
      app.add_option("--labels", options.ct.labels, "Take the bone from this label map instead, NIfTI or NRRD")
          ->type_name("FILE");
  app.add_option("--from", options.from_label, "Which label of that map is the bone")->needs(labels)->type_name("N");
  app.add_option("--seed", options.ct.seed_mm, "A point in the body of the vertebra, mm; default: in the largest body")
      ->excludes(labels)
      ->expected(3)
      ->delimiter(',')
      ->type_name("X,Y,Z");
  app.add_option("--threshold", options.threshold_hu, "Bone is at least this dense, HU; default: from the CT's noise")
      ->excludes(labels)
      ->type_name("HU");
  app.add_option("--label", options.label, "The value that the vertebra gets in the map")
      ->capture_default_str()
      ->check(CLI::Range(1, 32767))
      ->type_name("N");
  app.add_option("--picture", options.picture, "Write slices through the seed with the outline, as PNG")
      ->type_name("FILE");
}

Json report_found(const SegmentReport& report) {
  print_figure("bone, at least", report.threshold_hu, "HU", 0);
  print_figure("noise in soft tissue, about", report.noise_hu, "HU", 0);
  print_figure("cut from other bone over", report.cut_area_mm2, "mm2", 0);
  print_figure("parts dropped", static_cast<double>(report.parts_dropped), "", 0);
  if (report.reaches_border) print_figure("note", "it reaches the CT's border: part of it may be missing");
  return {{"seed_mm", to_json(report.seed_mm)},
          {"threshold_hu", report.threshold_hu},
          {"sure_threshold_hu", report.sure_threshold_hu},
          {"noise_hu", report.noise_hu},
          {"body_centre_mm", to_json(report.body_centre_mm)},
          {"body_size_mm", to_json(report.body_size_mm)},
          {"body_fit", report.body_fit},
          {"cut_area_mm2", report.cut_area_mm2},
          {"parts_dropped", report.parts_dropped},
          {"reaches_border", report.reaches_border}};
}

/// A point in the mask to show slices through: the seed, or the voxel nearest to the mask's centre.
Vec3 point_to_show(const BoneMask& mask, const std::optional<SegmentReport>& report) {
  if (report) return report->seed_mm;
  Vec3 sum = Vec3::Zero();
  double count = 0.0;
  for (int k = 0; k < mask.geometry.size[2]; ++k) {
    for (int j = 0; j < mask.geometry.size[1]; ++j) {
      for (int i = 0; i < mask.geometry.size[0]; ++i) {
        if (!mask.at(i, j, k)) continue;
        sum += Vec3(i, j, k);
        count += 1.0;
      }
    }
  }
  return mask.geometry.to_patient(sum / count);
}

Json segment(const SegmentCommandOptions& options, const Progress& progress) {
  // A bad name is said before the work is done.
  encode_label_map({{{1, 1, 1}}, {0}}, options.label, options.output);
  const CtVolume ct = options.ct.read(progress);
  std::optional<LabelChoice> labels;
  if (!options.ct.labels.empty()) labels = LabelChoice{options.ct.labels, options.from_label};
  const ChosenBone bone =
      choose_bone(ct, labels, {.seed_mm = options.ct.given_seed(), .threshold_hu = options.threshold_hu}, progress);
  StagedOutput output;
  output.write(options.output, encode_label_map(bone.mask, options.label, options.output));
  if (!options.picture.empty()) {
    const LabelVolume map{bone.mask.geometry, bone.mask.inside, {{1, {"vertebra", Level::kNone}}}};
    LevelsPicture what{.levels = {{1, point_to_show(bone.mask, bone.report), false, {}}}};
    if (bone.report) what.seed_mm = bone.report->seed_mm;
    const Image picture = levels_picture(ct, map, what);
    output.write(options.picture, encode_png(picture));
  }
  output.commit();

  const auto voxels = std::count(bone.mask.inside.begin(), bone.mask.inside.end(), std::uint8_t{1});
  const double volume_mm3 = static_cast<double>(voxels) * ct.geometry.spacing_mm.prod();
  Json figures = bone.report ? report_found(*bone.report) : Json::object();
  figures["ct_hash"] = ct.source_hash;
  figures["voxels"] = voxels;
  figures["volume_mm3"] = volume_mm3;
  figures["label"] = options.label;
  print_figure("voxels", static_cast<double>(voxels), "", 0);
  print_figure("volume", volume_mm3, "mm3", 0);
  print_figure("written", options.output.string());
  return figures;
}

}  // namespace

void add_segment(CLI::App& program, Command& command) {
  const auto options = std::make_shared<SegmentCommandOptions>();
  CLI::App* app =
      add_command(program, command, "segment", "Cut one vertebra out of a CT and write it as a label map",
                  "Example: spinaltap segment ct/ --seed -9,222,-638 -o t11.seg.nrrd --picture t11.png\n"
                  "Correct the map in 3D Slicer and go on: spinaltap bake ct/ --labels t11.seg.nrrd -o bone.vdb");
  add_options(*app, *options);
  command.run = [options](const Progress& progress) { return segment(*options, progress); };
}

}  // namespace spinaltap
