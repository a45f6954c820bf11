#include "apps/spinaltap-planner/navigation/record_source.h"

#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "core/files/recorded_setup.h"
#include "core/session/operator/recorded_motion.h"
#include "core/session/record/session_record.h"
#include "vdb/sim/replay.h"

namespace spinaltap {

RecordSource::RecordSource(SessionSetup setup, std::vector<ToolInput> inputs,
                           std::map<std::string, std::string> operator_words)
    : setup_(std::move(setup)), inputs_(std::move(inputs)), words_(std::move(operator_words)) {}

OperatorPlan RecordSource::begin(const SessionSetup& /*setup*/, const Progress& /*progress*/) {
  OperatorPlan plan;
  double seconds = 0.0;
  for (std::size_t n = 1; n < inputs_.size(); ++n) seconds += inputs_[n].dt_s;
  if (seconds > 0.0) plan.rate_hz = static_cast<double>(inputs_.size() - 1) / seconds;
  plan.words = words_;
  plan.tool_operator = std::make_unique<RecordedMotion>(inputs_, false);
  return plan;
}

std::shared_ptr<RecordSource> open_record(const std::filesystem::path& file, const Bone& bone) {
  const SessionRecord record = read_record(file);
  SessionSetup setup = recorded_setup(record.setup, file);
  if (!setup.further_bone_hashes.empty()) {
    fail("expected a record of one bone, found one of ", setup.further_bone_hashes.size() + 1, " in ", file.string());
  }
  if (setup.bone_hash != bone.hash()) fail("expected the bone that was drilled in ", file.string(), ", found another");
  if (!setup.holes.empty()) {
    fail("expected a record of a bone that was whole, found one with ", setup.holes.size(), " holes in ",
         file.string());
  }
  if (record.cycles.empty()) fail("expected a record with cycles, found none in ", file.string());
  if (record.lost > 0) {
    fail("expected a record of all cycles, found one that lacks ", record.lost, " of them: ", file.string());
  }
  std::vector<ToolInput> inputs;
  inputs.reserve(record.cycles.size());
  for (const RecordedCycle& row : record.cycles) inputs.push_back(input_of(row));
  std::map<std::string, std::string> words;  // as record_words() has them
  constexpr std::string_view kOfOperator = "operator ";
  for (const auto& [name, value] : record.setup) {
    if (name.starts_with(kOfOperator)) words[name.substr(kOfOperator.size())] = value;
  }
  auto source = std::make_shared<RecordSource>(std::move(setup), std::move(inputs), std::move(words));
  source->set_name(file.filename().string());
  return source;
}

}  // namespace spinaltap
