#include "core/session/choose_engine.h"

#include <cmath>

#include "core/tool/path_curve.h"

namespace spinaltap {

// The rule follows `spinaltap bench drill`, whose last table says how far it is from the fastest engine of each row;
// docs/drilling-benchmarks.md has a run. The numbers here are of points 0.1 mm apart and tools of 3 mm.
std::string_view why_voxels(const SessionSetup& setup, const MotionClass& way) {
  if (!setup.options.has_path) return "no path";
  if (setup.path.bit.is_plate()) return "a plate";
  if (setup.region_mm) return "a region";
  if (setup.options.has_device || way.is_free) return "a hand at a device";
  if (!way.keeps_to_path || !setup.options.follows_path) return "a way that leaves the path";
  if (!setup.further_bone_hashes.empty()) return "several bones";
  return "";
}

EngineKind chosen_engine(const SessionSetup& setup, const MotionClass& way) {
  if (setup.engine != EngineKind::automatic) return setup.engine;
  if (!why_voxels(setup, way).empty()) return EngineKind::voxel;
  // Discs across the path are soon in reach of a bit that leans over; boxes do not care how it lies. `ring` was faster
  // by 2 at 10 degrees, `leaf` by 2 at 20 and by 10 at 60.
  constexpr double kLeavesFromDeg = 15.0;
  // The cylinder of a curved path lies along its chord.
  const double chord_deg = setup.path.is_curved() ? PathCurve(setup.path).max_tilt_deg() : 0.0;
  if (std::abs(way.max_tilt_deg) + chord_deg >= kLeavesFromDeg) return EngineKind::leaf;
  // Discs are passed over by how near they are to a cone and a cylinder, between which a ball leaves much room. As long
  // as it only goes forward `ring` was faster by 1.4; in a hand that trembles `leaf` by 4.5. Conical burrs and tapered
  // screws fill that room: `ring` was faster by 3 to 4 forward, by 1.3 to 2.5 with a tremor.
  return setup.path.bit.shape == BitShape::round_burr && way.trembles ? EngineKind::leaf : EngineKind::ring;
}

SessionSetup setup_for(SessionSetup setup, const MotionClass& way) {
  setup.engine = chosen_engine(setup, way);
  if (!way.keeps_to_path) {
    setup.options.follows_path = false;
    setup.options.heat.reset();  // of a hole along the path only
  }
  return setup;
}

}  // namespace spinaltap
