#include "tests/gui/phantom_bone.h"

#include "core/phantom/vertebra_ground_truth.h"
#include "tests/support/temporary_folder.h"
#include "vdb/bake/bake.h"

namespace spinaltap::test {

const std::filesystem::path& phantom_file() {
  static const TemporaryFolder folder;
  static const std::filesystem::path file = [] {
    const std::filesystem::path path = folder.path() / "phantom.vdb";
    write_bone(bake_solid(Vertebra(), {.voxel_mm = 0.4}, 60.0), path);
    return path;
  }();
  return file;
}

const std::shared_ptr<const OpenedBone>& phantom_bone() {
  static const std::shared_ptr<const OpenedBone> bone = open_bone(phantom_file());
  return bone;
}

std::vector<DrillPath> phantom_paths() {
  const VertebraGroundTruth ground_truth = vertebra_ground_truth(Vertebra());
  return {{"left", ground_truth.left.entry_mm, ground_truth.left.target_mm, {}},
          {"right", ground_truth.right.entry_mm, ground_truth.right.target_mm, {}}};
}

}  // namespace spinaltap::test
