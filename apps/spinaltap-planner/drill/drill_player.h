#pragma once

#include <QObject>
#include <QTimer>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "apps/spinaltap-planner/background_job.h"
#include "apps/spinaltap-planner/drill/played_hole.h"
#include "apps/spinaltap-planner/plan_document.h"
#include "vdb/remaining/surface_block.h"

namespace spinaltap {

class DrillThreads;
struct DrillNews;
class LiveMesh;

/// All that it takes to drill a hole again: every pace has the same cycles.
struct HoleOrder {
  DrillPath path;
  DrillPlan plan;
  std::size_t cycles = 0;  ///< that were drilled of it
};

/// Drills the document's chosen path on threads of its own, and keeps the holes that were drilled, to be undone. All
/// that is asked and told is on the owner's thread. Every pace has the same cycles: the clock only says when they run.
///
/// A hole is a hole for those that are drilled after it as well: forces know of it.
class DrillPlayer : public QObject {
  Q_OBJECT
 public:
  enum class State {
    idle,       ///< no hole
    preparing,  ///< on the way to drilling, or back in time
    drilling,
    stopped  ///< by the person, a rule or at the end
  };

  explicit DrillPlayer(PlanDocument& document, QObject* parent = nullptr);
  /// Stops and waits.
  ~DrillPlayer() override;

  State state() const { return state_; }
  /// What start() was last asked for.
  const DrillPlan& plan() const { return plan_; }
  /// A new hole, along the path as it now is. What makes no sense is told by failed().
  void start(const DrillPlan& plan);
  /// At once; the bit stays where it is. What is being prepared is given up.
  void stop();
  bool can_go_on() const;
  /// From where it stopped.
  void go_on();
  bool can_step_back() const;
  /// Bone and bit as they were so long ago, by the operator's time; go_on() drills on from there.
  void step_back(double seconds);
  /// Of the clock, as DrillPlan has it; also while it drills.
  void set_speed(double speed);

  /// Whole holes, the last first.
  bool can_undo_hole() const;
  void undo_hole();
  bool can_redo_hole() const;
  void redo_hole();
  /// The bone as opened, without holes and with none to be redone.
  void reset();

  /// The hole that was drilled last and not undone; while it is drilled, what is known of it, up to 33 ms ago.
  const std::vector<DepthRow>& rows() const { return rows_; }
  const std::optional<Cycle>& last() const { return last_; }
  const std::vector<SessionEvent>& events() const { return events_; }
  std::size_t removed() const { return removed_; }  ///< points, or voxels where those are drilled
  /// With the engine that was taken for it; null where there is no hole.
  const SessionSetup* setup() const;
  /// Its path, as it was at the start; null where there is none.
  const DrillPath* path() const;
  std::optional<std::pair<DrillBit, Pose>> bit() const;
  double spindle_rpm() const;  ///< 0 where there is none
  /// Of the operator's time.
  double seconds() const { return last_ ? last_->time_s : 0.0; }
  /// How fast cycles have run and how often the surface was brought up to date, in the last half second of drilling; 0
  /// where that is not known.
  double cycles_per_s() const { return cycles_per_s_; }
  double surface_updates_per_s() const { return surface_updates_per_s_; }
  bool is_over() const;  ///< its operator has ended

  /// How far holes have come, one number of cycles each: for mark_saved(). Of one that is being drilled, 0.
  using Progresses = std::vector<std::pair<std::shared_ptr<const PlayedHole>, std::size_t>>;
  Progresses progresses() const;
  /// A record or a report of the holes as they then were is written.
  void mark_saved(const Progresses& written);
  /// A hole stands, or is being drilled, of which there is no record and no report.
  bool has_unsaved() const;

  /// The holes, the first first, as far as they can be had again: up to the first that a NavigationSource drilled. Of
  /// one that is being drilled what is known, up to 33 ms ago.
  std::vector<HoleOrder> orders() const;
  /// Drills holes again, in place of those that stand, as fast as it goes; then it stands still.
  void drill_again(const std::vector<HoleOrder>& orders);

  /// The hole with all that it takes to write it from any thread (played_hole.h); nothing while it is drilled and
  /// where there is none.
  std::optional<DoneDrilling> done() const;

 Q_SIGNALS:
  void started();  ///< with plan()
  void state_changed();
  /// What there is to show has changed: at most 30 times a second.
  void progressed();
  /// For 3D: blocks as in OpenedBone::surface.
  void surface_changed(const std::vector<spinaltap::SurfaceUpdate>& updates);
  void failed(const QString& why);

 private:
  struct Hole {
    std::shared_ptr<PlayedHole> played;
    DrillPlan plan;
    std::size_t mesh_before = 0;  ///< holes of the mesh when it began
    std::size_t mesh_holes = 0;   ///< how many of them it was when it was undone
    std::size_t saved_cycles = 0;
  };
  struct Rates {
    std::chrono::steady_clock::time_point since;
    std::size_t cycles = 0;
    std::size_t surface_updates = 0;
  };

  void prepare(const QString& what, std::function<std::function<void()>(const Progress&)> work);
  void end_preparing(bool is_done, const QString& trouble);
  void drill_on();
  void end_drilling();
  void look();
  void measure_rates(const DrillNews& news, double min_s);
  void show_hole();
  void forget_all();
  void rewind_mesh();
  std::size_t undo_in_mesh();
  void give_surface();
  bool is_busy() const { return state_ == State::preparing || state_ == State::drilling; }
  void set_state(State state);
  void guard(const std::function<void()>& work);

  PlanDocument& document_;
  State state_ = State::idle;
  DrillPlan plan_;
  std::shared_ptr<const OpenedBone> bone_;  ///< that the mesh is of
  std::shared_ptr<LiveMesh> mesh_;          ///< null before the first hole
  std::vector<Hole> drilled_, undone_;
  SurfaceFeed surface_;
  bool wants_reset_ = false;

  std::vector<DepthRow> rows_;
  std::optional<Cycle> last_;
  std::vector<SessionEvent> events_;
  std::size_t removed_ = 0;
  std::size_t known_cycles_ = 0;
  double cycles_per_s_ = 0.0;
  double surface_updates_per_s_ = 0.0;
  Rates rates_;

  QTimer timer_;
  std::uint64_t run_ = 0;  ///< counts drill_on(), so that the end of an older one is known as such
  BackgroundJob job_;
  std::unique_ptr<DrillThreads> threads_;
};

}  // namespace spinaltap
