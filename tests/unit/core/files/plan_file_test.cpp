#include "core/files/plan_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/files/json_file.h"
#include "tests/support/full_disk.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

/// Two paths whose numbers need all digits of a double.
std::vector<DrillPath> two_paths() {
  return {{"left", Vec3(1.0 / 3.0, -2e-7, 812.3), Vec3(10.0, -30.1, 800.0), {3.0, 50.0, 5.0}},
          {"right \"R\" °", Vec3(-1.5, 0.1, 812.0), Vec3(-10.0, -30.0, 800.0), {2.5, 40.0, 0.1}}};
}

class PlanFile : public testing::Test {
 protected:
  std::filesystem::path path() const { return folder_.path() / "plan.json"; }
  std::filesystem::path folder() const { return folder_.path(); }

  /// Writes a good plan, changed by `change`, and reads it.
  template <class Change>
  std::vector<DrillPath> read_changed(const Change& change) {
    write_plan(two_paths(), path());
    Json json = read_json(path());
    change(json);
    std::ofstream(path()) << json.dump();
    return read_plan(path());
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(PlanFile, GivesBackEveryPathToTheLastBit) {
  write_plan(two_paths(), path());
  const std::vector<DrillPath> back = read_plan(path());
  ASSERT_EQ(back.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const DrillPath expected = two_paths()[i];
    EXPECT_EQ(back[i].name, expected.name);
    EXPECT_EQ(back[i].entry_mm, expected.entry_mm);
    EXPECT_EQ(back[i].target_mm, expected.target_mm);
    EXPECT_EQ(back[i].bit.diameter_mm, expected.bit.diameter_mm);
    EXPECT_EQ(back[i].bit.length_mm, expected.bit.length_mm);
    EXPECT_EQ(back[i].bit.tip_length_mm, expected.bit.tip_length_mm);
  }
}

TEST_F(PlanFile, KeepsEveryShapeOfBit) {
  for (const BitShape shape :
       {BitShape::drill, BitShape::round_burr, BitShape::conical_burr, BitShape::tapered_screw}) {
    std::vector<DrillPath> paths = two_paths();
    paths[1].bit = {4.0, 40.0, 6.0, shape, 1.5, 0.7};
    write_plan(paths, path());
    const DrillBit bit = read_plan(path())[1].bit;
    EXPECT_EQ(bit.shape, shape);
    EXPECT_EQ(bit.tip_diameter_mm, 1.5);
    EXPECT_EQ(bit.shank_diameter_mm, 0.7);
  }
  EXPECT_THAT([&] { read_changed([](Json& json) { json["paths"][0]["bit"]["shape"] = "spoon"; }); },
              ThrowsMessage<Error>(AllOf(HasSubstr("plan.json"), HasSubstr("spoon"), HasSubstr("round-burr"))));
}

TEST_F(PlanFile, KeepsHelixAndWearOfADrillAndNamesThemOnlyWhereTheyAreUnusual) {
  std::vector<DrillPath> paths = two_paths();
  paths[1].bit = twist_drill(3.2, 60.0, 118.0, 0.5);
  write_plan(paths, path());
  EXPECT_FALSE(read_json(path())["paths"][1]["bit"].contains("helix_deg"));
  EXPECT_EQ(read_plan(path())[1].bit, paths[1].bit);
  paths[1].bit.helix_deg = 12.0;
  paths[1].bit.wear_mm = 0.03;
  write_plan(paths, path());
  EXPECT_EQ(read_plan(path())[1].bit, paths[1].bit);
  EXPECT_THROW(read_changed([](Json& json) { json["paths"][1]["bit"]["wear_mm"] = -0.1; }), Error);
  EXPECT_THROW(read_changed([](Json& json) { json["paths"][1]["bit"]["helix_deg"] = 80.0; }), Error);
}

TEST_F(PlanFile, KeepsAProfileBitForBit) {
  std::vector<DrillPath> paths = two_paths();
  paths[1].bit = profile_bit({{0.0, 0.0}, {1.0 / 3.0, 0.3, true}, {2.0, 1.1}, {2.0, 0.7}, {50.1, 0.7}});
  write_plan(paths, path());
  EXPECT_EQ(read_plan(path())[1].bit, paths[1].bit);
  const auto rejected = [&](const std::function<void(Json & bit)>& change, const char* what) {
    EXPECT_THAT(
        [&] {
          read_changed([&](Json& json) {
            json["paths"][1]["bit"] =
                Json{{"shape", "profile"},
                     {"outline", {{{"back_mm", 0.0}, {"radius_mm", 1.0}}, {{"back_mm", 9.0}, {"radius_mm", 1.0}}}}};
            change(json["paths"][1]["bit"]);
          });
        },
        ThrowsMessage<Error>(AllOf(HasSubstr("plan.json"), HasSubstr(what))))
        << what;
  };
  rejected([](Json& bit) { bit.erase("outline"); }, "outline");
  rejected([](Json& bit) { bit["outline"] = 3; }, "outline");
  rejected([](Json& bit) { bit["diameter_mm"] = 2.0; }, "diameter_mm");
  rejected([](Json& bit) { bit["outline"][1].erase("radius_mm"); }, "radius_mm");
  rejected([](Json& bit) { bit["outline"][1]["radius_mm"] = "wide"; }, "place 2 of \"outline\"");
  rejected([](Json& bit) { bit["outline"][1]["arc"] = 1; }, "\"arc\"");
  rejected([](Json& bit) { bit["outline"][1]["ball"] = true; }, "ball");
  rejected([](Json& bit) { bit["outline"][1]["back_mm"] = -9.0; }, "place 2 of the outline");
  EXPECT_THAT([&] { read_changed([](Json& json) { json["paths"][1]["bit"]["outline"] = Json::array(); }); },
              ThrowsMessage<Error>(AllOf(HasSubstr("plan.json"), HasSubstr("profile only"))));
}

TEST_F(PlanFile, KeepsAPlateBitForBit) {
  for (const double stroke_mm : {0.0, 10.0 / 3.0}) {
    std::vector<DrillPath> paths = two_paths();
    paths[1].bit = plate_bit(12.0 + 1e-9, 0.7, 40.1, stroke_mm);
    paths[1].bit.width_along = Vec3(1.0, -2.0, 2.0) / 3.0;
    write_plan(paths, path());
    EXPECT_EQ(read_plan(path())[1].bit, paths[1].bit);
    EXPECT_EQ(read_plan(path())[0].bit, paths[0].bit);
    const Json bit = read_json(path())["paths"][1]["bit"];
    EXPECT_EQ(bit.contains("stroke_mm"), stroke_mm > 0.0);
    EXPECT_FALSE(bit.contains("diameter_mm"));
    write_plan(paths, folder() / "lines.mrk.json");
    EXPECT_EQ(read_plan(folder() / "lines.mrk.json")[1].bit, paths[1].bit);
  }
  const auto change_plate = [&](const std::function<void(Json & bit)>& change) {
    return read_changed([&](Json& json) {
      json["paths"][1]["bit"] = Json{{"shape", "plate"}, {"width_mm", 9.0}, {"thickness_mm", 1.0}, {"length_mm", 30.0}};
      change(json["paths"][1]["bit"]);
    });
  };
  EXPECT_EQ(change_plate([](Json&) {})[1].bit, plate_bit(9.0, 1.0, 30.0)) << "upright where nothing is said";
  const auto rejected = [&](const std::function<void(Json & bit)>& change, const char* what) {
    EXPECT_THAT([&] { change_plate(change); }, ThrowsMessage<Error>(AllOf(HasSubstr("plan.json"), HasSubstr(what))))
        << what;
  };
  rejected([](Json& bit) { bit.erase("thickness_mm"); }, "thickness_mm");
  rejected([](Json& bit) { bit.erase("width_mm"); }, "width_mm");
  rejected([](Json& bit) { bit.erase("length_mm"); }, "length_mm");
  rejected([](Json& bit) { bit["diameter_mm"] = 3.0; }, "diameter_mm");
  rejected([](Json& bit) { bit["tip_length_mm"] = 3.0; }, "tip_length_mm");
  rejected([](Json& bit) { bit["thickness_mm"] = "thin"; }, "thickness_mm");
  rejected([](Json& bit) { bit["thickness_mm"] = 9.5; }, "thickness from 0.05 to 9 mm");
  rejected([](Json& bit) { bit["stroke_mm"] = 9.0; }, "stroke");
  rejected([](Json& bit) { bit["width_along"] = 3; }, "width_along");
  rejected([](Json& bit) { bit["width_along"] = {0.0, 0.0, 2.0}; }, "direction of length 1");
  EXPECT_THAT([&] { read_changed([](Json& json) { json["paths"][1]["bit"]["thickness_mm"] = 1.0; }); },
              ThrowsMessage<Error>(AllOf(HasSubstr("plan.json"), HasSubstr("thickness_mm"))))
      << "of a drill";
}

TEST_F(PlanFile, NamesTheBoneThatItIsForInAVersionOfItsOwn) {
  std::vector<DrillPath> paths = two_paths();
  paths[1].bone = {"0123456789abcdef", Level{22}};
  write_plan(paths, path());
  EXPECT_THAT(read_whole_file(path()), HasSubstr("\"version\": 4"));
  EXPECT_TRUE(read_plan(path())[0].bone.is_empty());
  EXPECT_EQ(read_plan(path())[1].bone, paths[1].bone);
  write_plan(paths, folder() / "lines.mrk.json");
  EXPECT_EQ(read_plan(folder() / "lines.mrk.json")[1].bone, paths[1].bone);
  paths[1].bone = {"", Level{22}};  // typed by hand: a level is better than nothing
  write_plan(paths, path());
  EXPECT_EQ(read_plan(path())[1].bone.level, Level{22});
  EXPECT_FALSE(read_plan(path())[1].bone.names_ct());
  const auto rejects = [&](const Json& bone, const char* word) {
    Json json = read_json(path());
    json["paths"][1]["bone"] = bone;
    std::ofstream(path()) << json.dump();
    EXPECT_THAT([&] { read_plan(path()); }, ThrowsMessage<Error>(HasSubstr(word))) << bone.dump();
  };
  rejects({{"ct", "../../x"}}, "hash");
  rejects({{"level", "L33"}}, "L33");
  rejects({{"patient", "Doe"}}, "patient");
}

TEST_F(PlanFile, KeepsPlacesOfACurvedPathToTheLastBit) {
  std::vector<DrillPath> paths = two_paths();
  paths[1].via_mm = {{-4.0 / 3.0, -9.7, 810.5}, {-6.1, -20.0, 806.0 + 1e-9}};
  paths[1].bit = steerable_head();
  write_plan(paths, path());
  // A program that knows version 2 only does not drill the chord.
  EXPECT_EQ(read_json(path())["version"], 3);
  EXPECT_FALSE(read_json(path())["paths"][0].contains("via_mm"));
  const std::vector<DrillPath> back = read_plan(path());
  EXPECT_FALSE(back[0].is_curved());
  EXPECT_EQ(back[1].via_mm, paths[1].via_mm);
  EXPECT_EQ(paths_of_text(plan_text(paths), "")[1].via_mm, paths[1].via_mm);

  const auto rejected = [&](const Json& via, const char* what) {
    EXPECT_THAT([&] { read_changed([&](Json& json) { json["paths"][1]["via_mm"] = via; }); },
                ThrowsMessage<Error>(AllOf(HasSubstr("plan.json"), HasSubstr(what))))
        << what;
  };
  rejected(3, "via_mm");
  rejected({{1.0, 2.0}}, "via_mm");
  rejected({{1.0, 2.0, "z"}}, "via_mm");
  rejected(Json(std::vector<int>(40, 1)), "up to 32 places");
  rejected({{-1.5, 0.1, 812.0}}, "0.1 mm apart");
  rejected({{-3.0, -15.0, 806.0}}, "bit short enough");
  EXPECT_THAT([&] { read_changed([](Json& json) { json["version"] = 5; }); },
              ThrowsMessage<Error>(HasSubstr("version 5")));
  EXPECT_THAT([&] { read_changed([](Json& json) { json["version"] = 3, json["format"] = "other"; }); },
              ThrowsMessage<Error>(HasSubstr("other")));
}

TEST_F(PlanFile, SaysItsFrameAndUnit) {
  write_plan(two_paths(), path());
  const Json json = read_json(path());
  EXPECT_EQ(json.at("frame"), "LPS");
  EXPECT_EQ(json.at("unit"), "mm");
}

TEST_F(PlanFile, IsRejectedInAnotherFormatVersionFrameOrUnit) {
  const auto rejected = [&](const char* key, const Json& value) {
    EXPECT_THAT([&] { read_changed([&](Json& json) { json[key] = value; }); },
                ThrowsMessage<Error>(HasSubstr("plan.json")))
        << key;
    EXPECT_THAT([&] { read_changed([&](Json& json) { json.erase(key); }); },
                ThrowsMessage<Error>(AllOf(HasSubstr("plan.json"), HasSubstr(key))))
        << key;
  };
  rejected("format", "other");
  rejected("version", 1);
  rejected("frame", "RAS");
  rejected("unit", "cm");
}

TEST_F(PlanFile, IsRejectedWithoutPaths) {
  EXPECT_THAT([&] { read_changed([](Json& json) { json["paths"] = Json::array(); }); },
              ThrowsMessage<Error>(AllOf(HasSubstr("one path or more"), HasSubstr("plan.json"))));
  EXPECT_THAT([&] { read_changed([](Json& json) { json["paths"] = 3; }); },
              ThrowsMessage<Error>(HasSubstr("plan.json")));
  EXPECT_THAT([&] { read_changed([](Json& json) { json["paths"][1] = "left"; }); },
              ThrowsMessage<Error>(AllOf(HasSubstr("object"), HasSubstr("plan.json"))));
}

TEST_F(PlanFile, IsRejectedWithTheKeyAtFaultNamed) {
  const auto names = [](const char* key) {
    return ThrowsMessage<Error>(AllOf(HasSubstr("plan.json"), HasSubstr(key)));
  };
  for (const char* key : {"name", "entry_mm", "target_mm", "bit"}) {
    EXPECT_THAT([&] { read_changed([&](Json& json) { json["paths"][1].erase(key); }); }, names(key));
    EXPECT_THAT([&] { read_changed([&](Json& json) { json["paths"][1][key] = 7; }); }, names("plan.json"));
  }
  for (const char* key : {"diameter_mm", "length_mm", "tip_length_mm"}) {
    EXPECT_THAT([&] { read_changed([&](Json& json) { json["paths"][0]["bit"].erase(key); }); }, names(key));
    EXPECT_THAT([&] { read_changed([&](Json& json) { json["paths"][0]["bit"][key] = "3"; }); }, names(key));
  }
  EXPECT_THAT([&] { read_changed([&](Json& json) { json["paths"][0]["entry_mm"] = {1.0, 2.0}; }); }, names("entry_mm"));
  EXPECT_THAT([&] { read_changed([&](Json& json) { json["paths"][0]["entry_mm"][1] = nullptr; }); }, names("entry_mm"));
}

TEST_F(PlanFile, IsRejectedWithPathsThatCannotBeDrilledAndSaysWhich) {
  const auto names = [](const char* what) {
    return ThrowsMessage<Error>(AllOf(HasSubstr("plan.json"), HasSubstr("left"), HasSubstr(what)));
  };
  EXPECT_THAT([&] { read_changed([](Json& json) { json["paths"][0]["bit"]["diameter_mm"] = -3.0; }); },
              names("diameter"));
  EXPECT_THAT([&] { read_changed([](Json& json) { json["paths"][0]["target_mm"] = json["paths"][0]["entry_mm"]; }); },
              names("path"));
}

TEST_F(PlanFile, IsRejectedWhenItIsNoJson) {
  std::ofstream(path()) << "{\"format\": ";
  EXPECT_THAT([&] { read_plan(path()); }, ThrowsMessage<Error>(AllOf(HasSubstr("plan.json"), HasSubstr("JSON"))));
  std::ofstream(path(), std::ios::trunc) << "[1, 2]";
  EXPECT_THAT([&] { read_plan(path()); }, ThrowsMessage<Error>(AllOf(HasSubstr("plan.json"), HasSubstr("object"))));
  EXPECT_THAT([&] { read_plan(folder() / "none.json"); }, ThrowsMessage<Error>(HasSubstr("no such file")));
}

TEST_F(PlanFile, SaysWhereItIsNoJsonInWordsOfItsOwn) {
  std::ofstream(path()) << "{\n  \"format\": nonsense}";
  EXPECT_THAT(
      [&] { read_plan(path()); },
      ThrowsMessage<Error>(AllOf(HasSubstr("line 2, column 14: while parsing value"), HasSubstr("invalid literal"),
                                 Not(HasSubstr("exception")), Not(HasSubstr("[")))));
}

TEST_F(PlanFile, IsTheSameAsText) {
  write_plan(two_paths(), path());
  EXPECT_EQ(read_whole_file(path()), plan_text(two_paths()));
  EXPECT_EQ(plan_text(paths_of_text(plan_text(two_paths()), "text")), plan_text(two_paths()));
  EXPECT_THAT([] { paths_of_text("{}", "kept.json"); }, ThrowsMessage<Error>(HasSubstr("kept.json")));
}

TEST_F(PlanFile, LeavesTheOldOneOnAFullDisk) {
  write_plan({two_paths()[0]}, path());
  {
    const test::FullDisk full(16);
    EXPECT_THAT([&] { write_plan(two_paths(), path()); }, ThrowsMessage<Error>(HasSubstr("cannot write")));
  }
  EXPECT_EQ(read_plan(path()).size(), 1U);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder()), {}), 1);
}

TEST(ChoosePath, TakesTheNamedOneOrTheFirst) {
  const std::vector<DrillPath> paths = two_paths();
  EXPECT_EQ(&choose_path(paths, ""), &paths[0]);
  EXPECT_EQ(&choose_path(paths, "left"), &paths[0]);
  EXPECT_EQ(&choose_path(paths, paths[1].name), &paths[1]);
}

TEST(ChoosePath, ListsTheNamesThereAre) {
  EXPECT_THAT([] { choose_path(two_paths(), "middle"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("\"middle\""), HasSubstr("left, right"))));
}

}  // namespace
}  // namespace spinaltap
