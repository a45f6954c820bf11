#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/base/scalar_field.h"
#include "core/points/point_volume.h"
#include "core/session/drill_session.h"
#include "core/session/session_setup.h"
#include "vdb/engine/voxel_bone.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// What a session drills in place: volumes of points along its path, or, with EngineKind::voxel, voxels of the whole
/// bone or of a region. Where the setup's engine is `automatic`, chosen_engine() says which.
struct DrilledBone {
  std::vector<PointVolume> volumes;
  std::unique_ptr<VoxelBone> voxels;

  DrilledBone() = default;
  /// Filled from a bone, less the setup's holes. `exact` decides which points are bone, in place of the bone's grid,
  /// where it is given. Throws Error where the setup asks of voxels what only points have, or a region of
  /// points, and on a region that is empty or without bone.
  DrilledBone(const BoneModel& bone, const SessionSetup& setup, const ScalarField* exact = nullptr,
              const Progress& progress = {})
      : DrilledBone(std::span(&bone, 1), setup, exact, progress) {}
  /// Of several bones; of points the same with one alone, else throws Error.
  DrilledBone(std::span<const BoneModel> bones, const SessionSetup& setup, const ScalarField* exact = nullptr,
              const Progress& progress = {});
  DrilledBone(const DrilledBone& other);
  DrilledBone(DrilledBone&&) noexcept = default;
  DrilledBone& operator=(DrilledBone&&) noexcept = default;

  /// Drills another hole, as one of the setup's.
  void drill(const DrilledHole& hole, const SessionSetup& setup);
  /// All lives again that lives in `whole`, which this is a copy of. Throws Error where it is none, and changes nothing
  /// then.
  void restore(const DrilledBone& whole);
  /// Which points or voxels live, 64 to a word, in an order that drilling does not change.
  std::vector<std::uint64_t> occupancy_words() const;
  /// Puts back what occupancy_words() gave. Throws Error on another number of words, and changes nothing then.
  void set_occupancy_words(std::span<const std::uint64_t> words);
  /// What drills it in place with a tool; this must outlive it.
  std::unique_ptr<DrillEngine> engine_for(const SessionSetup& setup, const DrillBit& bit);
  /// A session that drills it; this and `clearances`, which may be null, must outlive it.
  std::unique_ptr<DrillSession> begin_session(const SessionSetup& setup, const ClearanceField* clearances);

  std::size_t occupied_count() const;
  std::size_t memory_bytes() const;
};

}  // namespace spinaltap
