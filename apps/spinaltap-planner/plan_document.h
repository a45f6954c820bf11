#pragma once

#include <QObject>
#include <QUndoStack>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "apps/spinaltap-planner/opened_bone.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

class ReplacePaths;

/// Which end of a path.
enum class PathEnd { entry, target };

/// The plan that is being made: a bone and paths through it, each change of which can be undone. The window, its panes
/// and scripts change it only through here; they draw anew at its signals.
class PlanDocument : public QObject {
  Q_OBJECT
 public:
  explicit PlanDocument(QObject* parent = nullptr);
  ~PlanDocument() override;

  /// Null: there is none, or only a CT in which none was found.
  const std::shared_ptr<const OpenedBone>& bone() const { return bone_; }
  /// The same, or a CT without a bone: what slices are of. Null: nothing is open.
  const std::shared_ptr<const OpenedBone>& opened() const { return opened_; }
  /// Another bone, or a CT without one: an empty plan, nothing to undo.
  void set_bone(std::shared_ptr<const OpenedBone> bone);
  /// The vertebrae that were found in what slices are of; null: not yet, or none. Another CT has none.
  const std::shared_ptr<const SpineSegmentation>& levels() const { return levels_; }
  void set_levels(std::shared_ptr<const SpineSegmentation> levels);
  /// Another plan for this bone, as read from a file: nothing to undo. Throws Error where a path is bad.
  void set_paths(std::vector<DrillPath> paths);

  const std::vector<DrillPath>& paths() const { return paths_; }
  /// Index of the path that the panels are about; -1 where there is none.
  int chosen() const { return chosen_; }
  const DrillPath* chosen_path() const;
  void choose(int index);
  /// Counts the plan's changes, undo and redo among them: another number, another plan.
  std::uint64_t revision() const { return revision_; }

  /// Changes, each one step back. All throw Error where the path would be bad (check_path()); then nothing changed.
  /// Returns the new path's index and chooses it; the name is made unlike the others'.
  int add_path(DrillPath path);
  /// Several as one step back, the first of which is chosen; nothing happens without any.
  void add_paths(std::vector<DrillPath> paths, const QString& what);
  void remove_path(int index);
  /// A new name is made unlike the others'. `what`: for the menu, such as "move entry". Changes with the same `drag`
  /// other than 0 become one step back.
  void change_path(int index, DrillPath path, const QString& what, std::uint64_t drag = 0);
  /// Puts an end of a path to a place; the entry goes to the nearest place of the bone's surface. False where the place
  /// makes no path (the ends too near); then nothing changed.
  bool move_end(int index, PathEnd end, const Vec3& p_mm, std::uint64_t drag = 0);
  /// A number for one drag: never the same twice.
  std::uint64_t new_drag() { return ++last_drag_; }
  /// Takes back what a drag changed, as if it had not been: what could be redone before it can be again. Nothing
  /// happens where it changed nothing, or where another change came after it.
  void give_up(std::uint64_t drag);

  /// Undo, redo, and whether the plan is as it was last saved.
  QUndoStack& undo_stack() { return undo_stack_; }
  const QUndoStack& undo_stack() const { return undo_stack_; }

 Q_SIGNALS:
  void bone_changed();
  void levels_changed();
  void paths_changed();   ///< any of them: places, names, tools, how many
  void chosen_changed();  ///< another path, or none

 private:
  friend class ReplacePaths;
  void take_paths(std::vector<DrillPath> paths, int chosen);
  void push(ReplacePaths* change);

  std::shared_ptr<const OpenedBone> opened_, bone_;
  std::shared_ptr<const SpineSegmentation> levels_;
  std::vector<DrillPath> paths_;
  int chosen_ = -1;
  std::uint64_t revision_ = 0;
  QUndoStack undo_stack_;
  std::uint64_t last_drag_ = 0;
  struct Drag;
  std::unique_ptr<Drag> drag_;  ///< the last
  bool keeps_paths_ = false;    ///< while steps are put back onto the stack that are not to happen
};

}  // namespace spinaltap
