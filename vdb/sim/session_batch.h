#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "core/base/progress.h"
#include "core/session/drill_session.h"
#include "core/session/session_setup.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

/// A path in a bone.
struct BonePath {
  Bone bone;
  DrillPath path;
};

/// Many drillings that begin again and again, on all cores: what learning by trial asks for. Those of one bone and path
/// share its walls; each has points of its own, which reset() makes whole within milliseconds.
class SessionBatch {
 public:
  /// `count` sessions; the n-th drills holes[n % holes.size()]. `setup`: its path and its bone's fingerprint are taken
  /// from the hole. `threads`: how many cores it may use, 0: all. Throws Error without holes or sessions, and as
  /// build_session() does.
  SessionBatch(std::vector<BonePath> holes, std::size_t count, const SessionSetup& setup, int threads = 0,
               const Progress& progress = {});
  ~SessionBatch();
  SessionBatch(SessionBatch&&) noexcept;
  SessionBatch& operator=(SessionBatch&&) noexcept;
  SessionBatch(const SessionBatch&) = delete;
  SessionBatch& operator=(const SessionBatch&) = delete;

  std::size_t count() const;
  DrillSession& session(std::size_t n);
  /// Puts all bone back, to time 0 and cycle 0. References to the session before no longer hold. Different sessions may
  /// be reset and stepped at once.
  DrillSession& reset(std::size_t n);

  /// Calls `work` for each n below count(), each once, many at once; returns when all are done. What the sessions come
  /// to does not depend on the threads. Throws what `work` throws.
  void for_each(const std::function<void(std::size_t n)>& work);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace spinaltap
