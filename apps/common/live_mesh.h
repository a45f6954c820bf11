#pragma once

#include <cstddef>
#include <optional>

#include <tbb/task_arena.h>

#include "core/base/triangle_mesh.h"
#include "core/sim/tool_source.h"
#include "vdb/bone_model.h"

namespace spinaltap {

/// The bone's surface as it now is, for a display beside a drilling: at each update the bit's way since the last is cut
/// out and the whole surface meshed again. On the calling thread alone, so that other threads keep their cores.
class LiveMesh {
 public:
  LiveMesh(const BoneModel& bone, const DrillBit& bit, double longest_jump_mm);

  /// Where the bit has come to.
  void update(const ToolInput& input);
  /// As of the last update; empty before the first.
  const TriangleMesh& mesh() const { return mesh_; }

 private:
  BoneModel bone_;
  DrillBit bit_;
  double longest_jump_mm_;
  std::optional<ToolInput> last_;
  TriangleMesh mesh_;
  tbb::task_arena one_thread_{1};
};

}  // namespace spinaltap
