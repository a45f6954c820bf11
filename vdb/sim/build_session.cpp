#include "vdb/sim/build_session.h"

#include <algorithm>
#include <vector>

#include "core/base/error.h"
#include "vdb/sim/bone_identity.h"
#include "vdb/sim/bone_path.h"

namespace spinaltap {
namespace {

/// What a session without a path knows the walls of: the bones, or where only a region is drilled, what lies within
/// ClearanceField::kReachMm of that.
Box3 box_about(std::span<const Bone> bones, const SessionSetup& setup) {
  Box3 box_mm;
  for (const Bone& bone : bones) box_mm.extend(bone.model().bounds_mm());
  if (setup.region_mm) {
    check_region(*setup.region_mm);
    const Vec3 around = Vec3::Constant(ClearanceField::kReachMm);
    box_mm = box_mm.intersection(Box3(setup.region_mm->min() - around, setup.region_mm->max() + around));
  }
  if (box_mm.isEmpty()) fail_as(ErrorKind::geometry, "region: expected bone in it, found none within 8 mm");
  return box_mm;
}

}  // namespace

DrillPath line_without_path(std::span<const Bone> bones, const SessionSetup& setup) {
  const Box3 box_mm = box_about(bones, setup);
  // Across a plate's width.
  Eigen::Index along = 0;
  setup.path.bit.width_along.cwiseAbs().minCoeff(&along);
  DrillPath line;
  line.name = "no path";
  line.bit = setup.path.bit;
  line.entry_mm = line.target_mm = box_mm.center();
  line.entry_mm[along] = box_mm.min()[along];
  line.target_mm[along] = box_mm.max()[along];
  return line;
}

BuiltSession build_session(const Bone& bone, const SessionSetup& setup, const Progress& progress,
                           const ScalarField* exact, const ClearanceField* clearances) {
  return build_session(std::span(&bone, 1), setup, progress, exact, clearances);
}

void name_bones(SessionSetup& setup, std::span<const Bone> bones) {
  if (bones.empty()) fail("expected a bone to drill, found none");
  setup.bone_hash = bones.front().hash();
  setup.bone = bones.front().identity();
  setup.further_bone_hashes.clear();
  for (const Bone& bone : bones.subspan(1)) {
    if (bone.hash() == setup.bone_hash || std::ranges::count(setup.further_bone_hashes, bone.hash()) > 0) {
      fail("expected bones that differ, found one twice");
    }
    setup.further_bone_hashes.push_back(bone.hash());
  }
}

BuiltSession build_session(std::span<const Bone> bones, const SessionSetup& setup, const Progress& progress,
                           const ScalarField* exact, const ClearanceField* clearances) {
  if (bones.size() != 1 + setup.further_bone_hashes.size()) {
    fail("expected ", 1 + setup.further_bone_hashes.size(), " bones to drill, found ", bones.size());
  }
  if (setup.options.has_path) {
    if (!setup.takes_other_ct && !setup.path.bone.is_empty()) check_path_is_of(setup.path, bones.front().identity());
    check_path_meets_bone(setup.path, bones.front().model());
  }
  std::vector<BoneModel> models;
  for (const Bone& bone : bones) models.push_back(bone.model());
  BuiltSession built;
  built.bone = DrilledBone(models, setup, exact, progress);
  if (setup.has_clearances && clearances != nullptr) {
    built.clearances = std::make_unique<ClearanceField>(clearances->with_entry_of(setup.path));
  } else if (setup.has_clearances) {
    std::vector<const WallDistance*> walls;
    for (const Bone& bone : bones) walls.push_back(&bone.walls(progress));
    built.clearances = setup.options.has_path
                           ? std::make_unique<ClearanceField>(walls, setup.path, progress)
                           : std::make_unique<ClearanceField>(walls, box_about(bones, setup), progress);
  }
  built.session = built.bone.begin_session(setup, built.clearances.get());
  return built;
}

}  // namespace spinaltap
