#pragma once

#include <QDateTime>
#include <QObject>
#include <QTimer>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/spinaltap-planner/background_job.h"
#include "apps/spinaltap-planner/drill/drill_player.h"
#include "apps/spinaltap-planner/opened_bone.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

class Planner;
class WorkLock;

/// What a window that ended without being closed had not saved. Of files it knows fingerprints, no names.
struct LostWork {
  std::filesystem::path kept_in;
  std::shared_ptr<WorkLock> lock;  ///< no other window offers it meanwhile
  QDateTime changed;
  std::vector<DrillPath> paths;
  int chosen = -1;
  std::vector<HoleOrder> holes;
  std::string bone;     ///< Bone::hash()
  std::string file;     ///< fingerprint_of_name() of what was opened
  OpenOptions options;  ///< with which it was
};

/// Of a file's whole name: two names are the same where these are, and nothing else can be told from it.
std::string fingerprint_of_name(const std::filesystem::path& file);

/// Where windows keep what is not saved: the user's state folder ($XDG_STATE_HOME, ~/.local/state).
std::filesystem::path work_folder();
/// What crashed windows left there, the last first; what windows that run hold is theirs.
std::vector<LostWork> lost_work();
void remove_lost_work(const LostWork& lost);

/// Keeps what is not saved in a file of work_folder(), a moment after it changes, for the case that the program does
/// not end as it should: paths, and how holes were drilled. The file is a plan (docs/plan-file.md) with one more key,
/// "session". It goes where all is saved and when this ends.
class Autosave : public QObject {
  Q_OBJECT
 public:
  explicit Autosave(Planner& planner);
  ~Autosave() override;

  /// Holes that are drilled again, until they are.
  void keep(const std::vector<HoleOrder>& holes);
  /// Nothing is kept any more: the window is closed.
  void forget();

 private:
  void save();
  void save_soon(int after_ms);

  Planner& planner_;
  QTimer due_;
  std::filesystem::path file_;
  std::shared_ptr<WorkLock> lock_;
  std::vector<HoleOrder> promised_;
  bool is_in_trouble_ = false;
  std::unique_ptr<BackgroundJob> job_;  ///< null: the window is closed
};

}  // namespace spinaltap
