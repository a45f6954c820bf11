#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/base/staged_output.h"
#include "core/ct/label_volume.h"
#include "vdb/grid/spine_file.h"
#include "vdb/sim/bake_ct.h"

namespace spinaltap {

struct BakeLevelsOptions {
  BakeCtOptions bake;  ///< but for `labels` and `segment`
  /// Go into the bones' notes and metadata; levels that are not in it are compared with the CT, as of a foreign map.
  std::map<Level, LevelWarnings> warnings;
  bool finds_landmarks = true;  ///< into the notes too; seconds a level
  bool is_strict = false;       ///< throw where a level cannot be baked, instead of leaving it out
};

struct BakedLevel {
  Level level = Level::kNone;
  BakedCt baked;
  LevelNotes notes;
};

struct SkippedLevel {
  Level level = Level::kNone;
  std::string reason;
};

struct BakedLevels {
  std::vector<BakedLevel> levels;     ///< from the head down
  std::vector<SkippedLevel> skipped;  ///< likewise
};

/// Whether the bone reaches the border of its CT, so that part of it may be missing.
bool reaches_border(const BoneMask& mask);

/// Bakes each level of a label map on the CT's grid, one after the other; each as bake_ct() bakes it alone, bit for
/// bit. Levels that the CT's border cuts, and those that cannot be baked, are left out. Throws Error when the map has
/// no level or none is left, and where `options.is_strict` says so.
BakedLevels bake_levels(const CtVolume& ct, const LabelVolume& labels, const BakeLevelsOptions& options = {},
                        const Progress& progress = {});

/// Writes the bones: into one spine.vdb where `output` ends in .vdb, else into a folder of that name, T11.vdb, ...
/// Throws Error as write_spine() and write_bone() do.
void write_levels(const BakedLevels& baked, const std::filesystem::path& output, StagedOutput& staged);

}  // namespace spinaltap
