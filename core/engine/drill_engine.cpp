#include "core/engine/drill_engine.h"

#include "core/base/error.h"

namespace spinaltap {

const std::map<std::string, EngineKind>& engine_kinds() {
  static const std::map<std::string, EngineKind> kinds{
      {"auto", EngineKind::automatic}, {"reference", EngineKind::reference}, {"arc", EngineKind::arc},
      {"ring", EngineKind::ring},      {"leaf", EngineKind::leaf},           {"voxel", EngineKind::voxel}};
  return kinds;
}

std::string name_of(EngineKind kind) {
  for (const auto& [name, one] : engine_kinds()) {
    if (one == kind) return name;
  }
  fail_as(ErrorKind::internal, "no such drilling engine");
}

}  // namespace spinaltap
