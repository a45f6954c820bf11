// A recorded hand that the planner drills, beside a session of the library.

#include <gtest/gtest.h>

#include "apps/spinaltap-planner/drill/played_hole.h"
#include "core/session/record/session_record.h"
#include "tests/gui/phantom_bone.h"
#include "tests/support/recorded_hand.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

TEST(PlannersRecord, OfARecordedHandIsThatOfASession) {
  const test::TemporaryFolder folder;
  const DrillPath path = test::phantom_paths().front();
  const std::vector<ToolInput> hand = test::recorded_hand(path, folder.path() / "hand.csv");
  OperatorChoice choice;
  choice.name = folder.path() / "hand.csv";
  PlayedHole hole(test::phantom_bone(), session_setup(path, {}), choice);
  while (hole.step()) continue;
  ASSERT_EQ(hole.inputs().size(), hand.size());
  DoneDrilling done = hole.done();
  write_record(done, folder.path() / "heat.h5");
  SessionSetup setup;
  setup.options.heat = done.setup.options.heat;
  ASSERT_TRUE(setup.options.heat);
  const Bone& bone = *test::phantom_bone()->bone;
  EXPECT_EQ(hash_of(read_record(folder.path() / "heat.h5")), test::session_hash(Session(bone, path, setup), hand));
  // What the planner has beside the defaults of a session is the heat that it shows.
  done.setup.options.heat.reset();
  write_record(done, folder.path() / "plain.h5");
  const SessionRecord record = read_record(folder.path() / "plain.h5");
  EXPECT_GE(record.events.size(), 2U);
  EXPECT_EQ(hash_of(record), test::session_hash(Session(bone, path), hand));
}

}  // namespace
}  // namespace spinaltap
