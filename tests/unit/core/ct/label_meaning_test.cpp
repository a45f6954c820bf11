#include "core/ct/detail/label_meaning.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "core/ct/detail/label_conventions.h"
#include "tests/support/error_of.h"

namespace spinaltap::detail {
namespace {

using test::error_of;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// What a vertebra of a region looks like: width, depth, height, volume and distance to the next.
struct Kind {
  Vec3 size_mm;
  double cm3;
  double pitch_mm;
};
const Kind kCervical{Vec3(52, 45, 25), 9.0, 16.0};
const Kind kMidThoracic{Vec3(60, 65, 40), 18.0, 22.0};
const Kind kLumbar{Vec3(93, 90, 52), 58.0, 34.0};
const Kind kLumbarBody{Vec3(50, 36, 30), 30.0, 34.0};

/// Labels one below the other, from the head down.
std::map<int, LabelShape> column(const std::vector<int>& numbers, const Kind& kind) {
  std::map<int, LabelShape> shapes;
  double z_mm = 0.0;
  for (const int number : numbers) {
    shapes[number] = {Vec3(0, 0, z_mm), kind.size_mm, 1000.0 * kind.cm3, false};
    z_mm -= kind.pitch_mm;
  }
  return shapes;
}

std::string levels(const std::vector<int>& numbers, const Kind& kind, const LabelReadOptions& options = {}) {
  const LabelMeaning meaning = meaning_of(column(numbers, kind), {}, options, "map.nii");
  std::string text;
  for (const int number : numbers) {
    const Level level = meaning.names.at(number).level;
    text += (text.empty() ? "" : " ") + (level == Level::kNone ? std::string("-") : level_name(level));
  }
  return text;
}

std::string question(const std::vector<int>& numbers, const Kind& kind, int wanted = 0) {
  LabelReadOptions options;
  options.wanted = wanted;
  return error_of([&] { levels(numbers, kind, options); });
}

TEST(LabelNumberings, HaveTheNumbersOfTheirSources) {
  const auto level = [](LabelConvention convention, int number) {
    return level_name(numbering_of(convention)->level_of(number));
  };
  using enum LabelConvention;
  EXPECT_EQ(level(verse, 1) + level(verse, 8) + level(verse, 20) + level(verse, 26) + level(verse, 28),
            "C1T1L1sacrumT13");
  EXPECT_EQ(level(ctspine1k, 25) + level(ctspine1k, 26), "L6");
  EXPECT_EQ(level(totalsegmentator, 25) + level(totalsegmentator, 26) + level(totalsegmentator, 27) +
                level(totalsegmentator, 50) + level(totalsegmentator, 51),
            "sacrumL5C1");
  EXPECT_EQ(level(totalsegmentator_v1, 18) + level(totalsegmentator_v1, 41), "L5C1");
  EXPECT_EQ(level(totalsegmentator_mr, 1) + level(totalsegmentator_mr, 2) + level(totalsegmentator_mr, 25),
            "sacrumL5C1");
  EXPECT_EQ(level(totalsegmentator_part, 2) + level(totalsegmentator_part, 3) + level(totalsegmentator_part, 26),
            "L5C1");
  EXPECT_EQ(level(totalsegmentator_body, 1), "");
  EXPECT_EQ(level(totalspineseg, 13) + level(totalspineseg, 21) + level(totalspineseg, 32) + level(totalspineseg, 41) +
                level(totalspineseg, 50),
            "C3T1T12L1sacrum");
  EXPECT_EQ(level(vertebralbodiesct, 12) + level(vertebralbodiesct, 13) + level(vertebralbodiesct, 18) +
                level(vertebralbodiesct, 19) + level(vertebralbodiesct, 21),
            "T12L1L6sacrumT13");
  EXPECT_EQ(level(spider, 1) + level(spider, 6) + level(spider, 24) + level(spider, 25), "L5T12C1");
  EXPECT_EQ(level(vista3d, 33) + level(vista3d, 56) + level(vista3d, 97) + level(vista3d, 131), "L5C1sacrumL6");
  EXPECT_EQ(level(lumbar, 3) + level(thoracic, 11), "L3T11");
  EXPECT_EQ(numbering_of(automatic), nullptr);
  EXPECT_FALSE(numbering_of(verse)->knows(60));
}

TEST(LabelMeaning, TakesNumbersThatOrderAndSizesLeaveOneMeaning) {
  EXPECT_EQ(levels({21, 22, 23}, kLumbar), "L2 L3 L4");             // T1 to T3 in TotalSpineSeg are smaller
  EXPECT_EQ(levels({30, 29, 28}, kLumbar), "L2 L3 L4");             // TotalSegmentator 2; T5 to T7 in version 1
  EXPECT_EQ(levels({36, 35, 34}, kLumbar), "L2 L3 L4");             // VISTA3D; T8 to T10 in TotalSegmentator 2
  EXPECT_EQ(levels({42, 43, 44}, kLumbar), "L2 L3 L4");             // TotalSpineSeg alone counts these down
  EXPECT_EQ(levels({14, 15, 16, 17}, kLumbarBody), "L2 L3 L4 L5");  // VertebralBodiesCT
  std::map<int, LabelShape> with_disc = column({21, 22}, kLumbar);  // SPINEPS: the disc, and an endplate
  with_disc[121] = with_disc[221] = {Vec3(0, 0, -17), Vec3(50, 36, 9), 9000.0, false};
  const LabelMeaning meaning = meaning_of(with_disc, {}, {}, "map.nii");
  EXPECT_EQ(meaning.names.at(22).level, Level{22});
  EXPECT_EQ(meaning.names.at(121).level, Level::kNone);
  EXPECT_THAT(meaning.source, AllOf(HasSubstr("VerSe"), HasSubstr("order and size")));
}

TEST(LabelMeaning, AsksWhereNumbersCanBeMeantInSeveralWays) {
  EXPECT_THAT(question({2, 3, 4}, kLumbar),
              AllOf(HasSubstr("3 is C3 in VerSe (but"), HasSubstr("L3 in a count from L1"), HasSubstr("just counted"),
                    HasSubstr("convention"), HasSubstr("map.nii")));
  EXPECT_THAT(question({5, 4, 3}, kLumbar), AllOf(HasSubstr("TotalSegmentator's vertebrae_mr"), HasSubstr("SPIDER")));
  EXPECT_THAT(question({22}, kLumbar), AllOf(HasSubstr("L3 in VerSe"), HasSubstr("L1 in TotalSegmentator 1")));
  EXPECT_THAT(question({1, 2, 3}, kCervical), HasSubstr("just counted"));
  EXPECT_THAT(question({13, 14, 15}, kCervical, 13), AllOf(HasSubstr("13 is "), HasSubstr("C3 in TotalSpineSeg")));
}

TEST(LabelMeaning, AsksWhereNoKnownNumberingFits) {
  const std::string asked = question({12, 13, 14}, kLumbar, 13);
  EXPECT_THAT(asked, AllOf(HasSubstr("13 is T6 in VerSe (but"), HasSubstr("C3 in TotalSpineSeg (but"),
                           HasSubstr("L1 in VertebralBodiesCT (but"), HasSubstr("none of these fits")));
  // Gaps that no spine has.
  EXPECT_THAT(question({21, 22}, {kLumbar.size_mm, kLumbar.cm3, 90.0}), HasSubstr("90 mm from the next below"));
}

TEST(LabelMeaning, TakesAWholeSpineThatIsCounted) {
  std::map<int, LabelShape> shapes;
  double z_mm = 0.0;
  for (int number = 1; number <= 24; ++number) {
    const Kind& kind = number <= 7 ? kCervical : number <= 19 ? kMidThoracic : kLumbar;
    shapes[number] = {Vec3(0, 0, z_mm), kind.size_mm, 1000.0 * kind.cm3, false};
    z_mm -= number <= 7 ? 16.0 : number <= 19 ? 24.0 : 34.0;
  }
  const LabelMeaning meaning = meaning_of(shapes, {}, {}, "map.nii");
  EXPECT_EQ(meaning.names.at(19).level, Level::kT12);
  EXPECT_EQ(meaning.names.at(24).level, Level::kL5);
}

TEST(LabelMeaning, LeavesTheLevelOpenWhereNothingTellsIt) {
  LabelReadOptions one;
  one.wanted = 1;
  EXPECT_EQ(levels({1}, kLumbar, one), "-");  // a mask of one bone
  EXPECT_EQ(levels({200, 230}, kLumbar), "- -");
  LabelReadOptions none;
  none.convention = LabelConvention::none;
  EXPECT_EQ(levels({21, 22}, kLumbar, none), "- -");
  EXPECT_EQ(meaning_of(column({1}, kLumbar), {}, one, "map.nii").source, "");
}

TEST(LabelMeaning, LooksOnlyAtWhatIsWholeOfALabelAtTheMapsBorder) {
  std::map<int, LabelShape> shapes = column({20, 21, 22}, kLumbar);
  shapes[20] = {Vec3(0, 0, 20), Vec3(40, 60, 8), 3000.0, true};
  EXPECT_EQ(meaning_of(shapes, {}, {}, "map.nii").names.at(20).level, Level::kL1);
  shapes[20].is_cut = false;
  EXPECT_THAT(error_of([&] { meaning_of(shapes, {}, {}, "map.nii"); }), HasSubstr("3 cm3, at least"));
}

TEST(LabelMeaning, TakesNamesBeforeNumbersAndTheUsersWordBeforeBoth) {
  const std::map<long long, std::string> names{{3, "vertebrae_L3"}, {4, "vertebrae_L2"}};
  const LabelMeaning named = meaning_of(column({4, 3}, kCervical), names, {}, "map.nii");
  EXPECT_EQ(named.names.at(3).level, Level{22});
  EXPECT_THAT(named.source, HasSubstr("names"));
  LabelReadOptions said;
  said.convention = LabelConvention::verse;
  const LabelMeaning by_word = meaning_of(column({3, 4}, kLumbar), {}, said, "map.nii");
  EXPECT_EQ(by_word.names.at(3).level, Level{3});
  EXPECT_THAT(by_word.source, AllOf(HasSubstr("VerSe"), HasSubstr("as was said"), Not(HasSubstr("alone"))));
}

}  // namespace
}  // namespace spinaltap::detail
