#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/spinaltap/finding_options.h"
#include "core/ct/read_ct.h"
#include "core/files/json_file.h"
#include "vdb/sim/bake_ct.h"

namespace spinaltap {

/// The options of commands that read a CT and make a bone of it.
struct CtOptions {
  std::filesystem::path folder;  ///< or a file
  CtReadOptions reading;
  std::vector<double> crop_mm;   ///< empty, or two corners, patient LPS
  double crop_margin_mm = -1.0;  ///< around the label; below 0: no crop
  std::filesystem::path labels;
  std::string label;  ///< a number of the map, or the name of a vertebra; empty: the only one, or 1
  LabelConvention convention = LabelConvention::automatic;
  FindingOptions finding;
  BakeCtOptions bake;  ///< but for the label map and what `finding` says

  /// Adds the options for reading: --series, --resample, --crop.
  void add_reading(CLI::App& app);
  /// Adds the options that say which bone is meant: --labels, --label, --convention, --crop-margin, and those for
  /// finding it.
  void add_choosing(CLI::App& app);
  /// Adds those, and the options for making a bone of it: --voxel, --point-spacing, --smoothing.
  void add_baking(CLI::App& app);

  CtVolume read(const Progress& progress) const;
  /// All labels of the map. Throws Error as read_label_volume() does.
  LabelVolume read_labels(const CtVolume& ct) const;
  /// What --labels and --label say. Throws Error where the label is neither a number nor a vertebra.
  LabelChoice label_choice() const;
  /// The options for baking, with the label map, the seed and the corrections that were given.
  BakeCtOptions complete(const CtVolume& ct) const;
  ChosenBone choose(const CtVolume& ct, const Progress& progress) const;
  BakedCt make_bone(const CtVolume& ct, const Progress& progress) const;
};

/// Adds --convention: what the numbers of `labels` mean.
void add_convention(CLI::App& app, LabelConvention& convention, CLI::Option* labels);

/// Prints the figures of a baked CT, its level, warnings and severity, and gives them as JSON.
Json report_baked(const CtVolume& ct, const BakedCt& baked);

}  // namespace spinaltap
