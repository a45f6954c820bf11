#include "core/engine/drill_engine.h"

namespace spinaltap {

const std::map<std::string, EngineKind>& engine_kinds() {
  static const std::map<std::string, EngineKind> kinds{{"reference", EngineKind::reference},
                                                       {"arc", EngineKind::arc},
                                                       {"ring", EngineKind::ring},
                                                       {"leaf", EngineKind::leaf},
                                                       {"voxel", EngineKind::voxel}};
  return kinds;
}

}  // namespace spinaltap
