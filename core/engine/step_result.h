#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "core/base/geometry.h"

namespace spinaltap {

/// The drilling engines. Those of points remove the same points of a cylinder along the path; `voxel` mills voxels of
/// the bone; `automatic` ("auto") is one of these, which a session takes by what it is to drill
/// (core/session/choose_engine.h). docs/drilling-engine.md says which is fast where.
enum class EngineKind { automatic, reference, arc, ring, leaf, voxel };

/// Engines by the names that they have in options and reports.
const std::map<std::string, EngineKind>& engine_kinds();
/// "auto", "reference", "arc", "ring", "leaf", "voxel".
std::string name_of(EngineKind kind);

/// What one move of the bit did.
struct StepResult {
  std::size_t removed = 0;      ///< points that died
  std::size_t tested = 0;       ///< points put to a test of their position
  std::int64_t removed_hu = 0;  ///< sum of their CT numbers
  double removed_mm3 = 0.0;     ///< what they stood for
  double work_n_mm = 0.0;       ///< energy of cutting them at the material's reference feed
  /// Sum over them of that energy times the place, from the tip where the step ends to the point, N·mm²; along the axes
  /// of patient LPS. Its part across the bit's axis tells on which side the bit cut.
  Vec3 moment_n_mm2 = Vec3::Zero();
  /// Of a step that turned the bit: that energy by how far back from the tip along the axis the points lay where the
  /// step ended, in sixteenths of the bit's length; what is beyond counts in the first and the last. Else all 0: all of
  /// the bit moved alike.
  static constexpr std::size_t kBackParts = 16;
  std::array<double, kBackParts> work_back_n_mm{};
};

}  // namespace spinaltap
