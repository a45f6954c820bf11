#include "apps/common/bake_ct.h"

#include <algorithm>
#include <map>
#include <sstream>

#include "core/base/version.h"
#include "core/ct/label_map.h"

namespace spinaltap {

ChosenBone choose_bone(const CtVolume& ct, const std::optional<LabelChoice>& labels, const SegmentOptions& options,
                       const Progress& progress) {
  if (labels) return {read_label_map(labels->file, labels->label, ct.geometry), std::nullopt};
  Segmentation segmentation = segment_vertebra(ct, options, progress);
  return {std::move(segmentation.mask), segmentation.report};
}

BakedCt bake_ct(const CtVolume& ct, const BakeCtOptions& options, const Progress& progress) {
  const auto [mask, report_of_mask] = choose_bone(ct, options.labels, options.segment, progress);
  const SurfacePoints surface = extract_surface(ct, mask, options.surface, progress);
  const SurfaceFit fit = fit_surface(surface, options.rbf, progress);

  const auto text = [](const auto&... parts) {
    std::ostringstream out;
    (out << ... << parts);
    return out.str();
  };
  const std::map<std::string, std::string> facts{
      {"version", version()},
      {"source_hash", ct.source_hash},
      {"mask", options.labels ? text("label ", options.labels->label)
                              : text("threshold ", report_of_mask->threshold_hu, " HU")},
      {"surface_points", text(fit.report.points)},
      {"off_surface_points", text(fit.report.off_surface_points)},
      {"rbf_centres", text(fit.report.centres)},
      {"smoothing_mm", text(options.rbf.smoothing_mm)},
      {"rbf_mean_residual_mm", text(fit.report.mean_residual_mm)},
      {"rbf_max_residual_mm", text(fit.report.max_residual_mm)},
  };
  BakeReport report;
  const BoneModel bone = bake_bone(fit.field, surface.positions_mm, ct, options.bake, facts, &report, progress);
  const auto mask_voxels =
      static_cast<std::size_t>(std::count(mask.inside.begin(), mask.inside.end(), std::uint8_t{1}));
  return {bone, mask_voxels, fit.report, report};
}

}  // namespace spinaltap
