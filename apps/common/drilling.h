#pragma once

#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/scalar_field.h"
#include "core/drill/drill_path.h"
#include "core/drill/material.h"
#include "core/drill/point_volume.h"
#include "core/sim/lock_step.h"
#include "vdb/bone_model.h"
#include "vdb/engine_kind.h"

namespace spinaltap {

struct DrillingOptions {
  PointVolumeOptions volume{.radius_mm = 3.0, .spacing_mm = 0.1, .lead_in_mm = 3.0};
  /// Finer points near the bone's surface and near the target; 0: the same spacing everywhere.
  double fine_spacing_mm = 0.0;
  double fine_near_mm = 1.0;           ///< of the surface, along the path
  double fine_tip_mm = 0.0;            ///< before the target
  const ScalarField* exact = nullptr;  ///< decides which points are bone, in place of the bone's grid
  EngineKind engine = EngineKind::ring;
  LockStepOptions motion;
  double log_step_mm = 0.1;  ///< depth that one row of the log stands for
};

/// One row of the log: the cycles within `log_step_mm` of depth.
struct DepthRow {
  double depth_mm = 0.0;  ///< of the tip beyond the entry, at the row's end
  std::size_t cycles = 0;
  std::size_t removed = 0;     ///< points
  std::size_t tested = 0;      ///< points
  double hu = 0.0;             ///< mean of the removed points; NaN where none was
  double density_g_cm3 = 0.0;  ///< by the material's law; NaN where none was
  double thrust_n = 0.0;       ///< work of the row's cycles over its depth
  double cycles_per_s = 0.0;   ///< by the wall time of the engine's steps
};

struct Drilling {
  std::vector<PointVolume> volumes;  ///< after drilling, end to end along the path
  std::size_t points = 0;            ///< of the whole cylinder
  std::size_t points_in_bone = 0;    ///< alive before drilling
  std::size_t removed = 0;
  int discs = 0;
  std::size_t points_per_disc = 0;  ///< of the first volume
  double bytes_per_point = 0.0;     ///< of the volumes and the engine
  std::size_t cycles = 0;
  double seconds = 0.0;         ///< of all engine steps
  double entry_depth_mm = 0.0;  ///< where the first point was cut, beyond the planned entry
  double most_thrust_n = 0.0;   ///< of a row
  BoneModel drilled;            ///< the bone without the hole
  std::vector<DepthRow> rows;

  explicit Drilling(BoneModel bone) : drilled(std::move(bone)) {}
};

/// Fills a point volume along the path, drills it in lock-step, and cuts the hole out of the distance grid. Points are
/// in the bone where the grid says so, or options.exact. Throws Error when the path misses the bone.
Drilling drill_bone(const BoneModel& bone, const DrillPath& path, const Material& material,
                    const DrillingOptions& options, const Progress& progress = {});

/// The log as CSV, with a head line; units are in the names of the columns.
std::string log_csv(const std::vector<DepthRow>& rows);

}  // namespace spinaltap
