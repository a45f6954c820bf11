#include "core/base/error.h"
#include "core/base/hash.h"
#include "vdb/bone_model.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/detail/vdb_file.h"
#include "vdb/initialize.h"

namespace spinaltap {
namespace {

/// Whether a file of half floats gives every value back.
bool fits_half_floats(const openvdb::FloatGrid& grid) {
  const auto fits = [](float value) { return detail::rounded_to_half(value) == value; };
  for (auto value = grid.cbeginValueAll(); value; ++value) {
    if (!fits(*value)) return false;
  }
  return fits(grid.background());
}

std::string hash_of(const BoneModel& bone) {
  Fnv1a hash;
  for (const auto& grid : {bone.grids().sdf, bone.grids().hu, bone.grids().before, bone.grids().hole}) {
    if (grid == nullptr) continue;
    for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf) {
      hash.add(leaf->origin().data(), 3 * sizeof(openvdb::Int32));
      hash.add(leaf->buffer().data(), openvdb::FloatTree::LeafNodeType::SIZE * sizeof(float));
    }
  }
  return hash.hex();
}

}  // namespace

void write_bone(const BoneModel& bone, const std::filesystem::path& path) {
  initialize_openvdb();
  openvdb::GridCPtrVec written;
  const auto add = [&](const char* name, const openvdb::FloatGrid& grid) {
    auto copy = grid.deepCopy();
    copy->setName(name);
    // Baking rounds to half floats, so this loses nothing; what was drilled since may need more.
    copy->setSaveFloatAsHalf(fits_half_floats(*copy));
    written.push_back(copy);
    return copy;
  };
  const auto sdf = add("sdf", *bone.grids().sdf);
  sdf->setGridClass(openvdb::GRID_LEVEL_SET);
  for (const auto& [key, value] : bone.facts()) {
    sdf->insertMeta(detail::kFactPrefix + key, openvdb::StringMetadata(value));
  }
  add("hu", *bone.grids().hu);
  if (is_drilled(bone)) {
    add("before", *bone.grids().before)->setGridClass(openvdb::GRID_LEVEL_SET);
    add("hole", *bone.grids().hole)->setGridClass(openvdb::GRID_LEVEL_SET);
  }
  try {
    detail::write_vdb(path, written, hash_of(bone));
    // OpenVDB does not look whether its last bytes reached the disk; reading them back does.
    read_bone(path);
  } catch (const std::exception&) {
    // What OpenVDB says of its own broken file does not help; the cause is nearly always this one.
    fail("cannot write ", path.filename().string(), ": is the disk full, or the folder not writable?");
  }
}

BoneModel read_bone(const std::filesystem::path& path) {
  const openvdb::GridPtrVecPtr found = detail::read_vdb(path);
  const auto grid = [&](const char* name) {
    const auto at = openvdb::findGridByName(*found, name);
    if (!at) fail("expected the grids sdf and hu in ", path.string(), ", found no ", name);
    return openvdb::gridPtrCast<openvdb::FloatGrid>(at);
  };
  auto grids = std::make_shared<detail::BoneGrids>();
  grids->sdf = grid("sdf");
  grids->hu = grid("hu");
  if (!grids->sdf || !grids->hu) fail("expected grids of floats in ", path.string());
  if (grids->sdf->getGridClass() != openvdb::GRID_LEVEL_SET || grids->sdf->activeVoxelCount() == 0) {
    fail("expected the grid sdf to be a level set that is not empty in ", path.string());
  }
  if (!grids->sdf->transform().isLinear() || !grids->sdf->hasUniformVoxels() || !grids->hu->transform().isLinear()) {
    fail("expected the grid sdf to have cubic voxels, and no perspective, in ", path.string());
  }
  const auto level_set = [&](const char* name) -> openvdb::FloatGrid::ConstPtr {
    const auto at = openvdb::findGridByName(*found, name);
    if (!at) return nullptr;
    const auto set = openvdb::gridPtrCast<openvdb::FloatGrid>(at);
    if (!set || set->getGridClass() != openvdb::GRID_LEVEL_SET || set->transform() != grids->sdf->transform() ||
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
  const std::string prefix = detail::kFactPrefix;
  for (auto meta = grids->sdf->beginMeta(); meta != grids->sdf->endMeta(); ++meta) {
    if (meta->first.rfind(prefix, 0) == 0) grids->facts[meta->first.substr(prefix.size())] = meta->second->str();
  }
  try {
    return BoneModel(grids);
  } catch (const Error& error) {
    fail("cannot read ", path.string(), ": ", error.what());
  }
}

}  // namespace spinaltap
