#include "apps/spinaltap/bench/drill_workload.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/session/operator/path_motion.h"
#include "core/tool/drill_path.h"

namespace spinaltap {
namespace {

constexpr double kPathMm = 37.8;
constexpr double kOffPathMm = 1.2;
constexpr double kTiltDeg = 3.0;
constexpr double kTremorMm = 0.1;

constexpr std::array kMotions{WorkloadMotion::on_path, WorkloadMotion::off_path, WorkloadMotion::tilted,
                              WorkloadMotion::tremor, WorkloadMotion::tremor_off_path};

std::vector<Pose> all_poses(const PathMotion& motion) {
  std::vector<Pose> poses(motion.cycle_count() + 1);
  for (std::size_t index = 0; index < poses.size(); ++index) poses[index] = motion.pose(index);
  return poses;
}

/// Sideways along the path's y, the bit parallel to the path; in path-local coordinates, mm.
StepWorkload step_sideways(std::string_view name, const DrillBit& bit, double tip_depth_mm, double from_mm,
                           double to_mm) {
  const DrillPath path = workload_path(3.0);
  const PathFrame frame(path.entry_mm, path.direction());
  return {name, bit, frame.to_patient(Pose{Vec3(0.0, from_mm, tip_depth_mm), Vec3::UnitZ()}),
          frame.to_patient(Pose{Vec3(0.0, to_mm, tip_depth_mm), Vec3::UnitZ()})};
}

}  // namespace

std::string_view name_of(WorkloadMotion motion) {
  switch (motion) {
    case WorkloadMotion::on_path:
      return "on-path";
    case WorkloadMotion::off_path:
      return "off-path";
    case WorkloadMotion::tilted:
      return "tilted";
    case WorkloadMotion::tremor:
      return "tremor";
    case WorkloadMotion::tremor_off_path:
      return "tremor-off-path";
  }
  return "";
}

std::span<const WorkloadMotion> workload_motions() { return kMotions; }

DrillPath workload_path(double diameter_mm) {
  const Vec3 entry_mm(31.0, 212.0, -618.0);
  const Vec3 direction = Vec3(-0.3, -0.93, 0.2).normalized();
  return {"standard", entry_mm, entry_mm + kPathMm * direction, {diameter_mm, 50.0, 5.0}};
}

PointVolume workload_volume(double spacing_mm, HuBits hu_bits) {
  PointVolume volume(workload_path(3.0), {.radius_mm = 3.0, .spacing_mm = spacing_mm, .hu_bits = hu_bits});
  for (int disc = 0; disc < volume.disc_count(); ++disc) {
    const double hu = 300.0 + 100.0 * std::sin(2.0 * std::numbers::pi * volume.disc_depth_mm(disc) / 5.0);
    for (std::size_t index = 0; index < volume.pattern().point_count(); ++index) volume.set_hu(disc, index, hu);
  }
  return volume;
}

void revive_all(PointVolume& volume) {
  const std::size_t over = volume.pattern().point_count() % 64;
  for (int disc = 0; disc < volume.disc_count(); ++disc) {
    const std::span<std::uint64_t> words = volume.alive_words(disc);
    std::fill(words.begin(), words.end(), ~std::uint64_t{0});
    if (over != 0) words.back() = (std::uint64_t{1} << over) - 1;
  }
}

std::vector<Pose> workload_poses(WorkloadMotion motion, std::uint64_t seed) {
  const DrillPath path = workload_path(3.0);
  PathMotionOptions options = in_steps_of(0.001);
  if (motion == WorkloadMotion::off_path || motion == WorkloadMotion::tremor_off_path) {
    options.line.offset_mm = kOffPathMm;
  }
  if (motion == WorkloadMotion::tilted) options.line.tilt_deg = kTiltDeg;
  if (motion == WorkloadMotion::tremor || motion == WorkloadMotion::tremor_off_path) {
    options.tremor_mm = kTremorMm;
    options.seed = seed;
  }
  return all_poses(PathMotion(path, options));
}

StepWorkload burr_step() {
  constexpr double kBallMm = 6.0;
  const DrillBit burr{
      .diameter_mm = kBallMm, .length_mm = 50.0, .shape = BitShape::round_burr, .shank_diameter_mm = 3.0};
  return step_sideways("burr 1 mm", burr, 0.5 * (kPathMm + kBallMm), -3.0, -2.0);
}

StepWorkload sideways_step() { return step_sideways("sideways 2.4 mm", workload_path(3.0).bit, kPathMm, -1.2, 1.2); }

}  // namespace spinaltap
