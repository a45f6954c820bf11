#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/ct/level.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// What is known of a level beside its grids.
struct LevelNotes {
  std::vector<std::string> warnings;  ///< one line each
  double severity = 0.0;              ///< 0: none, to 1: likely wrong, as whoever marked the bone judged
  std::string landmarks;              ///< JSON, docs/planning.md; empty where none were found
  std::string no_landmarks;           ///< why there are none
};

/// One bone of several in a spine.vdb. Its metadata "level" is the level's name.
struct SpineBone {
  Level level = Level::kNone;
  BoneModel bone;
  LevelNotes notes;
};

/// Writes spine.vdb to `path`, which must be a staged (temporary) name: the grids `sdf_T11`, ... of each bone, one grid
/// `hu` of all their CT numbers, and `part_T11`, ...: which of its voxels belong to each. docs/bone-vdb.md has the
/// format. The same bones give the same bytes. Throws Error where the bones are not of one CT, one is drilled, a level
/// is none or comes twice, and when the disk is full.
void write_spine(std::span<const SpineBone> bones, const std::filesystem::path& path);

/// The levels in a spine.vdb, from the head down; reads no grid. Empty for a bone.vdb. Throws Error on a missing or
/// damaged file.
std::vector<Level> levels_in(const std::filesystem::path& path);

/// Reads one bone; the grids of the others stay in the file. It is the bone that was written, grid for grid, and
/// bone_hash() of it the same. Throws Error on a missing or damaged file and, with the levels that there are, where
/// the level is not among them.
SpineBone read_spine_level(const std::filesystem::path& path, Level level);

/// "T11, T12, L1"
std::string level_names(std::span<const Level> levels);

}  // namespace spinaltap
