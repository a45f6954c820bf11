#include "vdb/sim/build_session.h"

#include "vdb/sim/bone_path.h"

namespace spinaltap {

BuiltSession build_session(const Bone& bone, const SessionSetup& setup, const Progress& progress,
                           const ScalarField* exact, const ClearanceField* clearances) {
  check_path_meets_bone(setup.path, bone.model());
  BuiltSession built;
  built.bone = DrilledBone(bone.model(), setup, exact, progress);
  if (setup.has_clearances) {
    built.clearances = clearances != nullptr
                           ? std::make_unique<ClearanceField>(clearances->with_entry_of(setup.path))
                           : std::make_unique<ClearanceField>(bone.walls(progress), setup.path, progress);
  }
  built.session = built.bone.begin_session(setup, built.clearances.get());
  return built;
}

ToolInput cutting_input(const Cycle& cycle, const SessionOptions& options) {
  ToolInput input = cycle.input;
  input.spindle_on = input.spindle_on && options.spindle.rpm > 0.0;
  return input;
}

DrilledHole hole_of(std::span<const ToolInput> inputs, const SessionSetup& setup) {
  return drilled_hole(inputs, setup.path.bit, setup.options.max_jump_mm);
}

}  // namespace spinaltap
