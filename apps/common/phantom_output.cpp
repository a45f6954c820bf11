#include "apps/common/phantom_output.h"

#include "apps/common/json_file.h"
#include "apps/common/plan_file.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/base/version.h"
#include "core/ct/dicom_write.h"
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

}  // namespace

void write_phantom(const Solid& solid, const std::optional<VertebraTruth>& truth, const PhantomOptions& options,
                   const std::filesystem::path& folder, const Progress& progress) {
  StagedFolder staged(folder, "truth.json");
  const CtVolume ct = scan(solid, options.scan, progress);
  std::error_code error;
  std::filesystem::create_directory(staged.temporary() / "ct", error);
  if (error) fail("cannot make the folder ", (folder / "ct").string(), ": ", error.message());
  write_dicom(ct, staged.temporary() / "ct",
              {.series_description = "SpinalTap virtual scan", .slice_thickness_mm = options.scan.slice_width_mm},
              progress);
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
