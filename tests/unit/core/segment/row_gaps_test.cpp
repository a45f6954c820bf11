#include "core/segment/row_gaps.h"

#include <gmock/gmock.h>

namespace spinaltap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kApartMm = 35.0, kHighMm = 27.0;

/// Bodies of a straight spine at multiples of 35 mm, from below, in front of a canal from `low` to `high` mm.
SpineBodies row_at(const std::vector<int>& places, double low, double high) {
  SpineBodies spine;
  for (const int place : places) {
    BodySpan span;
    const Vec3 middle_mm(0.0, 0.0, kApartMm * place);
    span.lower.centre_mm = middle_mm - 0.5 * kHighMm * Vec3::UnitZ();
    span.upper.centre_mm = middle_mm + 0.5 * kHighMm * Vec3::UnitZ();
    span.lower.s_mm = span.lower.centre_mm.z();
    span.upper.s_mm = span.upper.centre_mm.z();
    spine.chain.push_back(span);
    spine.bodies.push_back({{}, StarSurface(middle_mm, 100)});
    spine.bodies.back().cylinder.centre_mm = middle_mm;
    spine.bodies.back().cylinder.half_mm = Vec3(22.0, 16.0, 0.5 * kHighMm);
  }
  for (double z = low; z <= high; z += SpinalCanal::kStepMm) spine.canal.points_mm.emplace_back(0.0, 25.0, z);
  return spine;
}

TEST(GapsInRow, AreNoneWhereTheCanalEndsWithTheRow) {
  EXPECT_THAT(gaps_in_row(row_at({0, 1, 2, 3}, -40.0, 150.0)), IsEmpty());
  EXPECT_THAT(gaps_in_row(row_at({0}, -200.0, 300.0)), IsEmpty()) << "one body tells no step";
  EXPECT_THAT(gaps_in_row({}), IsEmpty());
}

TEST(GapsInRow, SayWhereABodyHasRoom) {
  EXPECT_THAT(gaps_in_row(row_at({0, 1, 3}, -40.0, 150.0)),
              ElementsAre("a body may be missed between z 105 mm and z 35 mm: 43 mm lie between two of 27 mm"));
}

// Bodies of 27 mm, discs of 8; a crushed one of 8 mm with its discs leaves 20.
TEST(GapsInRow, SayWhereACrushedBodyHasRoomAmongThinDiscs) {
  SpineBodies spine = row_at({0, 1, 2, 3}, -40.0, 150.0);
  const auto raise = [&](std::size_t n, double by_mm) {
    spine.bodies[n].cylinder.centre_mm.z() += by_mm;
    for (BodyEnd* end : {&spine.chain[n].lower, &spine.chain[n].upper}) {
      end->centre_mm.z() += by_mm;
      end->s_mm += by_mm;
    }
  };
  raise(3, 12.5);
  EXPECT_THAT(gaps_in_row(spine),
              ElementsAre("a body may be missed between z 118 mm and z 70 mm: 21 mm lie between two of 27 mm"));
  EXPECT_EQ(bodies_missing_above(spine, 1), 0);
  EXPECT_EQ(bodies_missing_above(spine, 2), std::nullopt) << "one that is crushed, or none";
  raise(3, -4.0);
  EXPECT_THAT(gaps_in_row(spine), IsEmpty()) << "a disc of 17 mm";
}

// The bodies beside one that was not found have taken a part of it each.
TEST(GapsInRow, SayWhereAStepIsLong) {
  SpineBodies spine = row_at({0, 1, 2, 3, 4}, -40.0, 180.0);
  for (const std::size_t n : {std::size_t{3}, std::size_t{4}}) {
    spine.bodies[n].cylinder.centre_mm.z() += 13.0;
    for (BodyEnd* end : {&spine.chain[n].lower, &spine.chain[n].upper}) end->centre_mm.z() += 13.0;
  }
  spine.chain[3].lower.centre_mm.z() -= 8.0;
  EXPECT_THAT(gaps_in_row(spine), ElementsAre("a body may be missed between z 118 mm and z 70 mm: their middles are "
                                              "48 mm apart, those beside them up to 35 mm"));
  EXPECT_EQ(bodies_missing_above(spine, 2), std::nullopt);
  EXPECT_EQ(bodies_missing_above(spine, 1), 0);
}

// Two of 27 mm with their disc of 8; one of them crushed to half.
TEST(GapsInRow, SayWhichBodyMayBeTwo) {
  SpineBodies spine = row_at({0, 1, 2, 3}, -40.0, 150.0);
  const auto grow = [&](std::size_t n, double height_mm) {
    spine.chain[n].upper.s_mm = spine.chain[n].lower.s_mm + height_mm;
    spine.chain[n].upper.centre_mm.z() = spine.chain[n].lower.centre_mm.z() + height_mm;
  };
  grow(1, 48.0);
  EXPECT_THAT(gaps_in_row(spine),
              ElementsAre("a body at z 35 mm is 48 mm high, much higher than its neighbours: it may be two"));
  EXPECT_EQ(bodies_missing_above(spine, 0), std::nullopt);
  EXPECT_EQ(bodies_missing_above(spine, 1), std::nullopt);
  EXPECT_EQ(bodies_missing_above(spine, 2), 0);
  grow(1, 27.0);
  grow(2, 16.0);
  EXPECT_THAT(gaps_in_row(spine), IsEmpty()) << "a crushed one beside sound ones";
}

TEST(GapsInRow, HaveRoomForSoManyBodies) {
  const SpineBodies spine = row_at({0, 1, 3, 6, 11, 12, 13, 14}, -40.0, 400.0);
  EXPECT_EQ(bodies_missing_above(spine, 0), 0);
  EXPECT_EQ(bodies_missing_above(spine, 1), 1);
  EXPECT_EQ(bodies_missing_above(spine, 2), 2);
  EXPECT_EQ(bodies_missing_above(spine, 3), std::nullopt) << "four: steps change on the way";
}

TEST(GapsInRow, SayHowFarTheCanalGoesOnBeyondTheRow) {
  EXPECT_THAT(gaps_in_row(row_at({0, 1, 2}, -40.0, 260.0)),
              ElementsAre("vertebrae may be missed above the row: it ends at z 70 mm, the canal goes on to z 260 mm, "
                          "vertebrae are 35 mm apart"));
  SpineBodies below = row_at({0, 1, 2}, -180.0, 100.0);
  EXPECT_THAT(gaps_in_row(below), ElementsAre(HasSubstr("may be missed below the row: it ends at z 0 mm")));
  below.has_sacrum = true;
  EXPECT_THAT(gaps_in_row(below), IsEmpty());
}

TEST(GapsInRow, SayNothingBeyondABodyThatTheCtCuts) {
  SpineBodies spine = row_at({0, 1, 2}, -40.0, 260.0);
  spine.chain.back().upper.is_cut = true;
  EXPECT_THAT(gaps_in_row(spine), IsEmpty());
}

}  // namespace
}  // namespace spinaltap
