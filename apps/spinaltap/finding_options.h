#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <optional>
#include <vector>

#include "core/segment/warning_metadata.h"

namespace spinaltap {

/// The options of commands that find vertebrae in a CT: --seed, --level, --include, --exclude, --strokes, --threshold,
/// --accept-warnings.
struct FindingOptions {
  std::vector<double> seed_mm;    ///< empty or three numbers, patient LPS
  SegmentOptions segment;         ///< but for seed and strokes
  std::filesystem::path strokes;  ///< a label map of corrections; empty: none
  bool accepts_warnings = false;

  /// None of them goes with `labels`, a label map that marks the bone.
  void add_to(CLI::App& app, CLI::Option* labels);

  std::optional<Vec3> given_seed() const;
  /// With the seed and the strokes, which are read here.
  SegmentOptions complete(const CtVolume& ct) const;
};

}  // namespace spinaltap
