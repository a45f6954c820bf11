#include "vdb/engine/make_engine.h"

#include <vector>

#include "core/base/error.h"
#include "core/engine/volume_segments.h"
#include "vdb/engine/detail/leaf_volume_engine.h"
#include "vdb/engine/detail/shared_points.h"

namespace spinaltap {

std::unique_ptr<DrillEngine> make_leaf_engine(PointVolume& volume, const DrillBit& bit, const Material& material) {
  return std::make_unique<detail::LeafVolumeEngine>(volume, bit, material);
}

std::unique_ptr<DrillEngine> make_leaf_engine(std::span<PointVolume* const> volumes, const DrillBit& bit,
                                              const Material& material) {
  if (volumes.empty()) fail("leaf engine: expected at least one volume");
  drop_shared_points(volumes);
  std::vector<std::unique_ptr<DrillEngine>> engines;
  for (PointVolume* volume : volumes) engines.push_back(make_leaf_engine(*volume, bit, material));
  return make_joint_engine(std::move(engines));
}

std::unique_ptr<DrillEngine> make_engine(EngineKind kind, PointVolume& volume, const DrillBit& bit,
                                         const Material& material) {
  switch (kind) {
    case EngineKind::automatic:
      fail("expected an engine for points, found auto, which is chosen for a session");
    case EngineKind::reference:
      return make_reference_engine(volume, bit, material);
    case EngineKind::arc:
      return make_arc_engine(volume, bit, material);
    case EngineKind::ring:
      return make_ring_engine(volume, bit, material);
    case EngineKind::leaf:
      return make_leaf_engine(volume, bit, material);
    case EngineKind::voxel:
      fail("expected an engine for points, found voxel, which mills a bone's voxels");
  }
  fail_as(ErrorKind::internal, "no such drilling engine");
}

}  // namespace spinaltap
