#pragma once

#include <map>
#include <memory>
#include <string>

#include "core/drill/drill_engine.h"

namespace spinaltap {

/// The drilling engines. All remove the same points; docs/drilling-engine.md says which is fast where.
enum class EngineKind { reference, arc, ring, leaf };

/// Engines by the names that they have in options and reports.
const std::map<std::string, EngineKind>& engine_kinds();

std::unique_ptr<DrillEngine> make_engine(EngineKind kind, PointVolume& volume, const DrillBit& bit,
                                         const Material& material);

}  // namespace spinaltap
