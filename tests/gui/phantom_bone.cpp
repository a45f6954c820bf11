#include "tests/gui/phantom_bone.h"

#include <utility>

#include "core/ct/dicom_write.h"
#include "core/phantom/vertebra_ground_truth.h"
#include "tests/support/spine_scan.h"
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

const std::filesystem::path& spine_folder() {
  static const TemporaryFolder folder;
  static const std::filesystem::path ct = [] {
    SpineOptions options;
    options.first = Level{18};
    options.last = Level{21};
    std::filesystem::create_directory(folder.path() / "spine");
    write_dicom(scan_spine(Spine(options)), folder.path() / "spine");
    return folder.path() / "spine";
  }();
  return ct;
}

DrillPath burr_path() {
  DrillPath path = phantom_paths().front();
  path.bit = {4.0, 60.0, 2.0, BitShape::round_burr, 0.0, 2.0};
  return path;
}

Milling entry_milling() {
  const DrillPath path = burr_path();
  const Vec3 aside = any_perpendicular(path.direction()), up = path.direction().cross(aside);
  Milling milling;
  milling.name = "patch";
  for (const auto& [x, y] : {std::pair{-2.0, -2.0}, {2.0, -2.0}, {2.0, 2.0}, {-2.0, 2.0}}) {
    milling.outline_mm.push_back(path.entry_mm + x * aside + y * up);
  }
  milling.into = path.direction();
  milling.depth_mm = 1.0;
  return milling;
}

}  // namespace spinaltap::test
