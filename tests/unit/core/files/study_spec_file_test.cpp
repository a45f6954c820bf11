#include "core/files/study_spec_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/base/error.h"
#include "core/files/data_files.h"
#include "core/files/detail/study_json.h"
#include "core/files/json_file.h"
#include "core/files/plan_file.h"
#include "core/files/registration_file.h"
#include "core/registration/register_fiducials.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Every key that a specification may have.
Json whole_spec() {
  return Json::parse(R"({
    "format": "spinaltap-study", "version": 2, "name": "All keys",
    "bone": "bones/bone.vdb", "level": "L3", "plan": "plan.json", "path": "right",
    "volume": {"radius_mm": 5, "spacing_mm": 0.2, "lead_in_mm": 2, "lead_out_mm": 4},
    "spindle_rpm": 1000,
    "stop": {"thrust_n": 40, "clearance_mm": 1, "on_breach": true},
    "operator": {"kind": "push", "push_n": 25, "rate_hz": 500, "reaction_s": 0.3, "noticed_share": 0.1,
             "tremor_mm": 0.05},
    "design": {
      "runs": 20, "sampling": "latin-hypercube", "seed": 9,
      "factors": {
        "entry_left_mm": {"normal": {"mean": 0.5, "deviation": 1}},
        "angle_head_deg": {"uniform": {"low": -4, "high": 3}},
        "bit_diameter_mm": {"levels": [2.5, 3.5]}
      }
    }
  })");
}

class StudySpecFile : public ::testing::Test {
 protected:
  StudySpecFile() {
    DrillPath path{"left", Vec3(1, 2, 3), Vec3(1, 2, 43), {3.0, 50.0, 2.0}};
    std::vector<DrillPath> paths{path, path};
    paths[1].name = "right";
    paths[1].entry_mm.x() = -1.0;
    write_plan(paths, folder_.path() / "plan.json");
  }

