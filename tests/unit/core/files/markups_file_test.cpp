#include "core/files/detail/markups_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/files/plan_file.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// As 3D Slicer 5 saves a line, in RAS, with the keys that it adds.
constexpr const char* kSavedInSlicer = R"({
    "@schema": "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/markups-schema-v1.0.3.json#",
    "markups": [
        {
            "type": "Line",
            "coordinateSystem": "RAS",
            "coordinateUnits": "mm",
            "locked": false,
            "fixedNumberOfControlPoints": false,
            "labelFormat": "%N-%d",
            "lastUsedControlPointNumber": 2,
            "controlPoints": [
                {"id": "1", "label": "L-1", "description": "", "associatedNodeID": "",
                 "position": [-19.5, -36.25, 2.5], "orientation": [-1.0, -0.0, -0.0, -0.0, -1.0, -0.0, 0.0, 0.0, 1.0],
                 "selected": true, "locked": false, "visibility": true, "positionStatus": "defined"},
                {"id": "2", "label": "L-2", "description": "", "associatedNodeID": "",
                 "position": [-10.5, 5.0, 2.0], "orientation": [-1.0, -0.0, -0.0, -0.0, -1.0, -0.0, 0.0, 0.0, 1.0],
                 "selected": true, "locked": false, "visibility": true, "positionStatus": "defined"}
            ],
            "measurements": [{"name": "length", "enabled": true, "value": 42.2, "units": "mm"}],
            "display": {"visibility": false, "opacity": 1.0}
        }
    ]
})";

DrillPath a_path() {
  return {"left \"L3\"", Vec3(1.0 / 3.0, -2e-7, 812.3), Vec3(10.0, -30.1, 800.0), {2.7, 60.0, 4.0}};
}

class MarkupsFile : public testing::Test {
 protected:
  std::filesystem::path path() const { return folder_.path() / "plan.mrk.json"; }

