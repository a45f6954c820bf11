#include "core/files/planning_rules_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/files/data_files.h"
#include "core/files/json_file.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(PlanningRulesFile, ShippedIsWhatTheLibraryTakesByItself) {
  const SuggestOptions shipped = read_planning_rules(data_file("planning/pedicle.json"));
  const SuggestOptions own;
  EXPECT_EQ(shipped.margin_mm, own.margin_mm);
  EXPECT_EQ(shipped.front_margin_mm, own.front_margin_mm);
  EXPECT_EQ(shipped.widest_share, own.widest_share);
  EXPECT_EQ(shipped.furthest_share, own.furthest_share);
  EXPECT_EQ(shipped.max_turn_deg, own.max_turn_deg);
  EXPECT_EQ(shipped.weights.length, own.weights.length);
  EXPECT_EQ(shipped.weights.diameter, own.weights.diameter);
  EXPECT_EQ(shipped.weights.clearance, own.weights.clearance);
  EXPECT_EQ(shipped.weights.canal, own.weights.canal);
  EXPECT_EQ(shipped.weights.endplates, own.weights.endplates);
  EXPECT_EQ(shipped.weights.density, own.weights.density);
  EXPECT_EQ(shipped.weights.along_axis, own.weights.along_axis);
  EXPECT_EQ(shipped.weights.fixation, own.weights.fixation);
}

TEST(PlanningRulesFile, OfBeforeFixationCountedPlansAsThen) {
  const test::TemporaryFolder folder;
  Json json = read_json(data_file("planning/pedicle.json"));
  json["weights"].erase("fixation");
  std::ofstream(folder.path() / "rules.json") << json.dump();
  EXPECT_EQ(read_planning_rules(folder.path() / "rules.json").weights.fixation, 0.0);
  json["weights"]["hold"] = 0.5;  // its name in 0.1
  std::ofstream(folder.path() / "rules.json", std::ios::trunc) << json.dump();
  EXPECT_EQ(read_planning_rules(folder.path() / "rules.json").weights.fixation, 0.5);
}

TEST(PlanningRulesFile, IsRejectedWithTheKeyAtFaultNamed) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "rules.json";
  const auto rejects_changed = [&](const auto& change, const char* word) {
    Json json = read_json(data_file("planning/pedicle.json"));
    change(json);
    std::ofstream(path, std::ios::trunc) << json.dump();
    EXPECT_THAT([&] { read_planning_rules(path); },
                ThrowsMessage<Error>(AllOf(HasSubstr("rules.json"), HasSubstr(word))));
  };
  rejects_changed([](Json& json) { json.erase("margin_mm"); }, "margin_mm");
  rejects_changed([](Json& json) { json["widest_share"] = "wide"; }, "widest_share");
  rejects_changed([](Json& json) { json["marginn_mm"] = 2.0; }, "marginn_mm");
  rejects_changed([](Json& json) { json["weights"]["canals"] = 2.0; }, "canals");
  rejects_changed([](Json& json) { json["weights"]["hold"] = 0.5; }, "old name");
  rejects_changed([](Json& json) { json["weights"].erase("canal"); }, "canal");
  rejects_changed([](Json& json) { json["weights"] = 3; }, "object");
}

}  // namespace
}  // namespace spinaltap
