#pragma once

#include <map>
#include <string>

namespace spinaltap {

/// The drilling engines. All remove the same points; docs/drilling-engine.md says which is fast where.
enum class EngineKind { reference, arc, ring, leaf };

/// Engines by the names that they have in options and reports.
const std::map<std::string, EngineKind>& engine_kinds();

}  // namespace spinaltap
