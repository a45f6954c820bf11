#include "vdb/sim/bake_ct.h"

#include <algorithm>
#include <map>

#include "core/base/code_fingerprint.h"
#include "core/base/error.h"
#include "core/base/text_writer.h"
#include "core/base/version.h"
#include "core/ct/ct_noise.h"
#include "core/ct/label_frame.h"
#include "core/ct/label_map.h"
#include "vdb/sim/bone_identity.h"
#include "vdb/sim/detail/bone_surface_error.h"
#include "vdb/sim/detail/stage_key.h"
#include "vdb/sim/label_warnings.h"

namespace spinaltap {

namespace {

ChosenBone chosen_label(const LabelChoice& choice, const GridGeometry& geometry, std::vector<std::string>& of_place) {
  constexpr int kMaxNamed = 255;
  LabelReadOptions options{choice.convention, choice.affine, 0};
  if (choice.level != Level::kNone) {
    const LabelVolume volume = read_label_volume(choice.file, geometry, options);
    of_place = volume.warnings;
    BoneMask mask = mask_of(volume, choice.level);
    return {std::move(mask), std::nullopt, choice.level, *label_of(volume, choice.level), volume.level_source};
  }
  int label = choice.label;
  ChosenBone chosen;
  // No numbering goes further; such a label has no level.
  if (label <= kMaxNamed) {
    options.wanted = label == 0 ? 1 : label;
    const LabelVolume volume = read_label_volume(choice.file, geometry, options);
    if (label == 0) label = volume.names.size() == 1 ? volume.names.begin()->first : 1;
    if (const auto found = volume.names.find(label); found != volume.names.end()) chosen.level = found->second.level;
    if (chosen.level != Level::kNone) chosen.level_source = volume.level_source;
  }
  chosen.mask = read_label_map(choice.file, label, geometry, choice.affine, &of_place);
  chosen.label = label;
  return chosen;
}

}  // namespace

BoneMask label_mask(const LabelChoice& choice, const GridGeometry& geometry) {
  std::vector<std::string> of_place;
  return chosen_label(choice, geometry, of_place).mask;
}

ChosenBone choose_bone(const CtVolume& ct, const std::optional<LabelChoice>& labels, const SegmentOptions& options,
                       const Progress& progress) {
  ChosenBone chosen;
  if (labels) {
    std::vector<std::string> of_place;
    chosen = chosen_label(*labels, ct.geometry, of_place);
    if (const auto warning = warning_of_frame(labels->file, ct)) of_place.push_back(*warning);
    chosen.warnings = warnings_of_label(ct, chosen.mask, chosen.level, of_place, progress);
  } else {
    Segmentation segmentation = segment_vertebra(ct, options, progress);
    chosen.mask = std::move(segmentation.mask);
    chosen.level = segmentation.report.level;
    chosen.warnings = warnings_of(segmentation.report);
    chosen.found = std::move(segmentation);
  }
  warn_of_border(chosen.mask, chosen.warnings);
  return chosen;
}

namespace {

MaskStage make_mask(const CtVolume& ct, const BakeCtOptions& options, const BakeCache& cache, bool& from_cache,
                    const Progress& progress) {
  const std::string key = detail::mask_key(code_fingerprint(CodeStage::mask), ct.source_hash, options.segment);
  if (!options.labels) {
    if (std::optional<MaskStage> kept = cache.find_mask(key, ct.geometry)) {
      from_cache = true;
      return *std::move(kept);
    }
  }
  ChosenBone chosen = choose_bone(ct, options.labels, options.segment, progress);
  MaskStage stage{std::move(chosen.mask),
                  chosen.found ? joined(chosen.found->choice, "; bone from ", chosen.found->bone.threshold_hu, " HU on")
                               : joined("label ", chosen.label),
                  chosen.level, std::nullopt, chosen.level_source};
  const bool is_doubted = !chosen.warnings.warnings.empty();
  if (chosen.found || is_doubted) stage.warnings = chosen.warnings;
  if (!options.labels) cache.keep_mask(key, stage);
  return stage;
}

SurfaceFit make_fit(const CtVolume& ct, const BoneMask& mask, const SurfacePoints& surface,
                    const BakeCtOptions& options, const BakeCache& cache, bool& from_cache, const Progress& progress) {
  const std::string key =
      detail::fit_key(code_fingerprint(CodeStage::fit), ct.source_hash, mask, options.surface, options.rbf);
  if (std::optional<SurfaceFit> kept = cache.find_fit(key)) {
    from_cache = true;
    return *std::move(kept);
  }
  SurfaceFit fit = fit_surface(surface, options.rbf, progress);
  cache.keep_fit(key, fit);
  return fit;
}

std::map<std::string, std::string> metadata_of(const CtVolume& ct, const BakeCtOptions& options, const MaskStage& mask,
                                               const SurfaceFitReport& fit) {
  const GridGeometry& geometry = ct.geometry;
  std::map<std::string, std::string> metadata{
      {"program", version()},
      {"method", "edges in the CT, biharmonic radial basis function"},
      {kSourceHash, ct.source_hash},
      {"ct_size", joined(geometry.size[0], " ", geometry.size[1], " ", geometry.size[2])},
      {kCtSpacing, joined(geometry.spacing_mm.transpose())},
      {"ct_origin_mm", joined(geometry.origin_mm.transpose())},
      {kCtDirections, joined(geometry.directions.col(0).transpose(), " ", geometry.directions.col(1).transpose(), " ",
                             geometry.directions.col(2).transpose())},
      {"mask", mask.method},
      {"surface_points", joined(fit.points)},
      {"off_surface_points", joined(fit.off_surface_points)},
      {"rbf_centres", joined(fit.centres)},
      {"point_spacing_mm", joined(options.rbf.spacing_mm)},
      {"off_surface_mm", joined(options.rbf.off_surface_mm)},
      {"smoothing_mm", joined(options.rbf.smoothing_mm)},
      {"rbf_accuracy_mm", joined(options.rbf.accuracy_mm)},
      {"rbf_reduction_mm", joined(options.rbf.reduction_mm)},
      {"rbf_mean_residual_mm", joined(fit.mean_residual_mm)},
      {"rbf_p99_residual_mm", joined(fit.p99_residual_mm)},
      {"rbf_max_residual_mm", joined(fit.max_residual_mm)},
      {"hu_margin_mm", joined(options.bake.hu_margin_mm)},
  };
  if (const std::optional<double> noise_hu = ct_noise_hu(ct)) metadata[kCtNoise] = joined(*noise_hu);
  if (ct.slice_thickness_mm > 0.0) metadata[kCtSliceThickness] = joined(ct.slice_thickness_mm);
  metadata[kWholeCtHash] = ct.whole_hash;
  if (mask.level != Level::kNone) metadata["level"] = level_name(mask.level);
  if (!mask.level_source.empty()) metadata["level_source"] = mask.level_source;
  if (mask.warnings) add_warnings(*mask.warnings, metadata);
  add_input_warnings(ct.warnings, metadata);
  add_hu_change(ct.hu_change, metadata);
  metadata.insert(ct.choices.begin(), ct.choices.end());
  return metadata;
}

}  // namespace

BakedCt bake_mask(const CtVolume& ct, const MaskStage& mask, const BakeCtOptions& options, const Progress& progress) {
  const BakeCache cache(options.cache);
  bool fit_from_cache = false;
  StageClock clock;
  const SurfacePoints surface = extract_surface(ct, mask.mask, options.surface, progress);
  clock.end("points");
  const SurfaceFit fit = make_fit(ct, mask.mask, surface, options, cache, fit_from_cache, progress);
  clock.end("fitted");
  BakeReport report;
  const BoneModel bone = bake_bone(fit.field, surface.positions_mm, ct, options.bake,
                                   metadata_of(ct, options, mask, fit.report), &report, progress);
  const auto mask_voxels =
      static_cast<std::size_t>(std::count(mask.mask.inside.begin(), mask.mask.inside.end(), std::uint8_t{1}));
  clock.end("baked");
  return {bone,          mask_voxels,       fit.report, report,         mask.level,
          mask.warnings, mask.level_source, false,      fit_from_cache, clock.times()};
}

BakedCt bake_ct(const CtVolume& ct, const BakeCtOptions& options, const Progress& progress) {
  bool mask_from_cache = false;
  StageClock clock;
  const MaskStage mask = make_mask(ct, options, BakeCache(options.cache), mask_from_cache, progress);
  clock.end("segmented");
  BakedCt baked = bake_mask(ct, mask, options, progress);
  clock.take(baked.times);
  baked.times = clock.times();
  baked.mask_from_cache = mask_from_cache;
  return baked;
}

}  // namespace spinaltap
