#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/base/progress.h"
#include "core/plan/suggest.h"

namespace spinaltap {

struct AutoPlanOptions {
  std::filesystem::path screws = {};  ///< table of sizes; empty: the shipped screws/pedicle.json
  std::filesystem::path rules = {};   ///< margins and weights; empty: the shipped planning/pedicle.json
  /// Of bone around the screw: this and no less; nothing: that of the rules, less in narrow pedicles.
  std::optional<double> margin_mm = {};
  bool is_bicortical = false;  ///< see SuggestOptions, as the next four
  SagittalReference sagittal = SagittalReference::anatomic;
  std::optional<Technique> technique = {};
  Level level = Level::kNone;           ///< kNone: Bone::suggest() takes the bone's own
  DrillBit bit = {};                    ///< for the holes
  std::filesystem::path density = {};   ///< calibration; empty: the shipped densities/vertebra.json
  std::filesystem::path material = {};  ///< cutting model; empty: the shipped materials/vertebra.json
};

/// The files that suggestions follow from: rules, screws, density and material.
std::array<std::filesystem::path, 4> files_of(const AutoPlanOptions& options);

/// suggest_paths() with tables and models from files.
std::vector<Suggestion> auto_plan(const WallDistance& walls, const HuSampler& hu, const AutoPlanOptions& options = {},
                                  const Progress& progress = {});

/// The paths among suggestions. Throws Error that says why there is none, where there is none.
std::vector<DrillPath> paths_of(const std::vector<Suggestion>& suggestions);

}  // namespace spinaltap