  std::filesystem::path write(const Json& json) const {
    std::ofstream(file_, std::ios::trunc) << json.dump();
    return file_;
  }
  void rejects(const std::function<void(Json&)>& change, const std::string& word) const {
    Json json = whole_spec();
    change(json);
    write(json);
    EXPECT_THAT([&] { read_study_spec(file_); }, ThrowsMessage<Error>(AllOf(HasSubstr("study.json"), HasSubstr(word))))
        << json.dump();
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "study.json";
};

TEST_F(StudySpecFile, IsReadWithEveryKey) {
  const StudySpec spec = read_study_spec(write(whole_spec()));
  EXPECT_EQ(spec.name, "All keys");
  EXPECT_EQ(level_name(spec.bones.at(0).level), "L3");
  EXPECT_EQ(spec.bones.at(0).file, folder_.path() / "bones/bone.vdb");
  EXPECT_EQ(spec.bones.at(0).paths.at(0).name, "right");
  EXPECT_EQ(spec.bones.at(0).paths.at(0).entry_mm.x(), -1.0);
  EXPECT_EQ(spec.volume.radius_mm, 5.0);
  EXPECT_EQ(spec.volume.spacing_mm, 0.2);
  EXPECT_EQ(spec.volume.lead_in_mm, 2.0);
  EXPECT_EQ(spec.lead_out_mm, 4.0);
  EXPECT_EQ(spec.options.spindle.rpm, 1000.0);
  EXPECT_EQ(spec.options.stop.thrust_n, 40.0);
  EXPECT_EQ(spec.options.stop.clearance_mm, 1.0);
  EXPECT_TRUE(spec.options.stop.on_breach);
  EXPECT_EQ(spec.tool_operator.kind, StudyOperator::Kind::push);
  EXPECT_EQ(spec.tool_operator.push_n, 25.0);
  EXPECT_EQ(spec.tool_operator.rate_hz, 500.0);
  EXPECT_EQ(spec.tool_operator.reaction_s, 0.3);
  EXPECT_EQ(spec.tool_operator.noticed_share, 0.1);
  EXPECT_EQ(spec.tool_operator.tremor_mm, 0.05);
  EXPECT_EQ(spec.design.runs, 20U);
  EXPECT_EQ(spec.design.sampling, StudySampling::latin_hypercube);
  EXPECT_EQ(spec.design.seed, 9U);
  ASSERT_EQ(spec.design.distributions.size(), 3U);
  EXPECT_EQ(spec.design.distributions[0].kind, FactorDistribution::Kind::normal);
  EXPECT_EQ(spec.design.distributions[0].a, 0.5);
  EXPECT_EQ(spec.design.distributions[0].b, 1.0);
  EXPECT_EQ(spec.design.distributions[1].kind, FactorDistribution::Kind::uniform);
  EXPECT_EQ(spec.design.distributions[1].a, -4.0);
  EXPECT_EQ(spec.design.distributions[1].b, 3.0);
  EXPECT_EQ(spec.design.distributions[2].levels, (std::vector<double>{2.5, 3.5}));
  EXPECT_EQ(StudyRuns(spec.design).count(), 40U);
}

TEST_F(StudySpecFile, NeedsNoMoreThanBonePathOperatorAndDesign) {
  const StudySpec spec = read_study_spec(write(Json::parse(
      R"({"format": "spinaltap-study", "version": 2, "bone": "b.vdb", "operator": {"kind": "feed"}, "design": {},
          "path": {"name": "own", "entry_mm": [0, 0, 0], "target_mm": [0, 0, 30],
                   "bit": {"diameter_mm": 3, "length_mm": 50, "tip_length_mm": 2}}})")));
  EXPECT_EQ(spec.name, "study");
  EXPECT_EQ(spec.bones.at(0).paths.at(0).name, "own");
  EXPECT_EQ(spec.tool_operator.step_mm, 0.01);
  EXPECT_EQ(spec.volume.radius_mm, 0.0);
  EXPECT_EQ(spec.volume.spacing_mm, 0.1);
  EXPECT_TRUE(std::isinf(spec.options.stop.thrust_n));
  EXPECT_EQ(StudyRuns(spec.design).count(), 1U);
  const FactorValues base = base_values(spec, spec.bones.at(0).paths.at(0));
  EXPECT_EQ(base[static_cast<std::size_t>(StudyFactor::bit_diameter_mm)], 3.0);
  EXPECT_EQ(base[static_cast<std::size_t>(StudyFactor::density_scale)], 1.0);
  EXPECT_TRUE(std::isnan(base[static_cast<std::size_t>(StudyFactor::push_n)]));
}

TEST_F(StudySpecFile, TakesASpreadOfForcesFromTheMaterialOrInNumbers) {
  Json json = whole_spec();
  json["design"]["factors"]["force_scale"] = {{"spread", "material"}};
  const StudySpec spec = read_study_spec(write(json));
  const FactorDistribution& drawn = spec.design.distributions.back();
  EXPECT_EQ(drawn.factor, StudyFactor::force_scale);
  EXPECT_EQ(drawn.kind, FactorDistribution::Kind::spread);
  EXPECT_EQ(drawn.a, spec.material.thrust_spread.median);
  EXPECT_EQ(drawn.b, spec.material.thrust_spread.log_scale);
  EXPECT_EQ(drawn.degrees, static_cast<int>(spec.material.thrust_spread.degrees));
  // A folder keeps the numbers, whatever becomes of the material.
  EXPECT_EQ(to_json(spec.design), to_json(read_study_design(to_json(spec.design), file_)));
  json["design"]["factors"]["force_scale"] = {
      {"spread", {{"median", 0.5}, {"log_scale", 0.7}, {"degrees_of_freedom", 3}}}};
  EXPECT_EQ(read_study_spec(write(json)).design.distributions.back().degrees, 3);
  json["design"]["factors"]["force_scale"] = {{"spread", "wide"}};
  EXPECT_THROW(read_study_spec(write(json)), Error);
}

TEST_F(StudySpecFile, TakesTheErrorOfARegistrationBesideIt) {
  const std::vector<Vec3> marks_mm{{0, 0, 0}, {60, 5, 0}, {10, 50, 8}, {-30, 20, 40}};
  const Registration found = register_fiducials(marks_mm, marks_mm, {.fle_mm = 0.5});
  write_registration(found, folder_.path() / "registration.json");
  Json json = whole_spec();
  json["registration"] = {{"file", "registration.json"}, {"per", "run"}};
  const StudySpec spec = read_study_spec(write(json));
  ASSERT_TRUE(spec.registration);
  EXPECT_EQ(spec.registration->per, DrawnPer::run);
  const Vec3 place_mm(20.0, -30.0, 90.0);
  EXPECT_NEAR(target_error_mm(spec.registration->covariance, place_mm), target_error_mm(found.covariance, place_mm),
              1e-9);
  json["registration"]["per"] = "patient";
  EXPECT_EQ(read_study_spec(write(json)).registration->per, DrawnPer::patient);
  rejects([](Json& j) { j["registration"] = {{"file", "registration.json"}, {"per", "day"}}; }, "day");
  rejects([](Json& j) { j["registration"] = {{"per", "run"}}; }, "file");
  rejects([](Json& j) { j["registration"] = 3; }, "object");
  json["registration"]["file"] = "nowhere.json";
  EXPECT_THAT([&] { read_study_spec(write(json)); }, ThrowsMessage<Error>(HasSubstr("nowhere.json")));
}

TEST_F(StudySpecFile, ShippedOneIsRead) {
  const StudySpec spec = read_study_spec(write(read_json(data_file("studies/pedicle.json"))));
  EXPECT_EQ(StudyRuns(spec.design).count(), 1000U);
  EXPECT_EQ(spec.tool_operator.step_mm, 0.01);
}

TEST_F(StudySpecFile, GivesOperatorAndDesignBackAsTheyWere) {
  const StudySpec spec = read_study_spec(write(whole_spec()));
  EXPECT_EQ(to_json(spec.tool_operator), to_json(read_study_operator(to_json(spec.tool_operator), file_)));
  EXPECT_EQ(to_json(spec.design), to_json(read_study_design(to_json(spec.design), file_)));
  EXPECT_EQ(read_study_operator(to_json(spec.tool_operator), file_).push_n, 25.0);
  EXPECT_EQ(read_study_design(to_json(spec.design), file_).distributions.size(), 3U);
}

TEST_F(StudySpecFile, IsRejectedWithTheKeyAtFaultNamed) {
  rejects([](Json& j) { j["format"] = "plan"; }, "spinaltap-study");
  rejects([](Json& j) { j["version"] = 1; }, "this is a version 1 study; version 2 is expected");
  rejects([](Json& j) { j["spindel_rpm"] = 2; }, "spindel_rpm");
  rejects([](Json& j) { j["level"] = "L9"; }, "a vertebra such as");
  for (const char* key : {"format", "version", "bone", "plan", "operator", "design"}) {
    rejects([key](Json& j) { j.erase(key); }, key);
  }
  rejects([](Json& j) { j["name"] = 3; }, "name");
  rejects([](Json& j) { j["bone"] = 3; }, "bone");
  rejects([](Json& j) { j["path"] = Json::object({{"name", "x"}}); }, "\"plan\"");
  rejects([](Json& j) { j["spindle_rpm"] = 0; }, "spindle_rpm");
  rejects([](Json& j) { j["spindle_rpm"] = "fast"; }, "spindle_rpm");

  rejects([](Json& j) { j["volume"]["radius"] = 3; }, "\"radius\"");
  for (const char* key : {"radius_mm", "spacing_mm", "lead_in_mm", "lead_out_mm"}) {
    rejects([key](Json& j) { j["volume"][key] = -1; }, key);
    rejects([key](Json& j) { j["volume"][key] = "wide"; }, key);
  }
  rejects([](Json& j) { j["volume"] = 3; }, "object");

  rejects([](Json& j) { j["stop"]["thrust_n"] = 0; }, "thrust_n");
  rejects([](Json& j) { j["stop"]["clearance_mm"] = "none"; }, "clearance_mm");
  rejects([](Json& j) { j["stop"]["on_breach"] = 1; }, "on_breach");
  rejects([](Json& j) { j["stop"]["on_breech"] = true; }, "on_breech");

  rejects([](Json& j) { j["operator"].erase("kind"); }, "kind");
  rejects([](Json& j) { j["operator"]["kind"] = "robot"; }, "robot");
  rejects([](Json& j) { j["operator"]["feed_mm_s"] = 1; }, "feed_mm_s");
  for (const char* key : {"push_n", "rate_hz", "reaction_s", "noticed_share", "tremor_mm"}) {
    rejects([key](Json& j) { j["operator"][key] = -1; }, key);
  }
  rejects([](Json& j) { j["operator"] = {{"kind", "feed"}, {"push_n", 20}}; }, "push_n");
  rejects([](Json& j) { j["operator"] = {{"kind", "feed"}, {"feed_mm_s", 0}}; }, "feed_mm_s");
  rejects([](Json& j) { j["operator"] = {{"kind", "feed"}, {"step_mm", -0.01}}; }, "step_mm");

  rejects([](Json& j) { j["design"]["run"] = 3; }, "\"run\"");
  rejects([](Json& j) { j["design"]["runs"] = 2.5; }, "runs");
  rejects([](Json& j) { j["design"]["runs"] = -1; }, "runs");
  rejects([](Json& j) { j["design"]["seed"] = "x"; }, "seed");
  rejects([](Json& j) { j["design"]["sampling"] = "sobol"; }, "sobol");
  rejects([](Json& j) { j["design"]["factors"] = 3; }, "factors");
  rejects([](Json& j) { j["design"]["factors"]["entry"] = {{"levels", {1}}}; }, "\"entry\"");
  rejects([](Json& j) { j["design"]["factors"]["bit_diameter_mm"] = 3; }, "bit_diameter_mm");
  rejects([](Json& j) { j["design"]["factors"]["bit_diameter_mm"] = {{"level", {3}}}; }, "\"level\"");
  rejects([](Json& j) { j["design"]["factors"]["bit_diameter_mm"] = {{"levels", {3, "x"}}}; }, "bit_diameter_mm");
  rejects([](Json& j) { j["design"]["factors"]["bit_diameter_mm"] = {{"levels", 3}}; }, "bit_diameter_mm");
  rejects([](Json& j) { j["design"]["factors"]["entry_left_mm"]["normal"].erase("mean"); }, "mean");
  rejects([](Json& j) { j["design"]["factors"]["entry_left_mm"]["normal"]["sigma"] = 3; }, "sigma");
  rejects([](Json& j) { j["design"]["factors"]["angle_head_deg"]["uniform"].erase("high"); }, "high");
  rejects([](Json& j) { j["design"]["factors"]["angle_head_deg"]["uniform"]["mean"] = 1; }, "mean");
  rejects([](Json& j) { j["design"]["factors"]["feed_mm_s"] = {{"levels", {1}}}; }, "feed_mm_s");
}

TEST_F(StudySpecFile, NamesFilesThatAreMissing) {
  Json json = whole_spec();
  json["plan"] = "nowhere.json";
  EXPECT_THAT([&] { read_study_spec(write(json)); }, ThrowsMessage<Error>(HasSubstr("nowhere.json")));
  json = whole_spec();
  json["material"] = "soft.json";
  EXPECT_THAT([&] { read_study_spec(write(json)); }, ThrowsMessage<Error>(HasSubstr("soft.json")));
  json = whole_spec();
  json["density"] = "light.json";
  EXPECT_THAT([&] { read_study_spec(write(json)); }, ThrowsMessage<Error>(HasSubstr("light.json")));
  json = whole_spec();
  json["path"] = "middle";
  EXPECT_THAT([&] { read_study_spec(write(json)); }, ThrowsMessage<Error>(HasSubstr("left, right")));
}

Json cohort_spec() {
  return Json::parse(R"({
    "format": "spinaltap-study", "version": 2, "name": "Cohort", "kind": "geometry",
    "bones": [{"bone": "a.vdb", "level": "L4", "plan": "plan.json"},
              {"bone": "b.vdb", "patient": 7, "plan": "plan.json", "paths": ["right"]}],
    "errors": "robot_726",
    "design": {"runs": 10, "sampling": "saltelli"}
  })");
}

TEST_F(StudySpecFile, HoldsBonesOfPatientsAndWhatIsPlannedInThem) {
  const StudySpec spec = read_study_spec(write(cohort_spec()));
  EXPECT_EQ(spec.kind, StudyKind::geometry);
  ASSERT_EQ(spec.bones.size(), 2U);
  EXPECT_EQ(spec.bones[0].file, folder_.path() / "a.vdb");
  EXPECT_EQ(level_name(spec.bones[0].level), "L4");
  EXPECT_EQ(spec.bones[0].patient, 0U);
  EXPECT_EQ(spec.bones[0].paths.size(), 2U);
  EXPECT_EQ(spec.bones[1].patient, 6U);
  ASSERT_EQ(spec.bones[1].paths.size(), 1U);
  EXPECT_EQ(spec.bones[1].paths[0].name, "right");
  EXPECT_EQ(ground_of(spec).patients, (std::vector<std::size_t>{0, 0, 6}));
  EXPECT_EQ(spec.design.sampling, StudySampling::saltelli);
  ASSERT_TRUE(spec.errors.has_value());
  EXPECT_EQ(spec.errors->name, "robot_726");

  Json json = cohort_spec();
  json["bones"] = {"a.vdb", "b.vdb"};
  json["plans"] = "auto";
  EXPECT_TRUE(read_study_spec(write(json)).bones[1].paths.empty());
}

TEST_F(StudySpecFile, TakesErrorsAsALawOrAsTheyWereMeasured) {
  Json json = cohort_spec();
  json["errors"] = Json::parse(R"({"name": "tips", "sources": ["made up"], "screw_length_mm": 40, "joint": {
    "mean": [1, 0, 0, 1, 0], "ends_at": "tip_mm", "most_deviations": 3, "outliers": {"share": 0.02, "times": 3},
    "covariance": [[1, 0, 0, 1, 0], [0, 1, 0, 0, 0], [0, 0, 1, 0, 0], [1, 0, 0, 1, 0], [0, 0, 0, 0, 4]]}})");
  const StudySpec by_tips = read_study_spec(write(json));
  ASSERT_TRUE(by_tips.errors->joint.has_value());
  const JointErrors& joint = *by_tips.errors->joint;
  // Medially entry and tip always err together: the direction does not. Cranially each errs for itself.
  const double per_mm_deg = 180.0 / std::numbers::pi / 40.0;
  EXPECT_NEAR(joint.mean[3], 0.0, 1e-12);
  EXPECT_NEAR(joint.covariance[3][3], 0.0, 1e-12);
  EXPECT_NEAR(joint.covariance[4][4], (1.0 + 4.0) * per_mm_deg * per_mm_deg, 1e-9);
  EXPECT_NEAR(joint.covariance[1][4], -per_mm_deg, 1e-9);
  EXPECT_EQ(joint.most_deviations, 3.0);
  EXPECT_EQ(joint.outlier_times, 3.0);

  std::ofstream(folder_.path() / "measured.csv") << "screw,entry_medial_mm,entry_cranial_mm,tip_medial_mm,"
                                                    "tip_cranial_mm,screw_length_mm\n1,1,0,1,0,40\n2,0,0,3,-4,50\n";
  json["errors"] = {{"name", "measured"}, {"sources", {"a table"}}, {"measured", {{"table", "measured.csv"}}}};
  const StudySpec measured = read_study_spec(write(json));
  ASSERT_EQ(measured.errors->measured.size(), 2U);
  EXPECT_EQ(measured.errors->measured[0].medial_mm, 1.0);
  EXPECT_EQ(measured.errors->measured[0].medial_deg, 0.0);
  const double turn_deg = std::asin(5.0 / 50.0) * 180.0 / std::numbers::pi;
  EXPECT_NEAR(measured.errors->measured[1].medial_deg, 0.6 * turn_deg, 1e-9);
  EXPECT_NEAR(measured.errors->measured[1].cranial_deg, -0.8 * turn_deg, 1e-9);
}

