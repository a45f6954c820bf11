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
constexpr double kBenchOffPathMm = 1.2;
constexpr double kBenchTremorMm = 0.1;

/// What a motion is, by its place in WorkloadMotion.
struct MotionKind {
  std::string_view name;
  double offset_mm = 0.0;
  double tilt_deg = 0.0;
  double tremor_mm = 0.0;
  bool has_burr = false;
};
constexpr std::array kKinds{MotionKind{"on-path"},
                            MotionKind{"off-path", kBenchOffPathMm},
                            MotionKind{"tilted", 0.0, 3.0},
                            MotionKind{"tremor", 0.0, 0.0, kBenchTremorMm},
                            MotionKind{"tremor-off-path", kBenchOffPathMm, 0.0, kBenchTremorMm},
                            MotionKind{"tilted-10", 0.0, 10.0},
                            MotionKind{"tilted-20", 0.0, 20.0},
                            MotionKind{"tilted-30", 0.0, 30.0},
                            MotionKind{"tilted-60", 0.0, 60.0},
                            MotionKind{"on-path-burr", 0.0, 0.0, 0.0, true},
                            MotionKind{"tremor-burr", 0.0, 0.0, kBenchTremorMm, true},
                            MotionKind{"tremor-burr-off-path", kBenchOffPathMm, 0.0, kBenchTremorMm, true}};

const MotionKind& kind_of(WorkloadMotion motion) { return kKinds.at(static_cast<std::size_t>(motion)); }

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

std::string_view name_of(WorkloadMotion motion) { return kind_of(motion).name; }

std::span<const WorkloadMotion> workload_motions() {
  static const auto motions = [] {
    std::array<WorkloadMotion, kKinds.size()> all{};
    for (std::size_t n = 0; n < all.size(); ++n) all[n] = static_cast<WorkloadMotion>(n);
    return all;
  }();
  return motions;
}

bool is_of_paper(WorkloadMotion motion) { return motion <= WorkloadMotion::tremor_off_path; }

MotionClass workload_way(WorkloadMotion motion) {
  return {.max_tilt_deg = kind_of(motion).tilt_deg, .trembles = kind_of(motion).tremor_mm > 0.0};
}

DrillPath workload_path(double diameter_mm) {
  const Vec3 entry_mm(31.0, 212.0, -618.0);
  const Vec3 direction = Vec3(-0.3, -0.93, 0.2).normalized();
  return {"standard", entry_mm, entry_mm + kPathMm * direction, {diameter_mm, 50.0, 5.0}};
}

DrillBit workload_bit(WorkloadMotion motion, double diameter_mm) {
  if (!kind_of(motion).has_burr) return workload_path(diameter_mm).bit;
  return {.diameter_mm = diameter_mm,
          .length_mm = 50.0,
          .shape = BitShape::round_burr,
          .shank_diameter_mm = 0.5 * diameter_mm};
}

PointVolume workload_volume(double spacing_mm, HuBits hu_bits) {
  PointVolume volume(workload_path(3.0), {.radius_mm = 3.0, .spacing_mm = spacing_mm, .hu_bits = hu_bits});
  for (int disc = 0; disc < volume.disc_count(); ++disc) {
    const double hu = 300.0 + 100.0 * std::sin(2.0 * std::numbers::pi * volume.disc_depth_mm(disc) / 5.0);
    for (std::size_t index = 0; index < volume.pattern().point_count(); ++index) volume.set_hu(disc, index, hu);
  }
  return volume;
}

void restore_all(PointVolume& volume) {
  const std::size_t over = volume.pattern().point_count() % 64;
  for (int disc = 0; disc < volume.disc_count(); ++disc) {
    const std::span<std::uint64_t> words = volume.occupancy_words(disc);
    std::fill(words.begin(), words.end(), ~std::uint64_t{0});
    if (over != 0) words.back() = (std::uint64_t{1} << over) - 1;
  }
}

std::vector<Pose> workload_poses(WorkloadMotion motion, std::uint64_t seed) {
  const DrillPath path = workload_path(3.0);
  PathMotionOptions options = in_steps_of(0.001);
  const MotionKind& kind = kind_of(motion);
  options.line.offset_mm = kind.offset_mm;
  options.line.tilt_deg = kind.tilt_deg;
  options.tremor_mm = kind.tremor_mm;
  options.seed = seed;
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
