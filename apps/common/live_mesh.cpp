#include "apps/common/live_mesh.h"

#include <array>

#include "core/sim/straight_ways.h"
#include "vdb/isosurface.h"
#include "vdb/subtract_bit.h"

namespace spinaltap {

LiveMesh::LiveMesh(const BoneModel& bone, const DrillBit& bit, double longest_jump_mm)
    : bone_(bone), bit_(bit), longest_jump_mm_(longest_jump_mm) {}

void LiveMesh::update(const ToolInput& input) {
  const std::array<ToolInput, 2> inputs{last_.value_or(input), input};
  last_ = input;
  one_thread_.execute([&] {
    bone_ = subtract_bit(bone_, bit_, straight_ways(inputs, bit_, longest_jump_mm_));
    mesh_ = bone_surface(bone_);
  });
}

}  // namespace spinaltap
