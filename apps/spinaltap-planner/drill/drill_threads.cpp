#include "apps/spinaltap-planner/drill/drill_threads.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <utility>

#include "core/session/real_time/pacer.h"
#include "core/session/real_time/timing.h"

namespace spinaltap {
namespace {

constexpr double kTicksPerS = 1000.0;
constexpr double kMaxLateS = 0.05;
constexpr std::int64_t kPublishNs = 16'000'000;
constexpr int kUnpacedCycles = 64;  ///< between looks at whether to stop

}  // namespace

DrillThreads::DrillThreads(PlayedHole& hole, LiveMesh& mesh, double speed, std::function<void()> on_end)
    : hole_(hole),
      mesh_(mesh),
      on_end_(std::move(on_end)),
      speed_(speed),
      published_inputs_(hole.inputs().size()),
      published_rows_(hole.rows().size()) {
  cycles_ = std::thread([this] { run_cycles(); });
  meshing_ = std::thread([this] { run_mesh(); });
}

DrillThreads::~DrillThreads() {
  is_abandoned_ = true;
  stop();
}

void DrillThreads::stop() {
  stops_ = true;
  if (cycles_.joinable()) cycles_.join();
  if (meshing_.joinable()) meshing_.join();
}

DrillNews DrillThreads::take_news() {
  const std::lock_guard lock(mutex_);
  DrillNews taken = news_;
  news_.rows.clear();
  news_.is_new = false;
  return taken;
}

void DrillThreads::guard(const std::function<void()>& work) {
  try {
    work();
  } catch (const std::exception& error) {
    stops_ = true;
    const std::lock_guard lock(mutex_);
    trouble_ = error.what();
  }
}

void DrillThreads::run_cycles() {
  guard([this] { run_paced(); });
  guard([this] { publish(); });
  const std::lock_guard lock(mutex_);
  has_no_more_cycles_ = true;
  wakes_.notify_one();
}

void DrillThreads::run_paced() {
  Pacer pacer(wall_ns(), kTicksPerS);
  std::int64_t published_ns = wall_ns();
  double due = 0.0;  // cycles
  bool goes_on = true;
  while (goes_on && !stops_) {
    const double speed = speed_;
    if (speed > 0.0) {
      const double cycles_a_tick = speed * hole_.rate_hz() / kTicksPerS;
      due += static_cast<double>(pacer.wait()) * cycles_a_tick;
      due = std::min(due, std::max(1.0, kMaxLateS * kTicksPerS * cycles_a_tick));
    } else {
      due = kUnpacedCycles;
    }
    for (; due >= 1.0 && goes_on; due -= 1.0) goes_on = hole_.step();
    if (speed > 0.0) pacer.finish(true);
    if (wall_ns() - published_ns < kPublishNs) continue;
    publish();
    published_ns = wall_ns();
  }
}

void DrillThreads::publish() {
  const std::vector<ToolInput>& inputs = hole_.inputs();
  const std::vector<DepthRow>& rows = hole_.rows();
  if (inputs.size() == published_inputs_) return;
  const std::lock_guard lock(mutex_);
  to_mesh_.insert(to_mesh_.end(), inputs.begin() + static_cast<std::ptrdiff_t>(published_inputs_), inputs.end());
  news_.rows.insert(news_.rows.end(), rows.begin() + static_cast<std::ptrdiff_t>(published_rows_), rows.end());
  news_.events.assign(hole_.events().begin(), hole_.events().end());
  news_.last = hole_.last();
  news_.cycles = inputs.size();
  news_.removed = hole_.removed();
  news_.is_new = true;
  published_inputs_ = inputs.size();
  published_rows_ = rows.size();
  wakes_.notify_one();
}

void DrillThreads::run_mesh() {
  guard([this] {
    for (bool goes_on = true; goes_on;) {
      std::vector<ToolInput> inputs;
      {
        std::unique_lock lock(mutex_);
        wakes_.wait(lock, [this] { return has_no_more_cycles_ || !to_mesh_.empty(); });
        inputs.swap(to_mesh_);
        goes_on = !has_no_more_cycles_;
      }
      if (is_abandoned_) return;
      if (inputs.empty()) continue;
      mesh_.update(inputs);
      surface_.give(mesh_.updates());
      const std::lock_guard lock(mutex_);
      ++news_.surface_updates;
    }
  });
  on_end_();
}

}  // namespace spinaltap
