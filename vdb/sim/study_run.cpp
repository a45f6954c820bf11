#include "vdb/sim/study_run.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/error.h"
#include "core/base/geometry.h"
#include "core/grading/grade.h"
#include "core/grading/path_side.h"
#include "core/session/choose_engine.h"
#include "core/study/study_task.h"
#include "core/tool/plate.h"
#include "vdb/sim/bone_path.h"

namespace spinaltap {
namespace {

constexpr double kNoFigure = std::numeric_limits<double>::quiet_NaN();

/// The planned path with room past its target, for what holds its points.
DrillPath with_lead_out(DrillPath path, double lead_out_mm) {
  path.target_mm += lead_out_mm * path.direction();
  return path;
}

/// Points that died, and the bone that they stand for.
struct Removed {
  std::size_t points = 0;
  double mm3 = 0.0;
};

/// The box of the cylinder that all runs drill in.
Box3 box_of(const DrillPath& path, const PointVolumeOptions& volume) {
  const Vec3 first_mm = path.entry_mm - volume.lead_in_mm * path.direction();
  // A cylinder's circle reaches so far along each of the patient's axes.
  const Vec3 aside_mm = volume.radius_mm * (Vec3::Ones() - path.direction().cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
  Box3 box(first_mm);
  box.extend(path.target_mm);
  return {box.min() - aside_mm, box.max() + aside_mm};
}

/// Counts by ring first: the sum's order is then the same whatever died when.
Removed removed_from(const PointVolume& before, const PointVolume& after) {
  const DiscPattern& pattern = before.pattern();
  std::vector<std::size_t> by_index(pattern.point_count(), 0);
  for (int disc = 0; disc < before.disc_count(); ++disc) {
    const auto was = before.occupancy_words(disc);
    const auto is = after.occupancy_words(disc);
    for (std::size_t word = 0; word < was.size(); ++word) {
      for (std::uint64_t died = was[word] & ~is[word]; died != 0; died &= died - 1) {
        ++by_index[64 * word + static_cast<std::size_t>(std::countr_zero(died))];
      }
    }
  }
  Removed removed;
  for (int ring = 0; ring < pattern.ring_count(); ++ring) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < DiscPattern::ring_size(ring); ++i) count += by_index[DiscPattern::ring_start(ring) + i];
    removed.points += count;
    removed.mm3 += static_cast<double>(count) * pattern.point_volume_mm3(ring);
  }
  return removed;
}

Removed removed_from(const DrilledBone& before, const DrilledBone& after) {
  if (!before.voxels) return removed_from(before.volumes.front(), after.volumes.front());
  const std::size_t voxels = before.voxels->occupied_count() - after.voxels->occupied_count();
  return {voxels, static_cast<double>(voxels) * std::pow(before.voxels->voxel_mm(), 3)};
}

/// What a table keeps of a run's cycles.
struct Extremes {
  double min_clearance_outer_mm = std::numeric_limits<double>::infinity();
  double min_clearance_canal_mm = std::numeric_limits<double>::infinity();
  double max_thrust_n = 0.0;
  double max_torque_n_mm = 0.0;
  double deepest_mm = -std::numeric_limits<double>::infinity();

