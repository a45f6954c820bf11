#pragma once

#include <QObject>
#include <QString>
#include <memory>
#include <optional>
#include <vector>

#include "apps/spinaltap-planner/background_job.h"
#include "apps/spinaltap-planner/opened_bone.h"

namespace spinaltap {

/// A vertebra of the open CT, and how far it has come.
struct CtLevel {
  enum class State { found, waiting, baking, baked, failed };

  LevelReport report;  ///< of one that was pointed at only the body's place, which is where
  State state = State::found;
  QString why;                             ///< it failed, in words
  std::shared_ptr<const OpenedBone> bone;  ///< once it is baked

  /// It is not in the map of levels.
  bool is_pointed_at() const { return report.label == 0; }
  QString name() const;
  /// Around all of it, by its body; patient LPS, mm.
  Box3 box_mm() const;
};

/// The vertebrae of the open CT: they are looked for as soon as it is there, and baked as they are asked for, one after
/// the other, all in the background.
class CtLevels : public QObject {
  Q_OBJECT
 public:
  /// Of the search.
  enum class Search { none, running, found, failed, cancelled };

  explicit CtLevels(QObject* parent = nullptr);

  /// Another CT: begins to look for its vertebrae, and ends all work on the one before. Null: there is none.
  void set_ct(std::shared_ptr<const OpenedBone> ct);
  /// Looks for them again, after it was cancelled.
  void find();

  Search search() const { return search_; }
  /// Why none were found.
  const QString& why_none() const { return why_none_; }
  /// Null until they are found.
  const std::shared_ptr<const SpineSegmentation>& found() const { return found_; }
  const std::vector<CtLevel>& levels() const { return levels_; }
  /// The level whose bone holds a place (patient LPS, mm), or that has a name; -1: none.
  int at(const Vec3& p_mm) const;
  int named(Level level) const;
  /// The level whose bone this is; -1: none of theirs.
  int of(const OpenedBone* bone) const;
  /// The largest of those that the CT holds whole, of all where there is none; -1 without any.
  int largest() const;
  /// The only one that the CT holds whole; -1: there is none, or several.
  int only_whole() const;

  /// That is baked next; -1: none waits.
  int next() const;

  /// Puts it in the row of those that are baked, where it is not baked yet.
  void bake(int index);
  /// The vertebra whose body holds a place: a level that was found, or one more, which is looked for there when it is
  /// baked.
  int pointed_at(const Vec3& p_mm);
  /// Ends the search, or the bake and all that wait.
  void cancel();
  /// It looks for levels, bakes one or has one waiting.
  bool is_working() const;
  bool is_baking() const;
  BackgroundJob& job() { return job_; }

 Q_SIGNALS:
  void changed();       ///< the search, or any of them
  void search_ended();  ///< they are found, or not
  void baked(int index);
  void failed(int index);

 private:
  void go_on();
  void start_search();
  void start_bake(std::size_t index);
  void take_found(std::shared_ptr<const SpineSegmentation> found);
  void take_end(bool is_done, const QString& why);

  std::shared_ptr<const OpenedBone> ct_;
  Search search_ = Search::none;
  QString why_none_;
  std::shared_ptr<const SpineSegmentation> found_;
  std::vector<CtLevel> levels_;
  std::shared_ptr<const OpenedBone> worked_on_;  ///< the CT of the work that runs
  std::optional<std::size_t> baking_;            ///< of it; nothing: that looks for them
  BackgroundJob job_;                            ///< last: it ends before what it works for
};

}  // namespace spinaltap
