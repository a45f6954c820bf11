#include "apps/spinaltap/bench/milling_workload.h"

#include <algorithm>
#include <cmath>

#include "core/force/drill_forces.h"
#include "core/phantom/scanner.h"
#include "core/phantom/vertebra.h"
#include "core/session/operator/path_motion.h"
#include "vdb/bake/bake.h"
#include "vdb/engine/make_engine.h"
#include "vdb/engine/occupied_voxels.h"
#include "vdb/engine/voxel_engine.h"

namespace spinaltap {
namespace {

constexpr double kMillingMmS = 50.0;
constexpr double kHandTremorMm = 0.1;
constexpr double kMilledLineMm = 14.0, kApartMm = 1.0, kLayerMm = 1.0;

/// The corners of one line to and fro after the other, layer by layer, from the first line's begin, as far as
/// `way_mm`.
std::vector<Vec3> corners_of_lines(double way_mm) {
  constexpr int kLines = static_cast<int>(kMilledLineMm / kApartMm);
  std::vector<Vec3> corners{Vec3::Zero()};
  const auto count = static_cast<int>(way_mm / kMilledLineMm) + 1;
  for (int line = 0; line < count; ++line) {
    const Vec3 at = corners.back();
    corners.emplace_back(at.x() > 0.0 ? 0.0 : kMilledLineMm, at.y(), at.z());
    const bool ends_layer = line % kLines == kLines - 1;
    const double aside = line / kLines % 2 == 0 ? kApartMm : -kApartMm;
    corners.push_back(corners.back() + (ends_layer ? Vec3(0.0, 0.0, -kLayerMm) : Vec3(0.0, aside, 0.0)));
  }
  return corners;
}

/// An engine whose step works out the forces as well.
class EngineWithForces final : public DrillEngine {
 public:
  EngineWithForces(std::unique_ptr<DrillEngine> engine, std::unique_ptr<const OccupiedBone> bone, const DrillBit& bit,
                   double step_s)
      : engine_(std::move(engine)), bone_(std::move(bone)), forces_(*bone_, bit, Material()), step_s_(step_s) {}

  StepResult step(const Pose& pose) noexcept override {
    StepResult result = engine_->step(pose);
    last_ = forces_.update(result, pose, step_s_, kSpindle);
    return result;
  }
  void reset_motion() noexcept override { engine_->reset_motion(); }
  std::size_t memory_bytes() const override { return engine_->memory_bytes(); }

 private:
  static constexpr Spindle kSpindle{.rpm = 60e3};
  std::unique_ptr<DrillEngine> engine_;
  std::unique_ptr<const OccupiedBone> bone_;
  DrillForces forces_;
  DrillForce last_;
  double step_s_;
};

}  // namespace

BoneModel milling_bone(double voxel_mm) {
  return bake_solid(Vertebra(), {.voxel_mm = voxel_mm}, ScanOptions().surroundings_hu);
}

Vec3 milling_start_mm() {
  const Vertebra vertebra;
  const VertebraAnatomy::Body& body = vertebra.anatomy().body;
  return vertebra.to_patient({0.0, 0.0, 0.5 * body.height_mm - body.superior_hollow_mm});
}

DrillBit milling_burr(double diameter_mm) {
  return {diameter_mm, 60.0, 1.0, BitShape::round_burr, 0.0, 0.5 * diameter_mm};
}

std::vector<Pose> milling_poses(const MillingWorkload& workload, std::size_t cycles, std::uint64_t seed) {
  if (workload.lever_mm > 0.0) return turning_poses(workload.lever_mm);
  const std::vector<Vec3> corners = corners_of_lines(workload.step_mm * static_cast<double>(cycles));
  const Vec3 first_mm = milling_start_mm() - Vec3(0.5 * kMilledLineMm, 0.5 * kMilledLineMm, kLayerMm);
  const double tilt = workload.tilt_deg * kDegree;
  const Vec3 axis(std::sin(tilt), 0.0, -std::cos(tilt));
  const Tremor tremor(kHandTremorMm, seed);
  std::vector<Pose> poses;
  poses.reserve(cycles + 1);
  std::size_t next = 1;
  double begin_mm = 0.0;  // of the way to the corner before
  for (std::size_t n = 0; n <= cycles; ++n) {
    const double way_mm = workload.step_mm * static_cast<double>(n);
    double length_mm = (corners[next] - corners[next - 1]).norm();
    while (way_mm > begin_mm + length_mm && next + 1 < corners.size()) {
      begin_mm += length_mm;
      ++next;
      length_mm = (corners[next] - corners[next - 1]).norm();
    }
    const double share = std::min(1.0, (way_mm - begin_mm) / length_mm);
    const Vec3 at_mm = corners[next - 1] + share * (corners[next] - corners[next - 1]);
    poses.push_back({first_mm + at_mm + tremor.at_mm(way_mm / kMillingMmS), axis});
  }
  return poses;
}

std::vector<Pose> turning_poses(double lever_mm) {
  const Vec3 start_mm = milling_start_mm() - Vec3(0.0, 6.0, 1.0);
  constexpr int kHalfSwing = 5, kSwings = 120;
  std::vector<Pose> poses;
  for (int swing = 0; swing < kSwings; ++swing) {
    for (int n = -kHalfSwing; n < kHalfSwing; ++n) {
      const double angle = (swing % 2 == 0 ? n : -n) * kDegree;
      const Vec3 axis(std::sin(angle), 0.0, -std::cos(angle));
      poses.push_back({start_mm + Vec3(0.0, 0.1 * swing, 0.0) + lever_mm * (axis + Vec3::UnitZ()), axis});
    }
  }
  return poses;
}

DrilledBone milled_bone(const BoneModel& bone, EngineKind engine, double spacing_mm) {
  constexpr double kAboveMm = 8.0, kBelowMm = 10.0;  // of a bent endplate's middle; seven layers and a ball's tremor
  SessionSetup setup;
  setup.engine = engine;
  setup.path = {"milling", milling_start_mm() + Vec3(0.0, 0.0, kAboveMm), milling_start_mm() - Vec3(0.0, 0.0, kBelowMm),
                milling_burr(4.0)};
  setup.volume = {.radius_mm = 20.0, .spacing_mm = spacing_mm, .lead_in_mm = 0.0, .hu_bits = HuBits::eight};
  return DrilledBone(bone, setup);
}

WayRun milling_run(DrilledBone& bone, const DrilledBone& whole, const MillingWorkload& workload,
                   std::span<const Pose> poses) {
  const DrillBit burr = milling_burr(workload.diameter_mm);
  const auto begin = [&bone, &whole, burr, workload]() -> std::unique_ptr<DrillEngine> {
    bone.restore(whole);
    std::unique_ptr<DrillEngine> engine =
        bone.voxels ? make_voxel_engine(*bone.voxels, burr, Material(), {.shares_work = false})
                    : make_engine(EngineKind::leaf, bone.volumes.front(), burr, Material());
    if (!workload.has_forces) return engine;
    return std::make_unique<EngineWithForces>(std::move(engine), make_occupied_bone(*bone.voxels, Material()), burr,
                                              workload.step_mm / kMillingMmS);
  };
  return {begin, [&bone] { return bone.memory_bytes(); }, [&bone] { return bone.occupied_count(); }, poses};
}

}  // namespace spinaltap
