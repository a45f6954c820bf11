#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/progress.h"
#include "core/ct/ct_volume.h"
#include "core/ct/level.h"
#include "core/ct/read_ct.h"
#include "core/segment/segment_spine.h"
#include "core/tool/drill_path.h"
#include "vdb/grid/bone_model.h"
#include "vdb/remaining/surface_block.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

/// Of the grid that is meshed for 3D: fine enough to look smooth, coarse enough for a processor to draw.
inline constexpr double kSurfaceVoxelMm = 0.5;

/// Which bone of a file, and how the file is read. The defaults fit files with one bone, and CTs without gaps.
struct OpenOptions {
  Level level = Level::kNone;     ///< of a spine.vdb, or to bake of a CT
  CtReadOptions reading{};        ///< of a CT
  std::optional<Vec3> seed_mm{};  ///< in the body of the vertebra to bake of a CT, patient LPS
  bool bakes_only_whole = true;   ///< without these: the vertebra of a CT, where but one is whole
};

/// A CT, or a bone, that the window shows: all of it is made in the background and then only read, from any thread.
struct OpenedBone {
  explicit OpenedBone(std::shared_ptr<const CtVolume> slices) : volume(std::move(slices)), ct(*volume) {}

  std::filesystem::path file;              ///< that was opened: a CT or a bone.vdb
  OpenOptions options;                     ///< with which it was
  std::optional<Bone> bone;                ///< grids, and walls with landmarks where they were found; none: a CT alone
  std::shared_ptr<const CtVolume> volume;  ///< bones of one CT share it
  const CtVolume& ct;                      ///< the same, for slices: the CT itself, or what the bone keeps of it
  bool is_whole_ct = false;                ///< the first of these: there may be other vertebrae in it

  std::vector<Neighbour> neighbours;  ///< the vertebrae beside the bone in its file

  /// All of the surface, for those who have none of it yet: as a RemainingBone of kSurfaceVoxelMm has it, which
  /// drilling then changes block by block.
  std::vector<SurfaceUpdate> surface;

  const BoneModel& model() const { return bone->model(); }
  /// Null where none were found.
  const Landmarks* landmarks() const { return bone && bone->no_landmarks().empty() ? &bone->landmarks() : nullptr; }
  /// What there is to look at: the bone, or without one the CT.
  Box3 bounds_mm() const;
};

/// What files hold, in the order in which a window takes them.
enum class FileKind { ct, bone, plan };
/// A folder, a NIfTI or a DICOM file is a CT; .vdb is a bone; .json is a plan or 3D Slicer's markups. Throws Error
/// where there is no such file.
FileKind kind_of_file(const std::filesystem::path& path);

/// Opens a baked bone; `level` says which of several. Throws Error as read_bone() does.
std::shared_ptr<const OpenedBone> open_bone(const std::filesystem::path& file, const Progress& progress = {},
                                            Level level = Level::kNone);

/// Reads a CT and no more: its slices can be looked at. Throws Error as read_ct() does.
std::shared_ptr<const OpenedBone> open_ct(const std::filesystem::path& path, const OpenOptions& options,
                                          const Progress& progress = {});

/// The vertebrae of an opened CT. The map of their labels is no larger than they are, for memory: its grid is a part of
/// the CT's. Throws Error as segment_spine() does.
SpineSegmentation find_levels(const OpenedBone& ct, const Progress& progress = {});

/// Bakes a vertebra that find_levels() found. Keeps the stages of the bake in `cache` (empty: keeps nothing),
/// which holds no more than kCacheBytes, for kCacheDays. Throws Error as bake_mask() does.
std::shared_ptr<const OpenedBone> bake_level(const OpenedBone& ct, const SpineSegmentation& found,
                                             const LevelReport& level, const std::filesystem::path& cache,
                                             const Progress& progress = {});
/// The same of the vertebra whose body holds a place (patient LPS, mm). Throws Error as bake_ct() does.
std::shared_ptr<const OpenedBone> bake_vertebra_at(const OpenedBone& ct, const Vec3& seed_mm,
                                                   const std::filesystem::path& cache, const Progress& progress = {});
inline constexpr std::uint64_t kCacheBytes = std::uint64_t{1} << 30U;
inline constexpr int kCacheDays = 60;

/// The place of the bone's outer surface that is nearest to a position (patient LPS, mm), to a few µm; the position
/// itself where it is not a number.
Vec3 stick_to_surface(const OpenedBone& bone, const Vec3& p_mm);

/// Where a surgeon would enter for a target: straight back from it, where the bone ends for good. The nearest place of
/// the surface where there is no bone that way.
Vec3 entry_behind(const OpenedBone& bone, const Vec3& target_mm);

}  // namespace spinaltap
