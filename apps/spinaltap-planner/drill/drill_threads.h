#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "apps/spinaltap-planner/drill/played_hole.h"
#include "vdb/remaining/live_mesh.h"
#include "vdb/remaining/surface_block.h"

namespace spinaltap {

/// What has happened since somebody last asked.
struct DrillNews {
  std::vector<DepthRow> rows;        ///< those that have become whole since then
  std::vector<SessionEvent> events;  ///< all so far
  Cycle last;
  std::size_t cycles = 0;           ///< all so far
  std::size_t removed = 0;          ///< points, all so far
  std::size_t surface_updates = 0;  ///< of these threads
  bool is_new = false;
};

/// Two threads that drill a hole: one runs its cycles at the pace of a clock, the other brings the surface up to date.
/// Hole and mesh are theirs until stop() has returned.
///
/// Cycles that come late are made up for within 50 ms; what is later than that is not: the drilling then takes longer.
class DrillThreads {
 public:
  /// `speed`: as DrillPlan has it. `on_end` is called on one of the threads, when both are done.
  DrillThreads(PlayedHole& hole, LiveMesh& mesh, double speed, std::function<void()> on_end);
  /// Waits; what the surface lacks by then is not caught up on.
  ~DrillThreads();
  DrillThreads(const DrillThreads&) = delete;
  DrillThreads& operator=(const DrillThreads&) = delete;

  void set_speed(double speed) { speed_ = speed; }
  /// Ends the cycles at once and returns when the surface has all of them. Also after on_end.
  void stop();
  DrillNews take_news();
  std::vector<SurfaceUpdate> take_surface() { return surface_.take(); }
  /// What went wrong, in words; after stop().
  const std::string& trouble() const { return trouble_; }

 private:
  void run_cycles();
  void run_paced();
  void run_mesh();
  void publish();
  void guard(const std::function<void()>& work);

  PlayedHole& hole_;
  LiveMesh& mesh_;
  std::function<void()> on_end_;
  std::atomic<double> speed_;
  std::atomic<bool> stops_{false};
  std::atomic<bool> is_abandoned_{false};
  SurfaceFeed surface_;

  std::size_t published_inputs_, published_rows_;  ///< the cycles' thread's

  std::mutex mutex_;  ///< of what follows
  std::condition_variable wakes_;
  DrillNews news_;
  std::vector<ToolInput> to_mesh_;
  bool has_no_more_cycles_ = false;
  std::string trouble_;

  std::thread cycles_, meshing_;
};

}  // namespace spinaltap