  void add(const Cycle& cycle) {
    min_clearance_outer_mm = std::min(min_clearance_outer_mm, cycle.clearance.outer_mm);
    min_clearance_canal_mm = std::min(min_clearance_canal_mm, cycle.clearance.canal_mm);
    max_thrust_n = std::max(max_thrust_n, cycle.force.thrust_n);
    max_torque_n_mm = std::max(max_torque_n_mm, cycle.force.torque_n_mm);
    deepest_mm = std::max(deepest_mm, cycle.depth_mm);
  }
};

/// The first of each kind; of plunges and ways out of the volume the greatest.
void add_events(std::span<const SessionEvent> events, StudyRow& row) {
  const auto first = [&](StudyColumn column, double depth_mm) {
    if (std::isnan(row[column])) row[column] = depth_mm;
  };
  for (const SessionEvent& event : events) {
    switch (event.kind) {
      case EventKind::contact:
        row[StudyColumn::contact] = 1.0;
        break;
      case EventKind::state:
        switch (static_cast<DrillState>(std::lround(event.value))) {
          case DrillState::initial:
            break;
          case DrillState::outer_cortical:
            first(StudyColumn::outer_cortical_mm, event.depth_mm);
            break;
          case DrillState::cancellous:
            first(StudyColumn::cancellous_mm, event.depth_mm);
            break;
          case DrillState::transitional:
            first(StudyColumn::transitional_mm, event.depth_mm);
            break;
          case DrillState::inner_cortical:
            first(StudyColumn::inner_cortical_mm, event.depth_mm);
            break;
        }
        break;
      case EventKind::breakthrough:
        first(StudyColumn::breakthrough_mm, event.depth_mm);
        break;
      case EventKind::stop_thrust:
      case EventKind::stop_clearance:
      case EventKind::stop_breach:
        first(StudyColumn::stop_mm, event.depth_mm);
        break;
      case EventKind::gave_up:
        row[StudyColumn::gave_up_mm] = event.value;
        break;
      case EventKind::plunge:
        row[StudyColumn::plunge_depth_mm] = std::fmax(row[StudyColumn::plunge_depth_mm], event.value);
        break;
      case EventKind::outside_volume:
        row[StudyColumn::outside_volume_mm] = std::max(row[StudyColumn::outside_volume_mm], event.value);
        break;
      default:
        break;
    }
  }
}

/// What is drawn of a run, and nothing of what comes of it.
StudyRow row_of(const StudySpec& spec, const DrillPath& planned, std::size_t n, const StudyTask& task) {
  StudyRow row;
  for (std::size_t column = 0; column < kStudyColumns; ++column) row[static_cast<StudyColumn>(column)] = kNoFigure;
  for (std::size_t factor = 0; factor < kStudyFactors; ++factor) {
    row[static_cast<StudyFactor>(factor)] = task.values[factor];
  }
  const StudyBone& bone = spec.bones[screw_at(spec, task.screw).bone];
  row[StudyColumn::run] = static_cast<double>(n);
  row[StudyColumn::patient] = static_cast<double>(bone.patient + 1);
  row[StudyColumn::screw] = static_cast<double>(task.screw + 1);
  if (bone.level != Level::kNone) row[StudyColumn::level] = static_cast<double>(bone.level);
  row[StudyColumn::seed] = static_cast<double>(task.seed);
  if (spec.errors) {
    row[StudyColumn::error_medial_mm] = task.error.medial_mm;
    row[StudyColumn::error_cranial_mm] = task.error.cranial_mm;
    row[StudyColumn::error_along_mm] = task.error.along_mm;
    row[StudyColumn::error_medial_deg] = task.error.medial_deg;
    row[StudyColumn::error_cranial_deg] = task.error.cranial_deg;
  }
  if (spec.registration) {
    row[StudyColumn::turn_left_deg] = task.registration.turn_rad.x() / kDegree;
    row[StudyColumn::turn_back_deg] = task.registration.turn_rad.y() / kDegree;
    row[StudyColumn::turn_head_deg] = task.registration.turn_rad.z() / kDegree;
    row[StudyColumn::shift_left_mm] = task.registration.shift_mm.x();
    row[StudyColumn::shift_back_mm] = task.registration.shift_mm.y();
    row[StudyColumn::shift_head_mm] = task.registration.shift_mm.z();
  }
  row[StudyColumn::off_entry_mm] = (task.path.entry_mm - planned.entry_mm).norm();
  row[StudyColumn::off_target_mm] = (task.path.target_mm - planned.target_mm).norm();
  row[StudyColumn::off_angle_deg] = angle_between_rad(task.path.direction(), planned.direction()) / kDegree;
  return row;
}

}  // namespace

double study_radius_mm(const StudySpec& spec, double reach_mm) {
  constexpr double kMaxMm = 15.0;
  if (spec.volume.radius_mm > 0.0) return spec.volume.radius_mm;
  if (reach_mm > kMaxMm) {
    fail("the errors of the study take bits ", reach_mm, " mm off the planned path: expected at most ", kMaxMm,
         " mm, or a \"radius_mm\" of \"volume\" that says how much of that is to be drilled");
  }
  return reach_mm;
}

StudyBench::StudyBench(const Bone& bone, const StudySpec& spec, std::size_t screw, const StudyRuns& runs,
                       double reach_mm, const Progress& progress)
    : bone_(bone), spec_(spec), runs_(runs), path_(path_of(spec, screw_at(spec, screw))), side_(kNoFigure) {
  check_straight(path_, "a study");
  check_turns(path_.bit, "a study");
  check_path_meets_bone(path_, bone.model());
  if (bone.no_landmarks(progress).empty()) {
    side_ = SideNames(bone.landmarks(), path_).is_left() ? 0.0 : 1.0;
    frame_ = error_frame(bone.landmarks(), path_);
    grader_.emplace(bone_.walls(progress), GradeOptions{});
    neighbours_ = neighbours_among(bone_.neighbours(), progress);
  } else if (spec.kind == StudyKind::geometry) {
    bone.landmarks();  // says why there are none
  }
  if (spec.kind == StudyKind::drilling) fill(reach_mm, progress);
}

void StudyBench::fill(double reach_mm, const Progress& progress) {
  SessionSetup setup;
  setup.path = with_lead_out(path_, spec_.lead_out_mm);
  setup.volume = spec_.volume;
  setup.engine = spec_.engine;
  if (spec_.engine == EngineKind::voxel) setup.region_mm = box_of(setup.path, spec_.volume);
  whole_ = DrilledBone(bone_.model(), setup, nullptr, progress);
  progress.report("clearances", 0.0);
  // Where bits may be, and a little more.
  constexpr double kSpareMm = 2.0;
  clearances_ =
      std::make_unique<const ClearanceField>(bone_.walls(progress), path_, reach_mm + kSpareMm,
                                             spec_.volume.lead_in_mm + kSpareMm, spec_.lead_out_mm + kSpareMm);
}

StudyRunner StudyBench::make_runner() const {
  return [this, bone = std::make_shared<DrilledBone>(whole_)](std::size_t n) { return run(n, *bone); };
}

