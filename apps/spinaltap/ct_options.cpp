#include "apps/spinaltap/ct_options.h"

#include <algorithm>
#include <charconv>
#include <map>

#include "apps/spinaltap/command.h"
#include "apps/spinaltap/level_output.h"
#include "core/base/error.h"
#include "core/ct/crop.h"
#include "core/ct/label_frame.h"

namespace spinaltap {

void CtOptions::add_reading(CLI::App& app) {
  app.add_option("--series", reading.series,
                 "SeriesInstanceUID or number of the series, where the folder holds several")
      ->type_name("UID");
  app.add_option("--stack", reading.stack, "Which stack of the series, where it holds several acquisitions: see info")
      ->check(CLI::PositiveNumber)
      ->type_name("N");
  app.add_option("--hu-scale", reading.hu.scale,
                 "Multiply the CT's numbers by this, for who knows better than its files")
      ->capture_default_str()
      ->type_name("FACTOR");
  app.add_option("--hu-offset", reading.hu.offset, "Then add this, HU: -1024 for CT numbers + 1024")
      ->capture_default_str()
      ->type_name("HU");
  app.add_flag(
      "--resample", reading.resample,
      "Interpolate unequal slice steps, gaps of up to 6 mm and uneven sideways shifts instead of rejecting them");
  app.add_option("--affine", reading.affine,
                 "Which transform of a NIfTI CT or label map says where it lies, where the two differ: automatic\n"
                 "(default: the one that is sure), sform, qform; docs/reading.md")
      ->transform(one_of(std::map<std::string, NiftiAffine>{
          {"automatic", NiftiAffine::automatic}, {"sform", NiftiAffine::sform}, {"qform", NiftiAffine::qform}}))
      ->type_name("NAME");
  app.add_option("--crop", crop_mm, "Take only this box, patient LPS, mm")
      ->delimiter(',')
      ->expected(6)
      ->type_name("X0,Y0,Z0,X1,Y1,Z1");
}

void CtOptions::add_choosing(CLI::App& app) {
  CLI::Option* labels_option =
      app.add_option(
             "--labels", labels,
             "Label map that marks the bone: NIfTI, NRRD, MetaImage, DICOM SEG or RTSTRUCT; without it the vertebra is "
             "found")
          ->type_name("FILE");
  app.add_option(
         "--label", label,
         "Which label is the bone: its number in the map, or a vertebra such as L3; default: the only one, or 1")
      ->needs(labels_option)
      ->type_name("N|LEVEL");
  add_convention(app, convention, labels_option);
  app.add_option("--crop-margin", crop_margin_mm, "Take only the label's box and this much around it, mm")
      ->needs(labels_option)
      ->check(CLI::NonNegativeNumber)
      ->type_name("MM");
  finding.add_to(app, labels_option);
}

void CtOptions::add_baking(CLI::App& app) {
  add_choosing(app);
  app.add_option("--voxel", bake.bake.voxel_mm, "Voxel of the distance grid, mm")
      ->capture_default_str()
      ->type_name("MM");
  app.add_option("--point-spacing", bake.rbf.spacing_mm,
                 "Of surface points nearer to each other than this one is taken, mm; 0: all of them")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber)
      ->type_name("MM");
  app.add_option("--smoothing", bake.rbf.smoothing_mm,
                 "How far the surface may give way to smoothness, mm; 0: through all points")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber)
      ->type_name("MM");
}

CtVolume CtOptions::read(const Progress& progress) const {
  CtVolume ct = read_ct(folder, reading, progress);
  for (const std::string& note : ct.notes) print_figure("note", note);
  if (crop_mm.size() == 6) {
    const auto corner = [&](std::size_t n) { return Vec3(crop_mm[n], crop_mm[n + 1], crop_mm[n + 2]); };
    ct = crop(ct, block_in_box(ct.geometry, Box3(corner(0), corner(3))));
  }
  if (crop_margin_mm >= 0.0) {
    // A voxel at least: a bone on the border would look cut by it.
    const double margin_mm = std::max(crop_margin_mm, ct.geometry.spacing_mm.maxCoeff());
    ct = crop(ct, block_around(label_mask(label_choice(), ct.geometry), margin_mm));
  }
  return ct;
}

LabelVolume CtOptions::read_labels(const CtVolume& ct) const {
  LabelVolume volume = read_label_volume(labels, ct.geometry, {.convention = convention, .affine = reading.affine});
  if (const auto warning = warning_of_frame(labels, ct)) volume.warnings.push_back(*warning);
  return volume;
}

