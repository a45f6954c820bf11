#pragma once

#include <chrono>
#include <ctime>
#include <string>
#include <utility>
#include <vector>

namespace spinaltap {

/// How long one stage of longer work took.
struct StageTime {
  std::string name;
  double wall_s = 0.0;
  double processor_s = 0.0;  ///< of all threads of the process
};

/// Tells one stage's time after the other. What it tells belongs in no output that is to be the same each time.
class StageClock {
 public:
  /// The first stage begins.
  StageClock() : wall_(std::chrono::steady_clock::now()), processor_(std::clock()) {}

  /// The stage that began last ends under this name, and the next one begins.
  void end(std::string name) {
    const auto wall = std::chrono::steady_clock::now();
    const std::clock_t processor = std::clock();
    times_.push_back({std::move(name), std::chrono::duration<double>(wall - wall_).count(),
                      static_cast<double>(processor - processor_) / static_cast<double>(CLOCKS_PER_SEC)});
    wall_ = wall;
    processor_ = processor;
  }
  /// Stages that others timed, since the last end: the next one begins.
  void take(const std::vector<StageTime>& times) {
    times_.insert(times_.end(), times.begin(), times.end());
    wall_ = std::chrono::steady_clock::now();
    processor_ = std::clock();
  }

  const std::vector<StageTime>& times() const { return times_; }
  /// Of all stages that have ended.
  StageTime total() const {
    StageTime total{"total"};
    for (const StageTime& time : times_) {
      total.wall_s += time.wall_s;
      total.processor_s += time.processor_s;
    }
    return total;
  }

 private:
  std::chrono::steady_clock::time_point wall_;
  std::clock_t processor_;
  std::vector<StageTime> times_;
};

}  // namespace spinaltap