  template <class Change>
  std::vector<DrillPath> read_changed(const Change& change) {
    Json json = Json::parse(kSavedInSlicer);
    change(json["markups"][0]);
    std::ofstream(path()) << json.dump();
    return read_plan(path());
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(MarkupsFile, FromSlicerIsReadFromRas) {
  const std::vector<DrillPath> paths = read_changed([](Json&) {});
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(paths[0].name, "line 1");
  EXPECT_EQ(paths[0].entry_mm, Vec3(19.5, 36.25, 2.5));
  EXPECT_EQ(paths[0].target_mm, Vec3(10.5, -5.0, 2.0));
  EXPECT_EQ(paths[0].bit.diameter_mm, DrillBit().diameter_mm);
  EXPECT_FALSE(paths[0].screw.has_value());
}

TEST_F(MarkupsFile, FromSlicerIsReadFromLpsAndWhereNoFrameIsSaid) {
  for (const bool is_said : {true, false}) {
    const DrillPath path = read_changed([&](Json& line) {
      line["coordinateSystem"] = "LPS";
      if (!is_said) line.erase("coordinateSystem");
    })[0];
    EXPECT_EQ(path.entry_mm, Vec3(-19.5, -36.25, 2.5));
    EXPECT_EQ(path.target_mm, Vec3(-10.5, 5.0, 2.0));
  }
}

TEST_F(MarkupsFile, MayBeInMicrometresByWordOrByTerm) {
  for (const Json& units : {Json("um"), Json{"um", "UCUM", "micrometer"}}) {
    const DrillPath path = read_changed([&](Json& line) {
      line["coordinateUnits"] = units;
      line["controlPoints"][0]["position"] = {-19500.0, -36250.0, 2500.0};
      line["controlPoints"][1]["position"] = {0.0, 0.0, 0.0};
    })[0];
    EXPECT_LT((path.entry_mm - Vec3(19.5, 36.25, 2.5)).norm(), 1e-12);
  }
}

TEST_F(MarkupsFile, TakesTheEndsByTheirLabelsWhereTheySay) {
  const DrillPath path = read_changed([](Json& line) {
    line["controlPoints"][0]["label"] = "Target";
    line["controlPoints"][1]["label"] = "Entry";
  })[0];
  EXPECT_EQ(path.target_mm, Vec3(19.5, 36.25, 2.5));
}

TEST_F(MarkupsFile, GivesBackPathsBitsAndScrewsToTheLastBit) {
  DrillPath with_screw = a_path();
  with_screw.name = "right";
  with_screw.screw = {"6.5 x 45", 6.5, 45.0, 4.0};
  write_plan({a_path(), with_screw}, path());
  const std::vector<DrillPath> back = read_plan(path());
  ASSERT_EQ(back.size(), 2U);
  EXPECT_EQ(back[0].name, a_path().name);
  EXPECT_EQ(back[0].entry_mm, a_path().entry_mm);
  EXPECT_EQ(back[0].target_mm, a_path().target_mm);
  EXPECT_EQ(back[0].bit.diameter_mm, 2.7);
  EXPECT_FALSE(back[0].screw.has_value());
  ASSERT_TRUE(back[1].screw.has_value());
  EXPECT_EQ(back[1].screw->name, "6.5 x 45");
  EXPECT_EQ(back[1].screw->diameter_mm, 6.5);
  EXPECT_EQ(back[1].screw->length_mm, 45.0);
  EXPECT_EQ(back[1].screw->tip_length_mm, 4.0);
}

TEST_F(MarkupsFile, HoldsACurvedPathAsAnOpenCurve) {
  DrillPath curved = a_path();
  curved.bit = {2.0, 2.5, 1.0, BitShape::round_burr, 0.0, 0.0};
  const Vec3 aside = any_perpendicular(curved.direction());
  const Vec3 way_mm = curved.target_mm - curved.entry_mm;
  curved.via_mm = {curved.entry_mm + 0.3 * way_mm + aside, curved.entry_mm + 0.6 * way_mm + 1.5 * aside};
  write_plan({a_path(), curved}, path());
  const Json json = read_json(path());
  EXPECT_EQ(json.at("markups").at(0).at("type"), "Line");
  EXPECT_EQ(json.at("markups").at(1).at("type"), "Curve");
  EXPECT_EQ(json.at("markups").at(1).at("controlPoints").size(), 4U);
  EXPECT_EQ(json.at("markups").at(1).at("lastUsedControlPointNumber"), 4);
  const std::vector<DrillPath> back = read_plan(path());
  ASSERT_EQ(back.size(), 2U);
  EXPECT_EQ(back[1].via_mm, curved.via_mm);
  EXPECT_EQ(back[1].bit, curved.bit);

  // As Slicer saves it: without our bit, here from the target to the entry.
  Json saved = json;
  Json& curve = saved["markups"][1];
  curve.erase("spinaltap");
  std::reverse(curve["controlPoints"].begin(), curve["controlPoints"].end());
  std::ofstream(path()) << saved.dump();
  EXPECT_EQ(read_plan(path())[1].entry_mm, curved.entry_mm);
  EXPECT_EQ(read_plan(path())[1].via_mm, curved.via_mm);
  EXPECT_EQ(read_plan(path())[1].bit, steerable_head());
}

TEST_F(MarkupsFile, SaysItsFrameUnitAndKindAsSlicerAsksFor) {
  write_plan({a_path()}, path());
  const Json json = read_json(path());
  EXPECT_THAT(json.at("@schema").get<std::string>(), HasSubstr("markups-schema-v1.0.3.json"));
  const Json& line = json.at("markups").at(0);
  EXPECT_EQ(line.at("type"), "Line");
  EXPECT_EQ(line.at("coordinateSystem"), "LPS");
  EXPECT_EQ(line.at("coordinateUnits"), "mm");
  EXPECT_EQ(line.at("controlPoints").size(), 2U);
  EXPECT_EQ(line.at("controlPoints").at(0).at("orientation").size(), 9U);
}

TEST_F(MarkupsFile, LeavesOutOtherMarkupsAndIsRejectedWithoutALine) {
  Json json = Json::parse(kSavedInSlicer);
  const Json points{{"type", "Fiducial"}, {"controlPoints", Json::array()}};
  json["markups"].insert(json["markups"].begin(), points);
  std::ofstream(path()) << json.dump();
  EXPECT_EQ(read_plan(path()).size(), 1U);
  EXPECT_THAT([&] { read_changed([](Json& line) { line["type"] = "ClosedCurve"; }); },
              ThrowsMessage<Error>(AllOf(HasSubstr("line"), HasSubstr("plan.mrk.json"))));
}

TEST_F(MarkupsFile, IsRejectedWithTheFaultNamed) {
  const auto names = [](const char* what) {
    return ThrowsMessage<Error>(AllOf(HasSubstr("plan.mrk.json"), HasSubstr(what)));
  };
  EXPECT_THAT([&] { read_changed([](Json& line) { line["coordinateSystem"] = "XYZ"; }); }, names("XYZ"));
  EXPECT_THAT([&] { read_changed([](Json& line) { line["coordinateUnits"] = "cm"; }); }, names("cm"));
  EXPECT_THAT([&] { read_changed([](Json& line) { line["controlPoints"].erase(1); }); }, names("two points"));
  EXPECT_THAT([&] { read_changed([](Json& line) { line["controlPoints"][1]["positionStatus"] = "undefined"; }); },
              names("placed"));
  EXPECT_THAT([&] { read_changed([](Json& line) {
                      line["controlPoints"][1]["position"] = {1.0, 2.0};
                    }); },
              names("position"));
  EXPECT_THAT([&] { read_changed([](Json& line) { line["controlPoints"] = 3; }); }, names("two points"));
}

}  // namespace
}  // namespace spinaltap
