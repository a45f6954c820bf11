#include "core/base/error.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/detail/vdb_file.h"
#include "vdb/grid/bone_model.h"
#include "vdb/grid/spine_file.h"

namespace spinaltap {
namespace {

/// The one level of a file of several bones, where it has one only.
Level only_level(const std::vector<Level>& levels, const std::filesystem::path& path) {
  if (levels.size() == 1) return levels.front();
  fail("expected one bone, or a choice of one of its levels, found several in ", path.string(), ": ",
       level_names(levels));
}

void check_level(const BoneModel& bone, Level wanted, const std::filesystem::path& path) {
  if (wanted == Level::kNone) return;
  const auto recorded = bone.metadata().find("level");
  if (recorded == bone.metadata().end()) {
    fail("expected ", level_name(wanted), ", found a bone whose level is not known: ", path.string());
  }
  if (recorded->second != level_name(wanted)) {
    fail("expected ", level_name(wanted), ", found ", detail::printable(recorded->second), ": ", path.string());
  }
}

}  // namespace

void write_bone(const BoneModel& bone, const std::filesystem::path& path) {
  initialize_openvdb();
  openvdb::GridCPtrVec written;
  const auto add = [&](const char* name, const openvdb::FloatGrid& grid) {
    auto copy = grid.deepCopy();
    copy->setName(name);
    // Baking rounds to half floats, so this loses nothing; what was drilled since may need more.
    copy->setSaveFloatAsHalf(detail::fits_half_floats(*copy));
    written.push_back(copy);
    return copy;
  };
  const auto sdf = add("sdf", *bone.grids().sdf);
  sdf->setGridClass(openvdb::GRID_LEVEL_SET);
  detail::add_metadata(bone.metadata(), *sdf);
  add("hu", *bone.grids().hu);
  if (is_drilled(bone)) {
    add("before", *bone.grids().before)->setGridClass(openvdb::GRID_LEVEL_SET);
    add("hole", *bone.grids().hole)->setGridClass(openvdb::GRID_LEVEL_SET);
  }
  try {
    detail::write_vdb(path, written);
    // OpenVDB does not look whether its last bytes reached the disk; reading them back does.
    read_bone(path);
  } catch (const std::exception&) {
    // What OpenVDB says of its own broken file does not help; the cause is nearly always this one.
    fail_as(ErrorKind::disk, "cannot write ", path.filename().string(),
            ": is the disk full, or the folder not writable?");
  }
}

BoneModel read_bone(const std::filesystem::path& path, Level level) {
  detail::VdbFile file(path);
  if (file.metadata()[detail::kLevelsKey]) {
    const std::vector<Level> levels = levels_in(path);
    return read_spine_level(path, level == Level::kNone ? only_level(levels, path) : level).bone;
  }
  for (const char* name : {"sdf", "hu"}) {
    if (!file.has(name)) fail("expected the grids sdf and hu in ", path.string(), ", found no ", name);
  }
  auto grids = std::make_shared<detail::BoneGrids>();
  grids->sdf = file.read_floats("sdf");
  grids->hu = file.read_floats("hu");
  if (grids->sdf->getGridClass() != openvdb::GRID_LEVEL_SET || grids->sdf->activeVoxelCount() == 0) {
    fail("expected the grid sdf to be a level set that is not empty in ", path.string());
  }
  if (!grids->sdf->transform().isLinear() || !grids->sdf->hasUniformVoxels() || !grids->hu->transform().isLinear()) {
    fail("expected the grid sdf to have cubic voxels, and no perspective, in ", path.string());
  }
  const auto level_set = [&](const char* name) -> openvdb::FloatGrid::ConstPtr {
    if (!file.has(name)) return nullptr;
    const openvdb::FloatGrid::Ptr set = file.read_floats(name);
    if (set->getGridClass() != openvdb::GRID_LEVEL_SET || set->transform() != grids->sdf->transform() ||
        set->background() != grids->sdf->background()) {
      fail("expected the grid ", name, " to be a level set on the voxels of sdf in ", path.string());
    }
    return set;
  };
  grids->before = level_set("before");
  grids->hole = level_set("hole");
  if ((grids->before == nullptr) != (grids->hole == nullptr)) {
    fail("expected both grids of a drilled bone, before and hole, or none in ", path.string());
  }
  grids->metadata = detail::metadata_of(*grids->sdf, path);
  BoneModel bone = [&] {
    try {
      return BoneModel(grids);
    } catch (const Error& error) {
      fail("cannot read ", path.string(), ": ", error.what());
    }
  }();
  check_level(bone, level, path);
  return bone;
}

}  // namespace spinaltap
