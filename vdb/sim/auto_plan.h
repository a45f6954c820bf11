#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/anatomy/wall_distance.h"
#include "core/base/progress.h"
#include "core/plan/suggest.h"

namespace spinaltap {

/// The files that suggestions follow from: rules, screws, density and material.
std::array<std::filesystem::path, 4> files_of(const AutoPlanOptions& options);

/// suggest_paths() with tables and models from files.
std::vector<Suggestion> auto_plan(const WallDistance& walls, const HuSampler& hu, const AutoPlanOptions& options = {},
                                  const Progress& progress = {});

}  // namespace spinaltap
