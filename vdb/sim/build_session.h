#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/scalar_field.h"
#include "core/plan/grade.h"
#include "core/plan/landmarks.h"
#include "core/session/drill_session.h"
#include "core/session/session_setup.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

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
