#pragma once

#include <QObject>
#include <QString>
#include <filesystem>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "apps/spinaltap-planner/background_job.h"
#include "apps/spinaltap-planner/ct_levels.h"
#include "apps/spinaltap-planner/drill/drill_player.h"
#include "apps/spinaltap-planner/figures/path_figures.h"
#include "apps/spinaltap-planner/plan_document.h"
#include "apps/spinaltap-planner/view_state.h"
#include "core/ct/dicom_read.h"

namespace spinaltap {

/// What a person is asked. Without answers what is ready is shown, and what is not clear is trouble: for scripts.
struct Questions {
  /// A bone is ready, for which `show` gives up the plan and the drilling: now, later or not at all.
  std::function<void(std::function<void()> show)> before_replacing;
  /// The file could be opened with other options.
  std::function<void(const std::filesystem::path&, const OpenOptions&, const SeveralSeries&)> which_series;
  std::function<void(const std::filesystem::path&, const OpenOptions&, const UnevenSlices&)> whether_to_resample;
  /// A plan names another bone, or its paths do not fit this one: `why`, a line each. `take` opens it all the same.
  std::function<void(const std::filesystem::path&, const QString& why, std::function<void()> take)>
      whether_to_take_plan;
};

/// All of the program but its window: the plan, what the panes show, the drilling, files and long work. A window and
/// scripts do the same through it.
class Planner : public QObject {
  Q_OBJECT
 public:
  /// Throws Error where a shipped file is missing or damaged.
  explicit Planner(QObject* parent = nullptr);

  PlanDocument& document() { return document_; }
  ViewState& view() { return view_; }
  DrillPlayer& player() { return player_; }
  /// Opens and writes; levels() works beside it.
  BackgroundJob& job() { return job_; }
  const BackgroundJob& job() const { return job_; }
  CtLevels& levels() { return levels_; }
  /// Something that was asked for is not done yet: opening, writing, looking for levels, baking.
  bool is_working() const;
  /// Ends what job() does, and forgets what was to be opened after it.
  void cancel();
  const PathGrader& grader() const { return grader_; }
  void set_questions(Questions questions) { questions_ = std::move(questions); }
  /// Of the chosen path; nothing without a bone or a path.
  std::optional<PathFigures> figures() const;

  /// Opens a CT, a baked bone, or a plan for the bone that is open. CTs and bones take a while: opened() tells when
  /// they are there. Throws Error where the file cannot be; what was open then stays. A file that is being opened makes
  /// way for the next.
  ///
  /// Of a CT the slices are there first. Then levels() looks for its vertebrae, and the one that the options name, or
  /// the only one that is whole, is baked and shown. no_bone() tells where there is none. A plan for a CT of which
  /// no bone is shown has the level baked that its paths lie in.
  void open(const std::filesystem::path& path, const OpenOptions& options = {});
  bool is_to_open() const { return next_.has_value(); }
  /// Shows a level, or bakes it and then shows it, unless something that is not saved would be lost by then.
  void show_level(int index);
  /// Puts the crosshair to a place that the program chose.
  void put_crosshair(const Vec3& p_mm);
  /// Bakes all levels that are whole; the first is shown where no bone is.
  void bake_all();
  /// The vertebra of the open CT whose body the crosshair is in. Throws Error where no CT is open.
  int level_here();
  /// Throws Error where it cannot be written. A name that ends in ".mrk.json" makes 3D Slicer's markups: a copy, which
  /// does not become the plan's file.
  void save_plan(const std::filesystem::path& path);
  /// Written while the window goes on. Throw Error where there is nothing to write, or other such work goes on.
  ///
  /// The baked bone, so that it need not be baked again.
  void save_bone(const std::filesystem::path& path);
  /// The report on all paths of the plan, as `spinaltap grade` writes it.
  void save_report(const std::filesystem::path& path);
  /// The record and the report of the drilling that stands (played_hole.h).
  void save_record(const std::filesystem::path& path);
  void write_drill_report(const std::filesystem::path& folder);
  /// Adds what suggest_paths() finds, as one step back; in the background. Throws Error without a bone with landmarks.
  void suggest();

  /// The file that the plan was read from or saved to; empty: none yet.
  const std::filesystem::path& plan_file() const { return plan_file_; }
  /// Another program has changed that file since.
  bool is_plan_file_foreign() const;
  bool has_unsaved_changes() const { return !document_.undo_stack().isClean(); }

 Q_SIGNALS:
  void opened(const QString& file);  ///< is there, and the panes show it
  void said(const QString& what);    ///< for the status bar
  void trouble(const QString& what, const QString& why);
  void no_bone(const QString& why);  ///< in the CT that was opened: its slices are all there is

 private:
  void open_at_once(const std::filesystem::path& path, const OpenOptions& options);
  void open_next();
  void take_levels();
  void take_baked(int index);
  void bake_for_plan();
  void give_plan_up(const QString& why);
  void write_drilling(const QString& what, const std::filesystem::path& path,
                      const std::function<void(const DoneDrilling&, const Progress&)>& write);
  void offer_bone(const std::shared_ptr<const OpenedBone>& bone);
  void show_bone(const std::shared_ptr<const OpenedBone>& bone);
  void show_chosen_path();
  void take_plan_file(const std::filesystem::path& file);
  void open_plan(const std::filesystem::path& file);
  void take_plan(std::vector<DrillPath> paths, const std::filesystem::path& file);

  PathGrader grader_;
  PlanDocument document_;
  ViewState view_;
  DrillPlayer player_;
  Questions questions_;
  std::filesystem::path plan_file_;
  std::vector<SuggestedPath> suggested_;  ///< for this bone, last; for the reasons of paths that are still among them
  std::optional<std::filesystem::file_time_type> plan_file_time_;
  struct ToOpen {
    std::filesystem::path path;
    OpenOptions options;
  };
  std::optional<ToOpen> next_;          ///< to open when job_ has ended
  bool is_opening_ = false;             ///< that is what job_ does
  std::filesystem::path plan_waiting_;  ///< for its bone; empty: none
  int wanted_ = -1;                     ///< the level that is shown once it is baked
  Vec3 placed_mm_ = Vec3::Zero();       ///< where the program put the crosshair: nobody moved it since, if it is there
  CtLevels levels_;
  BackgroundJob job_;  ///< last: it ends before what it works for
};

}  // namespace spinaltap
