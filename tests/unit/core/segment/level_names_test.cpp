#include "core/segment/level_names.h"
#include "core/segment/spine_bodies.h"

#include <gmock/gmock.h>

namespace spinaltap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Bodies of given sizes, mm, from below, 8 mm apart, each as high as 0.6 of its width.
SpineBodies row_of(const std::vector<double>& widths_mm, bool has_sacrum) {
  SpineBodies spine;
  spine.has_sacrum = has_sacrum;
  double low_mm = 0.0;
  for (const double width_mm : widths_mm) {
    const double high_mm = 0.6 * width_mm;
    BodySpan span;
    const Vec3 middle_mm(0.0, 0.0, low_mm + 0.5 * high_mm);
    span.lower.centre_mm = Vec3(0.0, 0.0, low_mm);
    span.upper.centre_mm = Vec3(0.0, 0.0, low_mm + high_mm);
    span.lower.s_mm = low_mm;
    span.upper.s_mm = low_mm + high_mm;
    spine.chain.push_back(span);
    spine.bodies.push_back({{}, StarSurface(middle_mm, 100)});
    spine.bodies.back().cylinder.centre_mm = middle_mm;
    spine.bodies.back().cylinder.half_mm = Vec3(0.5 * width_mm, 0.4 * width_mm, 0.5 * high_mm);
    low_mm += high_mm + 8.0;
  }
  return spine;
}

const std::vector<double> kLumbar{46.0, 45.0, 44.0, 43.0, 42.0};  // L5 to L1
const std::vector<double> kToT10{46.0, 45.0, 44.0, 43.0, 42.0, 39.0, 35.0, 32.0};

std::vector<Ribs> unknown(std::size_t count) { return std::vector<Ribs>(count, Ribs::unknown); }

double sum_of(const std::vector<LevelProbability>& probabilities) {
  double sum = 0.0;
  for (const LevelProbability& one : probabilities) sum += one.probability;
  return sum;
}

TEST(VotedNames, BeginAboveTheSacrum) {
  std::vector<double> widths = kLumbar;
  widths.insert(widths.begin(), 50.0);
  const LevelNames names = voted_names(row_of(widths, true), unknown(6));
  EXPECT_THAT(names.levels, ElementsAre(Level::kSacrum, Level::kL5, Level{23}, Level{22}, Level{21}, Level::kL1));
  // Of 802 people 30 have another lowest lumbar vertebra than L5, and some sacra are taken wrongly.
  EXPECT_GT(names.probabilities[1].front().probability, 0.85);
  EXPECT_LT(names.probabilities[1].front().probability, 0.97);
  EXPECT_NEAR(sum_of(names.probabilities[1]), 1.0, 0.05);
  EXPECT_THAT(names.probabilities[0], IsEmpty()) << "the sacrum is none of the vertebrae";
  EXPECT_THAT(names.transitional, IsEmpty());
}

TEST(VotedNames, BeginAtTheLastRibs) {
  using enum Ribs;
  const LevelNames names = voted_names(row_of(kToT10, false), {none, none, none, none, none, both, both, both});
  EXPECT_EQ(names.levels[5], Level::kT12);
  EXPECT_EQ(names.levels[0], Level::kL5);
  EXPECT_GT(names.probabilities[5].front().probability, 0.8);
  EXPECT_THAT(in_words(names.probabilities[5]), HasSubstr("T12 0."));
}

TEST(VotedNames, BeginAtTheFirstRibs) {
  using enum Ribs;
  // T3 to C5.
  const LevelNames names =
      voted_names(row_of({24.6, 24.9, 24.5, 21.8, 18.5, 17.5}, false), {both, both, both, none, none, none});
  EXPECT_EQ(names.levels[2], Level::kT1);
  EXPECT_EQ(names.levels[3], Level::kC7);
}

