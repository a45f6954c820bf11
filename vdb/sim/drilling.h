#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/scalar_field.h"
#include "core/points/point_splats.h"
#include "core/session/depth_log.h"
#include "core/session/drill_session.h"
#include "core/session/real_time/real_time.h"
#include "core/session/record/session_record.h"
#include "vdb/grid/bone_model.h"
#include "vdb/heat/drilling_heat.h"
#include "vdb/sim/build_session.h"

namespace spinaltap {

struct DrillingOptions {
  const ScalarField* exact = nullptr;          ///< decides which points are bone, in place of the bone's grid
  double log_step_mm = 0.1;                    ///< depth that one row of the log stands for
  std::optional<RealTimeOptions> real_time{};  ///< paced by the clock; without: as fast as it goes
  DisplayTask display{};                       ///< what is shown beside, in real time; none: nothing
  bool makes_splats = false;                   ///< of the points, for a picture
  RecordWriter* record = nullptr;              ///< gets every cycle and the events; closed by the caller
};

struct Drilling {
  DrilledBone left;                ///< after drilling
  std::size_t points = 0;          ///< of the whole cylinder; of voxels, those in bone
  std::size_t points_in_bone = 0;  ///< occupied before drilling
  std::size_t removed = 0;
  int discs = 0;                    ///< 0: voxels have none
  std::size_t points_per_disc = 0;  ///< of the first volume
  double bytes_per_point = 0.0;     ///< of the points or voxels and the engine
  std::size_t cycles = 0;           ///< after the first, which puts the bit
  double session_s = 0.0;           ///< the operator's time
  double seconds = 0.0;             ///< of all cycles but the first, where they were not paced; else NaN
  double entry_depth_mm = 0.0;      ///< where the first point was cut, beyond the planned entry; NaN: nowhere
  double deepest_mm = 0.0;          ///< of the tip beyond the entry
  double max_thrust_n = 0.0;        ///< of a cycle, as are torque and contact force
  double max_torque_n_mm = 0.0;
  double max_off_mm = 0.0;              ///< of a compliant tool's tip off the commanded one
  double max_contact_n = 0.0;           ///< of touching with the spindle off
  double min_clearance_outer_mm = 0.0;  ///< min clearances; infinite where there is no wall near
  double min_clearance_canal_mm = 0.0;
  CycleHeat heat;                    ///< of the last cycle
  std::vector<HeatStep> heat_steps;  ///< of every cycle, where the setup has heat: for solve_heat()
  bool is_stopped = false;           ///< a rule asked to
  OperatorEnd operator_end = OperatorEnd::as_planned;
  std::vector<SessionEvent> events;
  std::size_t events_lost = 0;
  std::optional<RealTimeReport> real_time;
  BoneModel before;                        ///< the bone without the setup's earlier holes
  BoneModel drilled;                       ///< and without this one
  std::vector<BoneModel> further_drilled;  ///< of several bones all but the first
  std::vector<PointSplat> splats;          ///< of all volumes, where asked for
  std::vector<DepthRow> rows;

  explicit Drilling(BoneModel bone) : before(bone), drilled(std::move(bone)) {}
};

/// Fills points along the path, or the bone's voxels, lets an operator drill it, and cuts the hole of all its poses out
/// of the distance grid. Throws Error when the path misses the bone.
Drilling drill_bone(const Bone& bone, const SessionSetup& setup, Operator& tool_operator,
                    const DrillingOptions& options = {}, const Progress& progress = {});
/// The same through several bones: see build_session().
Drilling drill_bone(std::span<const Bone> bones, const SessionSetup& setup, Operator& tool_operator,
                    const DrillingOptions& options = {}, const Progress& progress = {});

}  // namespace spinaltap