std::size_t StudyBench::point_count() const {
  if (spec_.kind == StudyKind::geometry) return 0;
  return whole_.voxels ? whole_.voxels->occupied_count() : whole_.volumes.front().point_count();
}

StudyRow StudyBench::run(std::size_t n, DrilledBone& bone) const {
  const StudyTask task = study_task(spec_, runs_, n);
  StudyRow row = row_of(spec_, path_, n, task);
  row[StudyColumn::side] = side_;
  if (spec_.kind == StudyKind::drilling) drill(task, bone, row);
  if (grader_) grade_screw(task, row);
  return row;
}

void StudyBench::drill(const StudyTask& task, DrilledBone& bone, StudyRow& row) const {
  bone.restore(whole_);
  SessionSetup setup;
  setup.path = path_;
  setup.path.bit = task.path.bit;
  setup.material = task.material;
  setup.engine = spec_.engine;
  const double cosine = task.path.direction().dot(path_.direction());
  setup.engine = chosen_engine(setup, {.max_tilt_deg = std::acos(std::clamp(cosine, -1.0, 1.0)) / kDegree,
                                       .trembles = task.tool_operator.tremor_mm > 0.0});
  setup.options = spec_.options;
  setup.options.has_support = false;  // no column has it
  // Where the bit really goes in is its own entry opening, which it is meant to break.
  std::optional<ClearanceField> clearances;
  if (clearances_) clearances.emplace(clearances_->with_entry_of(task.path));
  const std::unique_ptr<DrillSession> session = bone.begin_session(setup, clearances ? &*clearances : nullptr);
  const std::unique_ptr<Operator> tool_operator =
      make_study_operator(task, spec_.volume.lead_in_mm, spec_.options.spindle);
  Extremes extremes;
  run_session(*session, *tool_operator, [&extremes](const Cycle& cycle) { extremes.add(cycle); });

  row[StudyColumn::contact] = 0.0;
  row[StudyColumn::outside_volume_mm] = 0.0;
  add_events(session->events(), row);
  const double outer_mm = std::max(0.0, -extremes.min_clearance_outer_mm);
  const double canal_mm = std::max(0.0, -extremes.min_clearance_canal_mm);
  row[StudyColumn::breach] = std::max(outer_mm, canal_mm) > 0.0 ? 1.0 : 0.0;
  row[StudyColumn::breach_outer_mm] = outer_mm;
  row[StudyColumn::breach_canal_mm] = canal_mm;
  row[StudyColumn::min_clearance_outer_mm] = extremes.min_clearance_outer_mm;
  row[StudyColumn::min_clearance_canal_mm] = extremes.min_clearance_canal_mm;
  row[StudyColumn::grade] = static_cast<double>(gertzbein_robbins(std::max(outer_mm, canal_mm)));
  row[StudyColumn::max_thrust_n] = extremes.max_thrust_n;
  row[StudyColumn::max_torque_n_mm] = extremes.max_torque_n_mm;
  row[StudyColumn::depth_mm] = extremes.deepest_mm;
  row[StudyColumn::time_s] = session->last().time_s;
  const Removed removed = removed_from(whole_, bone);
  row[StudyColumn::removed_points] = static_cast<double>(removed.points);
  row[StudyColumn::removed_mm3] = removed.mm3;
  if (task.path.screw) {
    const ScrewFixation fixation = screw_fixation(bone_, task.path, task.material.density);
    row[StudyColumn::screw_pullout_n] = fixation.pullout_n.median;
    row[StudyColumn::screw_torque_n_mm] = fixation.max_torque_n_mm.median;
  }
  row[StudyColumn::max_temperature_c] = session->last().heat.max_temperature_c;
  row[StudyColumn::events_lost] = static_cast<double>(session->events_lost());
}

void StudyBench::grade_screw(const StudyTask& task, StudyRow& row) const {
  const PlacementError off = error_between(path_, *frame_, task.path);
  row[StudyColumn::off_medial_mm] = off.medial_mm;
  row[StudyColumn::off_cranial_mm] = off.cranial_mm;
  row[StudyColumn::off_medial_deg] = off.medial_deg;
  row[StudyColumn::off_cranial_deg] = off.cranial_deg;
  const ScrewBreach found = grader_->grade(task.path, ScrewSides::anterior);
  row[StudyColumn::screw_grade] = static_cast<double>(gertzbein_robbins(found.breach_mm));
  row[StudyColumn::screw_breach_mm] = found.breach_mm;
  if (found.breach_mm > 0.0) {
    row[StudyColumn::screw_breach_side] = static_cast<double>(found.side);
    row[StudyColumn::screw_breach_depth_mm] = found.depth_mm;
  }
  row[StudyColumn::screw_canal_mm] = found.canal_mm;
  row[StudyColumn::screw_anterior_mm] = found.side_breach_mm[static_cast<std::size_t>(PathSide::anterior)];
  if (!neighbours_.empty()) {
    row[StudyColumn::screw_neighbour_mm] = neighbour_contact(neighbours_, task.path).depth_mm;
  }
}

}  // namespace spinaltap
