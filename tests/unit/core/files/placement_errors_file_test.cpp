#include "core/files/placement_errors_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/files/data_files.h"
#include "core/files/json_file.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

std::string complaint_about(const Json& json) {
  const test::TemporaryFolder folder;
  write_json(json, folder.path() / "errors.json");
  try {
    read_placement_errors(folder.path() / "errors.json");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

Json shipped_errors() { return read_json(data_file("errors/robot_726.json")); }

TEST(PlacementErrorsFile, AreThoseOf726ScrewsWhereTheRobotIsAskedFor) {
  const PlacementErrors errors = placement_errors_of("robot_726");
  EXPECT_EQ(errors.name, "robot_726");
  // Root mean squares of published mean and deviation, a half of the square to each side.
  EXPECT_NEAR(errors.entry_mm.medial, std::hypot(2.2, 1.4) / std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(errors.direction_deg.cranial, std::hypot(2.9, 2.3) / std::sqrt(2.0), 1e-9);
  EXPECT_LT(errors.correlation, 0.0);
  EXPECT_FALSE(errors.sources.empty());
}

TEST(PlacementErrorsFile, EveryShippedModelIsReadAndHasItsFilesName) {
  const std::vector<std::string> models = placement_error_models();
  EXPECT_THAT(models, Contains("navigation_209"));
  EXPECT_THAT(models, Contains("freehand_experienced"));
  for (const std::string& model : models) EXPECT_EQ(placement_errors_of(model).name, model);
}

TEST(PlacementErrorsFile, TwoNumbersAreStandardDeviations) {
  const PlacementErrors errors = placement_errors_of("1.5,2");
  EXPECT_EQ(errors.entry_mm.medial, 1.5);
  EXPECT_EQ(errors.entry_mm.cranial, 1.5);
  EXPECT_EQ(errors.direction_deg.medial, 2.0);
  EXPECT_EQ(errors.entry_mm.shape, 2.0);
  EXPECT_EQ(errors.correlation, 0.0);
  for (const char* bad :
       {"", "1.5", "1,2,3", "1,", ",1", "1;2", "robot", "-1,2", "1,nan", "inf,1", "../errors/robot_726"}) {
    EXPECT_THROW(placement_errors_of(bad), Error) << bad;
  }
}

TEST(PlacementErrorsFile, SidesAndBiasesAreReadToo) {
  const test::TemporaryFolder folder;
  Json json = shipped_errors();
  json.erase("tip");
  json.erase("screw_length_mm");
  json["correlation"] = 0.25;
  json["entry"] = {
      {"medial_mm", {{"mean", 0.5}, {"sd", 1.0}}}, {"cranial_mm", {{"mean", -0.5}, {"sd", 2.0}}}, {"shape", 1.5}};
  json["along_mm"] = {{"mean", 0.1}, {"sd", 0.2}};
  write_json(json, folder.path() / "own.json");
  const PlacementErrors errors = read_placement_errors(folder.path() / "own.json");
  EXPECT_EQ(errors.entry_mm.medial_bias, 0.5);
  EXPECT_EQ(errors.entry_mm.cranial_bias, -0.5);
  EXPECT_EQ(errors.entry_mm.cranial, 2.0);
  EXPECT_EQ(errors.entry_mm.shape, 1.5);
  EXPECT_EQ(errors.along_mm, 0.2);
  EXPECT_EQ(errors.correlation, 0.25);
}

TEST(PlacementErrorsFile, ComplaintsNameFileAndKey) {
  Json json = shipped_errors();
  json["entri"] = 1.0;
  EXPECT_THAT(complaint_about(json), HasSubstr("\"entri\""));
  json = shipped_errors();
  json["entry"]["distance_mm"]["median"] = 1.0;
  EXPECT_THAT(complaint_about(json), HasSubstr("\"median\""));
  json = shipped_errors();
  json["entry"]["distance_mm"]["sd"] = -1.0;
  EXPECT_THAT(complaint_about(json), HasSubstr("errors.json"));
  json = shipped_errors();
  json["correlation"] = 0.0;  // beside a tip
  EXPECT_THAT(complaint_about(json), HasSubstr("\"correlation\""));
  json = shipped_errors();
  json.erase("sources");
  EXPECT_THAT(complaint_about(json), HasSubstr("\"sources\""));
  json = shipped_errors();
  json["version"] = 1;
  EXPECT_THAT(complaint_about(json), HasSubstr("version 1"));
  json = shipped_errors();
  json["format"] = "spinaltap-screws";
  EXPECT_THAT(complaint_about(json), HasSubstr("spinaltap-screws"));
  json = shipped_errors();
  json["tip"]["distance_mm"]["mean"] = 30.0;
  EXPECT_THAT(complaint_about(json), HasSubstr("expected a tip that errs"));
}

}  // namespace
}  // namespace spinaltap
