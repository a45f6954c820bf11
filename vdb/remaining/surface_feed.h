#pragma once

#include <array>
#include <map>
#include <mutex>
#include <span>
#include <vector>

#include "vdb/remaining/surface_block.h"

namespace spinaltap {

/// Hands blocks of a surface from the thread that drills to one that draws. Of each block only the latest waits, so
/// memory is bounded by the surface however slowly is drawn; blocks are shared and never change, so nobody waits while
/// they are drawn. Both sides hold the lock for as long as it takes to move some pointers.
class SurfaceFeed {
 public:
  void give(std::span<const SurfaceUpdate> updates) {
    const std::lock_guard lock(mutex_);
    for (const SurfaceUpdate& update : updates) waiting_[update.block] = update;
  }

  /// What was given since the last call, in a fixed order.
  std::vector<SurfaceUpdate> take() {
    std::map<std::array<int, 3>, SurfaceUpdate> taken;
    {
      const std::lock_guard lock(mutex_);
      taken.swap(waiting_);
    }
    std::vector<SurfaceUpdate> updates;
    updates.reserve(taken.size());
    for (auto& [block, update] : taken) updates.push_back(std::move(update));
    return updates;
  }

 private:
  std::mutex mutex_;
  std::map<std::array<int, 3>, SurfaceUpdate> waiting_;
};

}  // namespace spinaltap
