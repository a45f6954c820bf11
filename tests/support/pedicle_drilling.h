#pragma once

#include <cstdio>
#include <optional>
#include <vector>

#include "core/phantom/vertebra.h"
#include "core/phantom/vertebra_ground_truth.h"
#include "core/session/drill_session.h"
#include "core/session/operator/path_motion.h"

namespace spinaltap::test {

/// Where a line through the phantom's pedicle and on through the body meets its layers, mm beyond the entry.
struct TrueBoundaries {
  double outer_mm = 0.0;       ///< the surface at the entry
  double cortex_end_mm = 0.0;  ///< of the cortex there
  double far_cortex_mm = 0.0;  ///< begin of the last cortex before the bone ends
  double end_mm = 0.0;         ///< of the bone
};

/// Walked in steps of 0.005 mm through the phantom's own formulas, without any CT's blur.
inline TrueBoundaries true_boundaries(const Vertebra& vertebra, const DrillPath& path) {
  constexpr double kStepMm = 0.005;
  TrueBoundaries found;
  bool was_inside = false, was_cortex = false, has_left_cortex = false;
  for (double depth_mm = -3.0; depth_mm <= path.length_mm(); depth_mm += kStepMm) {
    const Vec3 p = path.entry_mm + depth_mm * path.direction();
    double distance_mm = 0.0;
    vertebra.evaluate({&p, 1}, {&distance_mm, 1}, {});
    const bool is_inside = distance_mm < 0.0;
    const bool is_cortex = is_inside && vertebra.hu(p, distance_mm, 0.0) >= vertebra.anatomy().cortex.hu;
    if (is_inside && !was_inside && !has_left_cortex) found.outer_mm = depth_mm;
    if (was_cortex && is_inside && !is_cortex && !has_left_cortex) {
      found.cortex_end_mm = depth_mm;
      has_left_cortex = true;
    }
    if (is_cortex && !was_cortex) found.far_cortex_mm = depth_mm;
    if (was_inside && !is_inside) found.end_mm = depth_mm;
    was_inside = is_inside;
    was_cortex = is_cortex;
  }
  return found;
}

/// The pedicle's axis, on through the front of the body and 4 mm beyond.
inline DrillPath path_through(const PedicleGroundTruth& pedicle, const DrillBit& bit) {
  const Vec3 direction = (pedicle.target_mm - pedicle.entry_mm).normalized();
  return {"through", pedicle.entry_mm, pedicle.target_mm + 12.0 * direction, bit};
}

struct PedicleRun {
  std::vector<SessionEvent> events;
  std::vector<Cycle> cycles;

  std::optional<double> begin_mm(DrillState state) const {
    for (const SessionEvent& event : events) {
      if (event.kind == EventKind::state && event.value == static_cast<double>(state)) return event.depth_mm;
    }
    return std::nullopt;
  }
  std::optional<double> depth_mm(EventKind kind) const {
    for (const SessionEvent& event : events) {
      if (event.kind == kind) return event.depth_mm;
    }
    return std::nullopt;
  }
};

/// Drills the path in steps of 10 µs at 1 mm/s through what `bone` samples.
inline PedicleRun drill_pedicle(const DrillPath& path, const BoneSampler& bone, const SessionOptions& options = {}) {
  std::vector<PointVolume> volumes;
  volumes.emplace_back(path, PointVolumeOptions{.radius_mm = 2.0, .spacing_mm = 0.1, .lead_in_mm = 3.0});
  fill_volume(volumes.front(), bone);
  const Material material;
  auto engine = make_ring_engine(volumes.front(), path.bit, material);
  DrillSession session(path, volumes, std::move(engine), material, nullptr, options);
  PathMotionOptions motion;
  motion.line.lead_in_mm = 3.0;
  motion.rate_hz = 100.0;  // 10 µm a cycle
  PlannedMotion tool_operator(path, motion);
  PedicleRun run;
  run_session(session, tool_operator, [&](const Cycle& cycle) { run.cycles.push_back(cycle); });
  run.events.assign(session.events().begin(), session.events().end());
  return run;
}

}  // namespace spinaltap::test
