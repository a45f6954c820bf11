#include "core/files/ground_truth_file.h"

#include <nlohmann/json.hpp>

#include "core/base/version.h"
#include "core/files/json_file.h"

namespace spinaltap {
namespace {

Json json_of(const PedicleGroundTruth& pedicle) {
  return {{"isthmus_mm", to_json(pedicle.isthmus_mm)},
          {"axis", to_json(pedicle.axis)},
          {"width_axis", to_json(pedicle.width_axis)},
          {"height_axis", to_json(pedicle.height_axis)},
          {"width_mm", pedicle.width_mm},
          {"height_mm", pedicle.height_mm},
          {"entry_mm", to_json(pedicle.entry_mm)},
          {"target_mm", to_json(pedicle.target_mm)}};
}

Json scan_json(const ScanOptions& scan, const std::string& ct_hash) {
  return {{"format", "spinaltap-ground-truth"},
          {"version", kFormatVersion},
          {"program", version()},
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
            {"hash", ct_hash}}}};
}

Json json_of(const LevelGroundTruth& level) {
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

Json json_of(const SpineGroundTruth& ground_truth) {
  Json levels = Json::array(), discs = Json::array();
  for (const LevelGroundTruth& level : ground_truth.levels) levels.push_back(json_of(level));
  for (const DiscGroundTruth& disc : ground_truth.discs) {
    discs.push_back({{"below", level_name(disc.above)},
                     {"centre_mm", to_json(disc.centre_mm)},
                     {"normal", to_json(disc.normal)},
                     {"height_mm", disc.height_mm}});
  }
  return {{"levels", levels}, {"discs", discs}};
}

}  // namespace

void write_ground_truth(const std::optional<VertebraGroundTruth>& ground_truth, const ScanOptions& scan,
                        const std::string& ct_hash, const std::filesystem::path& file) {
  Json json = scan_json(scan, ct_hash);
  if (ground_truth) json["pedicles"] = {{"left", json_of(ground_truth->left)}, {"right", json_of(ground_truth->right)}};
  write_json(json, file);
}

void write_ground_truth(const SpineGroundTruth& ground_truth, const ScanOptions& scan, const std::string& ct_hash,
                        const std::filesystem::path& file) {
  Json json = scan_json(scan, ct_hash);
  json.update(json_of(ground_truth));
  write_json(json, file);
}

}  // namespace spinaltap
