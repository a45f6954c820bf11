#include "vdb/sim/build_session.h"

#include "core/engine/volume_segments.h"
#include "vdb/engine/make_engine.h"
#include "vdb/remaining/subtract_bit.h"
#include "vdb/sim/bone_path.h"
#include "vdb/sim/detail/bone_volumes.h"

namespace spinaltap {

namespace {

void drill_out(PointVolume& volume, const SessionSetup& setup) {
  for (const DrilledHole& hole : setup.holes) {
    const std::unique_ptr<DrillEngine> engine = make_engine(setup.engine, volume, hole.bit, setup.material);
    for (const BitWay& way : hole.ways) {
      engine->reset_motion();
      engine->step(way.start);
      engine->step(way.end);
    }
  }
}

}  // namespace

BuiltSession build_session(const Bone& bone, const SessionSetup& setup, const Progress& progress,
                           const ScalarField* exact, const ClearanceField* clearances) {
  check_path_meets_bone(setup.path, bone.model());
  BuiltSession built;
  built.volumes = volumes_along(bone.model(), setup.path, setup.volume,
                                {setup.fine_spacing_mm, setup.fine_near_mm, setup.fine_tip_mm});
  std::vector<std::unique_ptr<DrillEngine>> engines;
  for (PointVolume& volume : built.volumes) {
    fill_volume(volume, sampler_of(bone.model(), exact), progress);
    drill_out(volume, setup);
    engines.push_back(make_engine(setup.engine, volume, setup.path.bit, setup.material));
  }
  if (setup.has_clearances) {
    built.clearances = clearances != nullptr
                           ? std::make_unique<ClearanceField>(clearances->with_entry_of(setup.path))
                           : std::make_unique<ClearanceField>(bone.walls(progress), setup.path, progress);
  }
  built.session = std::make_unique<DrillSession>(setup.path, built.volumes, make_joint_engine(std::move(engines)),
                                                 setup.material, built.clearances.get(), setup.options);
  return built;
}

ToolInput cutting_input(const Cycle& cycle, const SessionOptions& options) {
  ToolInput input = cycle.input;
  input.spindle_on = input.spindle_on && options.spindle.rpm > 0.0;
  return input;
}

DrilledHole hole_of(std::span<const ToolInput> inputs, const SessionSetup& setup) {
  return {setup.path.bit, straight_ways(inputs, setup.path.bit, setup.options.max_jump_mm)};
}

BoneModel without_holes(BoneModel bone, std::span<const DrilledHole> holes) {
  for (const DrilledHole& hole : holes) bone = subtract_bit(bone, hole.bit, hole.ways);
  return bone;
}

}  // namespace spinaltap