LabelChoice CtOptions::label_choice() const {
  LabelChoice choice{labels, 0, Level::kNone, convention, reading.affine};
  if (label.empty()) return choice;
  const char* const end = label.data() + label.size();
  const auto [stop, error] = std::from_chars(label.data(), end, choice.label);
  if (error == std::errc{} && stop == end) return choice;
  const std::optional<Level> level = level_from_name(label);
  if (!level) fail("expected a label's number, or a vertebra such as L3, found \"", label, "\"");
  choice.level = *level;
  return choice;
}

BakeCtOptions CtOptions::complete(const CtVolume& ct) const {
  BakeCtOptions options = bake;
  if (!labels.empty()) options.labels = label_choice();
  options.segment = finding.complete(ct);
  return options;
}

ChosenBone CtOptions::choose(const CtVolume& ct, const Progress& progress) const {
  const BakeCtOptions options = complete(ct);
  return choose_bone(ct, options.labels, options.segment, progress);
}

BakedCt CtOptions::make_bone(const CtVolume& ct, const Progress& progress) const {
  return bake_ct(ct, complete(ct), progress);
}

void add_convention(CLI::App& app, LabelConvention& convention, CLI::Option* labels) {
  std::string words;
  for (const auto& entry : label_conventions()) words += (words.empty() ? "" : ", ") + entry.first;
  app.add_option(
         "--convention", convention,
         "What the map's numbers mean, where it names no vertebrae: automatic (default: an error where several\n"
         "are possible) or one of " +
             words + "; docs/label-maps.md")
      ->transform(one_of(label_conventions()))
      ->needs(labels)
      ->type_name("NAME");
}

Json report_baked(const CtVolume& ct, const BakedCt& baked) {
  const Vec3 size_mm = baked.bone.bounds_mm().sizes();
  if (baked.level != Level::kNone) print_figure("vertebra", level_name(baked.level));
  if (!baked.level_source.empty()) print_figure("vertebra known by", baked.level_source);
  if (const auto mask = baked.bone.metadata().find("mask"); mask != baked.bone.metadata().end()) {
    print_figure("taken", mask->second);
  }
  print_figure("CT voxels", static_cast<double>(ct.geometry.voxel_count()), "", 0);
  print_figure("bone voxels", static_cast<double>(baked.mask_voxels), "", 0);
  print_figure("surface points", static_cast<double>(baked.fit.points), "", 0);
  print_figure("RBF centres", static_cast<double>(baked.fit.centres), "", 0);
  print_figure("surface points missed by, mean", baked.fit.mean_residual_mm, "mm", 3);
  print_figure("surface points missed by, 99 %", baked.fit.p99_residual_mm, "mm", 3);
  print_figure("grid voxels", static_cast<double>(baked.bone.active_voxels()), "", 0);
  print_figure("pieces dropped", static_cast<double>(baked.bake.dropped_pieces), "", 0);
  print_figure("bone, across", size_mm.x(), "mm", 1);
  print_figure("bone, front to back", size_mm.y(), "mm", 1);
  print_figure("bone, top to bottom", size_mm.z(), "mm", 1);
  Json figures{{"ct_voxels", ct.geometry.voxel_count()},
               {"ct_hash", ct.source_hash},
               {"mask_from_cache", baked.mask_from_cache},
               {"fit_from_cache", baked.fit_from_cache},
               {"bone_voxels", baked.mask_voxels},
               {"surface_points", baked.fit.points},
               {"off_surface_points", baked.fit.off_surface_points},
               {"rbf_centres", baked.fit.centres},
               {"mean_residual_mm", baked.fit.mean_residual_mm},
               {"p99_residual_mm", baked.fit.p99_residual_mm},
               {"max_residual_mm", baked.fit.max_residual_mm},
               {"evaluations", baked.bake.evaluations},
               {"active_voxels", baked.bone.active_voxels()},
               {"dropped_pieces", baked.bake.dropped_pieces},
               {"size_mm", to_json(size_mm)}};
  if (baked.level != Level::kNone) figures["level"] = level_name(baked.level);
  if (!baked.level_source.empty()) figures["level_source"] = baked.level_source;
  if (baked.warnings) {
    print_warnings(*baked.warnings);
    figures["warnings"] = baked.warnings->warnings;
    figures["severity"] = baked.warnings->severity;
  }
  return figures;
}

}  // namespace spinaltap
