#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/engine/step_result.h"
#include "core/session/operator/operator.h"
#include "core/session/record/session_record.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

/// What the operator gave to a recorded cycle.
ToolInput input_of(const RecordedCycle& row);

/// What running a record again came to.
struct Replay {
  std::size_t cycles = 0;  ///< that were run and compared
  std::size_t events = 0;  ///< that were compared
  double seconds = 0.0;    ///< that running them took
  std::string difference;  ///< the first, with cycle, quantity and both values; empty: every bit is the same
  /// Where the record lacks cycles, which nobody can run again: what comes after is not compared. Empty: it does not.
  std::string gap;

  bool is_same() const { return difference.empty() && gap.empty(); }
};

/// Runs a record again on the bone that it was drilled in, with another engine where one is given (`automatic`: the
/// record's own). Throws
/// Error as read_record() does, on a record that is none of a session, and on another bone.
Replay replay(const std::filesystem::path& record, const Bone& bone, std::optional<EngineKind> engine = {},
              const Progress& progress = {});
/// As above, of a record that was read from `file`, which messages name.
Replay replay(const SessionRecord& record, const std::filesystem::path& file, const Bone& bone,
              std::optional<EngineKind> engine = {}, const Progress& progress = {});
/// Of several bones, in the order in which they were drilled. `takes_other_ct`: other bones than those that were
/// drilled are taken all the same, which the cycles then tell.
Replay replay(const SessionRecord& record, const std::filesystem::path& file, std::span<const Bone> bones,
              std::optional<EngineKind> engine = {}, const Progress& progress = {}, bool takes_other_ct = false);

}  // namespace spinaltap
