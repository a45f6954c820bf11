#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/common/bake_ct.h"
#include "apps/common/json_file.h"
#include "core/ct/read_ct.h"

namespace spinaltap {

/// The options of commands that read a CT and make a bone of it.
struct CtOptions {
  std::filesystem::path folder;  ///< or a file
  CtReadOptions reading;
  std::vector<double> crop_mm;   ///< empty, or two corners, patient LPS
  double crop_margin_mm = -1.0;  ///< around the label; below 0: no crop
  std::filesystem::path labels;
  std::string label = "1";  ///< a number of the map, or the name of a vertebra
  LabelConvention convention = LabelConvention::automatic;
  std::vector<double> seed_mm;  ///< empty or three numbers, patient LPS
  BakeCtOptions bake;

  /// Adds the options for reading: --series, --resample, --crop.
  void add_reading(CLI::App& app);
  /// Adds the options that say which bone is meant: --labels, --label, --convention, --crop-margin, --seed,
  /// --threshold.
  void add_choosing(CLI::App& app);
  /// Adds those, and the options for making a bone of it: --voxel, --point-spacing, --smoothing.
  void add_baking(CLI::App& app);

  CtVolume read(const Progress& progress) const;
  std::optional<Vec3> given_seed() const;
  /// What --labels and --label say. Throws Error where the label is neither a number nor a vertebra.
  LabelChoice label_choice() const;
  /// The options for baking, with the label map and the seed that were given.
  BakeCtOptions complete() const;
  ChosenBone choose(const CtVolume& ct, const Progress& progress) const;
  BakedCt make_bone(const CtVolume& ct, const Progress& progress) const;
};

/// Prints the figures of a baked CT and gives them as JSON.
Json report_baked(const CtVolume& ct, const BakedCt& baked);

}  // namespace spinaltap
