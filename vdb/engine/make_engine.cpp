#include "vdb/engine/make_engine.h"

#include "core/base/error.h"
#include "vdb/engine/leaf_engine.h"

namespace spinaltap {

std::unique_ptr<DrillEngine> make_engine(EngineKind kind, PointVolume& volume, const DrillBit& bit,
                                         const Material& material) {
  switch (kind) {
    case EngineKind::reference:
      return make_reference_engine(volume, bit, material);
    case EngineKind::arc:
      return make_arc_engine(volume, bit, material);
    case EngineKind::ring:
      return make_ring_engine(volume, bit, material);
    case EngineKind::leaf:
      return make_leaf_engine(volume, bit, material);
  }
  fail("no such drilling engine");
}

}  // namespace spinaltap