TEST_F(StudySpecFile, OfACohortIsRejectedWithTheKeyAtFaultNamed) {
  const auto rejects = [&](const auto& change, const char* words) {
    Json json = cohort_spec();
    change(json);
    EXPECT_THAT([&] { read_study_spec(write(json)); }, ThrowsMessage<Error>(HasSubstr(words))) << words;
  };
  rejects([](Json& j) { j["bones"] = Json::array(); }, "\"bones\"");
  rejects([](Json& j) { j["bones"] = {"a.vdb"}; }, "\"plans\": \"auto\"");
  rejects([](Json& j) { j["bone"] = "a.vdb"; }, "\"bone\"");
  rejects([](Json& j) { j["plans"] = "mine"; }, "\"plans\"");
  rejects([](Json& j) { j["bones"][1]["patient"] = 0; }, "\"patient\"");
  rejects([](Json& j) { j["bones"][1]["paths"] = {"middle"}; }, "middle");
  rejects([](Json& j) { j["bones"][0]["side"] = "left"; }, "side");
  rejects([](Json& j) { j["kind"] = "magic"; }, "\"drilling\" or \"geometry\"");
  rejects([](Json& j) { j["operator"] = {{"kind", "feed"}}; }, "drills nothing");
  rejects([](Json& j) { j["errors"] = "hope"; }, "robot_726");
  rejects([](Json& j) { j["errors"] = {{"name", "x"}, {"sources", {"y"}}, {"measured", Json::array()}}; }, "measured");
  rejects(
      [](Json& j) {
        j["errors"] = {{"name", "x"}, {"sources", {"y"}}, {"measured", {{"table", "no.csv"}}}};
      },
      "no.csv");
  rejects([](Json& j) { j["design"]["factors"]["tremor_mm"] = {{"levels", {0.1}}}; }, "drills nothing");
  rejects([](Json& j) { j["design"]["factors"]["registration_scale"] = {{"levels", {1, 2}}}; }, "no such errors");
  rejects([](Json& j) { j["design"]["sampling"] = "best"; }, "\"saltelli\"");
}

}  // namespace
}  // namespace spinaltap
