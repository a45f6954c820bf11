#include "vdb/sim/phantom_output.h"

#include "core/files/json_file.h"
#include "core/files/plan_file.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/base/version.h"
#include "core/ct/dicom_write.h"
#include "core/phantom/spine_truth.h"
#include "core/phantom/true_labels.h"
#include "vdb/bake.h"

namespace spinaltap {
namespace {

Json json_of(const PedicleTruth& pedicle) {
  return {{"isthmus_mm", to_json(pedicle.isthmus_mm)},
          {"axis", to_json(pedicle.axis)},
          {"width_axis", to_json(pedicle.width_axis)},
          {"height_axis", to_json(pedicle.height_axis)},
          {"width_mm", pedicle.width_mm},
          {"height_mm", pedicle.height_mm},
          {"entry_mm", to_json(pedicle.entry_mm)},
          {"target_mm", to_json(pedicle.target_mm)}};
}

Json truth_json(const std::optional<VertebraTruth>& truth, const ScanOptions& scan, const CtVolume& ct) {
  Json json{{"format", "spinaltap-phantom"},
            {"version", version()},
            {"frame", "LPS"},
            {"unit", "mm"},
            {"scan",
             {{"columns", scan.columns},
              {"rows", scan.rows},
              {"slices", scan.slices},
              {"pixel_mm", scan.pixel_mm},
              {"slice_step_mm", scan.slice_step_mm},
              {"slice_width_mm", scan.slice_width_mm},
              {"blur_mm", scan.blur_mm},
              {"noise_hu", scan.noise_hu},
              {"seed", scan.seed},
              {"surroundings_hu", scan.surroundings_hu},
              {"hash", ct.source_hash}}}};
  if (truth) json["pedicles"] = {{"left", json_of(truth->left)}, {"right", json_of(truth->right)}};
  return json;
}

Json json_of(const LevelTruth& level) {
  return {{"level", level_name(level.level)},
          {"pedicles", {{"left", json_of(level.pedicles.left)}, {"right", json_of(level.pedicles.right)}}},
          {"body_centre_mm", to_json(level.body_centre_mm)},
          {"superior_endplate_mm", to_json(level.superior_endplate_mm)},
          {"superior_normal", to_json(level.superior_normal)},
          {"inferior_endplate_mm", to_json(level.inferior_endplate_mm)},
          {"inferior_normal", to_json(level.inferior_normal)},
          {"spinous_tip_mm", to_json(level.spinous_tip_mm)},
          {"left_transverse_tip_mm", to_json(level.left_transverse_tip_mm)},
          {"right_transverse_tip_mm", to_json(level.right_transverse_tip_mm)}};
}

Json json_of(const SpineTruth& truth) {
  Json levels = Json::array(), discs = Json::array();
  for (const LevelTruth& level : truth.levels) levels.push_back(json_of(level));
  for (const DiscTruth& disc : truth.discs) {
    discs.push_back({{"below", level_name(disc.above)},
                     {"centre_mm", to_json(disc.centre_mm)},
                     {"normal", to_json(disc.normal)},
                     {"height_mm", disc.height_mm}});
  }
  return {{"levels", levels}, {"discs", discs}};
}

void write_ct(const CtVolume& ct, double slice_width_mm, const std::filesystem::path& folder,
              const Progress& progress) {
  std::error_code error;
  std::filesystem::create_directory(folder, error);
  if (error) fail("cannot make the folder ", folder.string(), ": ", error.message());
  write_dicom(ct, folder, {.series_description = "SpinalTap virtual scan", .slice_thickness_mm = slice_width_mm},
              progress);
}

}  // namespace

void write_spine_phantom(const Spine& spine, bool soft_tissue, const ScanOptions& options,
                         const std::filesystem::path& folder, const Progress& progress) {
  StagedFolder staged(folder, "truth.json");
  const CtVolume ct = soft_tissue ? scan(spine, SoftTissue(spine), options, progress) : scan(spine, options, progress);
  write_ct(ct, options.slice_width_mm, staged.temporary() / "ct", progress);
  const std::filesystem::path labels = staged.temporary() / "truth_labels.nii.gz";
  write_whole_file(labels, encode_label_volume(true_labels(spine, ct.geometry), labels));
  Json json = truth_json(std::nullopt, options, ct);
  json.update(json_of(spine_truth(spine)));
  write_json(json, staged.temporary() / "truth.json");
  staged.commit();
}

void write_phantom(const Solid& solid, const std::optional<VertebraTruth>& truth, const PhantomOptions& options,
                   const std::filesystem::path& folder, const Progress& progress) {
  StagedFolder staged(folder, "truth.json");
  const CtVolume ct = scan(solid, options.scan, progress);
  write_ct(ct, options.scan.slice_width_mm, staged.temporary() / "ct", progress);
  write_bone(bake_solid(solid, {.voxel_mm = options.truth_voxel_mm}, options.scan.surroundings_hu, progress),
             staged.temporary() / "truth.vdb");
  write_json(truth_json(truth, options.scan, ct), staged.temporary() / "truth.json");
  if (truth) {
    const DrillBit bit;
    write_plan({{"left", truth->left.entry_mm, truth->left.target_mm, bit},
                {"right", truth->right.entry_mm, truth->right.target_mm, bit}},
               staged.temporary() / "plan.json");
  }
  staged.commit();
}

}  // namespace spinaltap