// A thoracic row of which the CT cuts the lowest: its ribs lie beyond.
TEST(VotedNames, DoNotEndRibsAtABodyThatTheCtCuts) {
  using enum Ribs;
  SpineBodies row = row_of({32.0, 30.0, 28.5, 27.5, 26.0}, false);
  row.chain[0].lower.is_cut = true;
  const LevelNames names = voted_names(row, {none, both, both, both, both});
  EXPECT_THAT(names.levels, testing::Each(Level::kNone));
  const double cut = names.probabilities[1].front().probability;
  row.chain[0].lower.is_cut = false;
  const LevelProbability whole = voted_names(row, {none, both, both, both, both}).probabilities[1].front();
  EXPECT_EQ(whole.level, Level::kT12);
  EXPECT_GT(whole.probability, 2.0 * cut);
}

// C2 has a body too: a row that begins with it is not moved down by one.
TEST(VotedNames, BeginWithTheSecondOfTheNeck) {
  using enum Ribs;
  // T3 to C2.
  const LevelNames names = voted_names(row_of({24.6, 24.9, 24.5, 21.8, 18.5, 17.5, 17.2, 15.8, 18.0}, false),
                                       {both, both, both, none, none, none, none, none, none});
  EXPECT_EQ(names.levels[2], Level::kT1);
  EXPECT_EQ(names.levels[8], Level::kC2);
}

TEST(VotedNames, AgreeOrTheSpineIsTransitional) {
  using enum Ribs;
  std::vector<double> widths = kToT10;
  widths.insert(widths.begin(), 50.0);
  const LevelNames both_agree =
      voted_names(row_of(widths, true), {unknown, none, none, none, none, none, both, both, both});
  EXPECT_GT(both_agree.probabilities[1].front().probability, 0.98) << "surer than by the sacrum alone";
  EXPECT_THAT(both_agree.transitional, IsEmpty());
  // Six without ribs: another number of vertebrae, or short ribs that were not seen.
  widths.insert(widths.begin() + 1, 47.0);
  const LevelNames six =
      voted_names(row_of(widths, true), {unknown, none, none, none, none, none, none, both, both, both});
  EXPECT_LT(six.probabilities[1].front().probability, 0.9);
  ASSERT_GE(six.probabilities[1].size(), 2U);
  // Seven, which nobody has: what was seen is wrong somewhere, and probabilities say so.
  widths.insert(widths.begin() + 1, 47.0);
  const LevelNames seven =
      voted_names(row_of(widths, true), {unknown, none, none, none, none, none, none, none, both, both, both});
  EXPECT_LT(seven.probabilities[1].front().probability, 0.9);
}

TEST(VotedNames, AreNotGivenBySizesAlone) {
  const LevelNames names = voted_names(row_of(kToT10, false), unknown(8));
  EXPECT_THAT(names.levels, testing::Each(Level::kNone));
  EXPECT_THAT(names.probabilities[0], testing::Not(IsEmpty())) << "and are told as probabilities";
  using enum Ribs;
  EXPECT_THAT(voted_names(row_of({30.0, 29.0, 28.0}, false), {both, both, both}).levels, testing::Each(Level::kNone))
      << "ribs at all levels name none";
}

TEST(VotedNames, OfNothingAreNone) {
  const LevelNames names = voted_names({}, {});
  EXPECT_THAT(names.levels, IsEmpty());
  EXPECT_THAT(in_words(std::vector<LevelProbability>{}), IsEmpty());
}

// Above a stretch that fits no number of bodies the sacrum names nothing.
TEST(VotedNames, EndAtAnUnclearGap) {
  std::vector<double> widths = kToT10;
  widths.insert(widths.begin(), 50.0);
  SpineBodies spine = row_of(widths, true);
  for (std::size_t n = 5; n < spine.bodies.size(); ++n) {
    const Vec3 up_mm(0.0, 0.0, 16.0);
    spine.bodies[n].cylinder.centre_mm += up_mm;
    spine.chain[n].lower.centre_mm += up_mm;
    spine.chain[n].upper.centre_mm += up_mm;
    spine.chain[n].lower.s_mm += up_mm.z();
    spine.chain[n].upper.s_mm += up_mm.z();
  }
  const LevelNames names = voted_names(spine, unknown(9));
  EXPECT_EQ(names.levels[4], Level{21});
  EXPECT_EQ(names.levels[5], Level::kNone);
}

}  // namespace
}  // namespace spinaltap
