#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/files/json_file.h"
#include "core/base/scalar_field.h"
#include "core/drill/point_volume.h"
#include "core/plan/grade.h"
#include "core/plan/landmarks.h"
#include "core/sim/drill_session.h"
#include "core/sim/straight_ways.h"
#include "vdb/bone_model.h"
#include "vdb/engine_kind.h"

namespace spinaltap {

/// A hole that is in the bone before a session begins.
struct DrilledHole {
  DrillBit bit;
  std::vector<BitWay> ways;
};

/// All that decides what a session does, but the bone itself and the hand's poses. A record holds it as JSON, and
/// replay runs the session from it.
struct SessionSetup {
  std::string bone_hash;  ///< of its grids: hash_of()
  DrillPath path;
  Material material;
  PointVolumeOptions volume{.radius_mm = 3.0, .spacing_mm = 0.1, .lead_in_mm = 3.0};
  double fine_spacing_mm = 0.0;  ///< as DrillingOptions has them
  double fine_near_mm = 1.0;
  double fine_tip_mm = 0.0;
  EngineKind engine = EngineKind::ring;
  SessionOptions options;
  bool has_clearances = true;
  std::vector<DrilledHole> holes = {};  ///< drilled before: their points are gone when the session begins
};

Json to_json(const SessionSetup& setup);
/// Throws Error that names the file and the key at fault.
SessionSetup read_session_setup(const Json& json, const std::filesystem::path& file);

/// What a record's setup holds of it: "session", this as JSON, and "version", the program's. Whoever makes the hand
/// adds what it was made from.
std::map<std::string, std::string> record_setup(const SessionSetup& setup);
/// Reads it back. Throws Error where there is none, or a key of it is at fault.
SessionSetup recorded_setup(const std::map<std::string, std::string>& setup, const std::filesystem::path& file);

/// A fingerprint of a bone's two grids: the same however the file was written.
std::string hash_of(const BoneModel& bone);

/// A bone that sessions drill: the grids, and the walls for clearances where the bone has landmarks.
class SessionBone {
 public:
  /// Where find_landmarks() refuses the bone, there is only an outer surface, and `remark` says why.
  explicit SessionBone(BoneModel model, bool with_walls = true, const Progress& progress = {});
  SessionBone(const SessionBone&) = delete;
  SessionBone& operator=(const SessionBone&) = delete;

  const BoneModel& model() const { return model_; }
  /// Null without walls.
  const WallDistance* walls() const { return walls_ ? &*walls_ : nullptr; }
  /// Null without walls, and where the bone was refused.
  const Landmarks* landmarks() const { return walls_ && remark_.empty() ? &landmarks_ : nullptr; }
  /// Of the baked CT numbers; valid as long as this.
  HuSampler hu() const;
  const std::string& remark() const { return remark_; }

 private:
  BoneModel model_;
  std::unique_ptr<BoneShape> shape_;
  Landmarks landmarks_;
  std::optional<WallDistance> walls_;
  std::string remark_;
};

/// A session with all it stands on. Not to be moved while it runs.
struct BuiltSession {
  std::vector<PointVolume> volumes;
  std::unique_ptr<ClearanceField> clearances;  ///< null without walls
  std::unique_ptr<DrillSession> session;
};
/// Fills the volumes and makes the session. `bone` must outlive it. `exact` decides which points are bone, in place of
/// the bone's grid, where it is given. `clearances`: another session's of the same bone and path, which saves working
/// them out again. Throws Error where the path misses the bone.
BuiltSession build_session(const SessionBone& bone, const SessionSetup& setup, const Progress& progress = {},
                           const ScalarField* exact = nullptr, const ClearanceField* clearances = nullptr);

}  // namespace spinaltap
