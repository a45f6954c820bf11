#pragma once

#include <memory>

#include "core/engine/drill_engine.h"
#include "core/engine/engine_kind.h"

namespace spinaltap {

/// The engine of a kind, also of those that stand on a VDB tree.
std::unique_ptr<DrillEngine> make_engine(EngineKind kind, PointVolume& volume, const DrillBit& bit,
                                         const Material& material);

}  // namespace spinaltap
