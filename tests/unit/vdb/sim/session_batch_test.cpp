#include "vdb/sim/session_batch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "core/base/error.h"
#include "core/session/record/session_record.h"
#include "tests/support/analytic_bodies.h"
#include "vdb/sim/session.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const test::Ball kManyBall{Vec3(3.0, -4.0, 5.0), 9.0};

const Bone& many_ball() {
  static const Bone bone(test::bake_ball(kManyBall, 0.3));
  return bone;
}

/// Into the ball from one side.
DrillPath path_along(const Vec3& direction) {
  const Vec3 axis = direction.normalized();
  const Vec3 entry_mm = kManyBall.centre_mm - kManyBall.radius_mm * axis;
  return {"in", entry_mm, entry_mm + 6.0 * axis, {2.0, 30.0, 2.0}};
}
const std::vector<Vec3> kDirections{{0.2, -0.9, 0.3}, {1.0, 0.1, 0.0}};

/// The ball is no vertebra.
SessionSetup batch_setup() {
  SessionSetup setup;
  setup.has_clearances = false;
  setup.volume = {.radius_mm = 2.0, .spacing_mm = 0.15, .lead_in_mm = 1.0};
  return setup;
}

SessionBatch batch(std::size_t count, int threads = 0) {
  std::vector<BonePath> holes;
  for (const Vec3& direction : kDirections) holes.push_back({many_ball(), path_along(direction)});
  return SessionBatch(holes, count, batch_setup(), threads);
}

std::vector<ToolInput> straight_in(const DrillPath& path) {
  std::vector<ToolInput> inputs;
  for (int n = 0; n < 150; ++n) {
    inputs.push_back({{path.entry_mm + (0.04 * n - 1.0) * path.direction(), path.direction()}, true, 0.001});
  }
  return inputs;
}

/// Rows of each, drilled at once.
std::vector<std::vector<RecordedCycle>> drilled(SessionBatch& batch) {
  std::vector<std::vector<RecordedCycle>> rows(batch.count());
  batch.for_each([&](std::size_t n) {
    DrillSession& session = batch.session(n);
    for (const ToolInput& input : straight_in(session.path())) rows[n].push_back(recorded(session.step(input)));
  });
  return rows;
}

TEST(SessionBatch, DrillsWhatSessionsDrillAlone) {
  SessionBatch many = batch(5);
  const auto rows = drilled(many);
  for (std::size_t n = 0; n < rows.size(); ++n) {
    Session alone(many_ball(), path_along(kDirections[n % kDirections.size()]), batch_setup());
    EXPECT_EQ(alone.run(straight_in(alone.path())), rows[n]) << "session " << n;
    std::size_t removed = 0;
    for (const RecordedCycle& row : rows[n]) removed += row.removed;
    EXPECT_GT(removed, 0U);
  }
}

TEST(SessionBatch, IsTheSameOnAnyNumberOfThreads) {
  SessionBatch one = batch(6, 1);
  SessionBatch two = batch(6, 2);
  EXPECT_EQ(drilled(one), drilled(two));
}

TEST(SessionBatch, BeginsAgainWithAllItsBone) {
  SessionBatch many = batch(3);
  const auto rows = drilled(many);
  many.for_each([&](std::size_t n) { EXPECT_EQ(many.reset(n).last().index, 0U); });
  EXPECT_EQ(drilled(many), rows);
}

TEST(SessionBatch, HandsOnWhatWorkThrows) {
  SessionBatch many = batch(4);
  EXPECT_THAT(([&] {
                many.for_each([](std::size_t n) {
                  if (n == 2) fail("the third one");
                });
              }),
              ThrowsMessage<Error>(HasSubstr("the third one")));
}

TEST(SessionBatch, RejectsWhatIsNoBatch) {
  EXPECT_THAT(([] { SessionBatch({}, 3, batch_setup()); }), ThrowsMessage<Error>(HasSubstr("found none")));
  EXPECT_THAT(([] { batch(0); }), ThrowsMessage<Error>(HasSubstr("found 0")));
  EXPECT_THAT(([] { batch(2, -1); }), ThrowsMessage<Error>(HasSubstr("threads")));
}

}  // namespace
}  // namespace spinaltap
