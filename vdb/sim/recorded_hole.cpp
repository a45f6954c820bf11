#include "vdb/sim/recorded_hole.h"

#include <algorithm>
#include <vector>

#include "core/base/error.h"
#include "core/session/operator/straight_ways.h"
#include "vdb/remaining/subtract_bit.h"
#include "vdb/sim/replay.h"

namespace spinaltap {

RecordedHole::RecordedHole(const BoneModel& bone, const SessionRecord& record, const DrillBit& bit,
                           double longest_jump_mm)
    : bone_(bone), record_(record), bit_(bit), longest_jump_mm_(longest_jump_mm), drilled_(bone) {
  if (record.cycles.empty()) fail("the record holds no cycle: nothing was drilled yet");
}

void RecordedHole::go_to(double time_s) {
  const auto later = std::upper_bound(record_.cycles.begin(), record_.cycles.end(), time_s,
                                      [](double time, const RecordedCycle& row) { return time < row.time_s; });
  const auto wanted = std::max<std::size_t>(1, static_cast<std::size_t>(later - record_.cycles.begin()));
  if (wanted < cycles_) {
    drilled_ = bone_;
    cycles_ = 1;
  }
  if (wanted == cycles_) return;
  // The last pose that was drilled begins the way to the next.
  std::vector<ToolInput> inputs;
  for (std::size_t n = cycles_ - 1; n < wanted; ++n) inputs.push_back(input_of(record_.cycles[n]));
  drilled_ = subtract_bit(drilled_, bit_, straight_ways(inputs, bit_, longest_jump_mm_));
  cycles_ = wanted;
}

Pose RecordedHole::pose() const {
  const RecordedCycle& row = record_.cycles[cycles_ - 1];
  return {row.tip_mm, row.axis};
}

}  // namespace spinaltap
