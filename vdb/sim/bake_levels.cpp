#include "vdb/sim/bake_levels.h"

#include <algorithm>
#include <memory>

#include "core/anatomy/bone_shape.h"
#include "core/anatomy/landmarks.h"
#include "core/base/error.h"
#include "core/files/landmarks_text.h"
#include "vdb/grid/bone_field.h"
#include "vdb/grid/bone_model.h"
#include "vdb/sim/label_warnings.h"

namespace spinaltap {
namespace {

/// "T11 (2 of 5), surface points": stages of one level among others.
Progress progress_of_level(const Progress& progress, Level level, std::size_t n, std::size_t count) {
  const std::string prefix = level_name(level) + " (" + std::to_string(n) + " of " + std::to_string(count) + "), ";
  return Progress([progress, prefix](std::string_view stage, double fraction) {
    progress.report(prefix + std::string(stage), fraction);
  });
}

void add_landmarks(const BoneModel& bone, const Progress& progress, LevelNotes& notes) {
  try {
    const BoneShape shape(std::make_shared<BoneField>(bone), bone.bounds_mm(), bone.voxel_mm(), progress);
    const Landmarks landmarks = find_landmarks(shape, progress);
    notes.landmarks = landmarks_text(landmarks);
    notes.warnings.insert(notes.warnings.end(), landmarks.warnings.begin(), landmarks.warnings.end());
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    notes.no_landmarks = error.what();
  }
}

std::string list_of(const std::vector<SkippedLevel>& skipped) {
  std::string text;
  for (const SkippedLevel& one : skipped)
    text += (text.empty() ? "" : "; ") + level_name(one.level) + ": " + one.reason;
  return text;
}

}  // namespace

bool reaches_border(const BoneMask& mask) {
  const std::array<int, 3>& size = mask.geometry.size;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      const bool is_end = k == 0 || k == size[2] - 1 || j == 0 || j == size[1] - 1;
      const int step = is_end ? 1 : std::max(1, size[0] - 1);
      for (int i = 0; i < size[0]; i += step) {
        if (mask.at(i, j, k)) return true;
      }
    }
  }
  return false;
}

BakedLevels bake_levels(const CtVolume& ct, const LabelVolume& labels, const BakeLevelsOptions& options,
                        const Progress& progress) {
  if (labels.geometry.size != ct.geometry.size || labels.geometry.origin_mm != ct.geometry.origin_mm ||
      labels.geometry.spacing_mm != ct.geometry.spacing_mm || labels.geometry.directions != ct.geometry.directions) {
    fail("expected the label map on the CT's grid, found it on another");
  }
  const std::vector<Level> levels = levels_of(labels);
  if (levels.empty()) fail("expected vertebrae in the label map, found no label that is known to be one");
  BakedLevels result;
  const auto skip = [&](Level level, const std::string& reason) {
    if (options.is_strict) fail(level_name(level), ": ", reason);
    result.skipped.push_back({level, reason});
  };
  // Before the work: it may be for nothing.
  std::vector<Level> whole;
  for (const Level level : levels) {
    if (reaches_border(mask_of(labels, level))) {
      skip(level, "cut by the CT's border");
    } else {
      whole.push_back(level);
    }
  }
  for (std::size_t n = 0; n < whole.size(); ++n) {
    const Level level = whole[n];
    const int label = *label_of(labels, level);
    MaskStage mask{mask_of(labels, label), "label " + std::to_string(label), level, std::nullopt, labels.level_source};
    const Progress of_level = progress_of_level(progress, level, n + 1, whole.size());
    LevelNotes notes;
    if (const auto found = options.warnings.find(level); found != options.warnings.end()) {
      mask.warnings = found->second;
      notes.warnings = found->second.warnings;
      notes.severity = found->second.severity;
    }
    try {
      if (!mask.warnings) {
        LevelWarnings of_label = warnings_of_label(ct, mask.mask, level, labels.warnings, of_level);
        notes.warnings = of_label.warnings;
        notes.severity = of_label.severity;
        if (!of_label.warnings.empty()) mask.warnings = std::move(of_label);
      }
      const BakedCt baked = bake_mask(ct, mask, options.bake, of_level);
      if (options.finds_landmarks) add_landmarks(baked.bone, of_level, notes);
      result.levels.push_back({level, baked, notes});
    } catch (const Cancelled&) {
      throw;
    } catch (const Error& error) {
      skip(level, error.what());
    }
  }
  std::sort(result.skipped.begin(), result.skipped.end(),
            [](const SkippedLevel& a, const SkippedLevel& b) { return level_rank(a.level) < level_rank(b.level); });
  if (result.levels.empty()) fail("expected a level that can be baked, found none: ", list_of(result.skipped));
  return result;
}

void write_levels(const BakedLevels& baked, const std::filesystem::path& output, StagedOutput& staged) {
  if (output.extension() != ".vdb") {
    for (const BakedLevel& one : baked.levels) {
      write_bone(one.baked.bone, staged.stage(output / (level_name(one.level) + ".vdb")));
    }
    return;
  }
  std::vector<SpineBone> bones;
  for (const BakedLevel& one : baked.levels) bones.push_back({one.level, one.baked.bone, one.notes});
  write_spine(bones, staged.stage(output));
}

}  // namespace spinaltap
