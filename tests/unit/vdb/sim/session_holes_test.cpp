// Holes of a session one after the other: undo, those before it, the surface that changes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "core/session/record/session_record.h"
#include "mesh/mesh_quality.h"
#include "mesh/remaining_mesh.h"
#include "tests/unit/vdb/sim/session_ball.h"
#include "vdb/sim/build_session.h"

namespace spinaltap {
namespace {

using test::session_ball::ball;
using test::session_ball::kSessionBall;
using test::session_ball::path;
using test::session_ball::setup;
using test::session_ball::straight_in;

TEST(Session, UndoPutsBackTheHoleSoFarAndThenTheOnesBefore) {
  const std::vector<ToolInput> inputs = straight_in(300);
  Session session(ball(), path(), setup());
  EXPECT_FALSE(session.undo());
  const std::vector<RecordedCycle> first = session.run(inputs);
  session.end_hole();
  const std::string one_hole = session.drilled().hash();
  const std::vector<RecordedCycle> second = session.run(straight_in(300, 0.5));
  EXPECT_NE(session.drilled().hash(), one_hole);
  EXPECT_NE(second, first);
  EXPECT_EQ(session.last().index, 299U);

  EXPECT_TRUE(session.undo());
  EXPECT_EQ(session.drilled().hash(), one_hole);
  EXPECT_EQ(session.run(straight_in(300, 0.5)), second) << "the same hole again gives the same";
  EXPECT_TRUE(session.undo());
  EXPECT_TRUE(session.undo());
  EXPECT_EQ(session.drilled().hash(), ball().hash());
  EXPECT_EQ(session.run(inputs), first);
}

using Blocks = std::map<std::array<int, 3>, std::shared_ptr<const SurfaceBlock>>;

void take(const std::vector<SurfaceUpdate>& changes, Blocks& blocks) {
  for (const SurfaceUpdate& change : changes) {
    if (change.surface) {
      blocks[change.block] = change.surface;
    } else {
      EXPECT_EQ(blocks.erase(change.block), 1U) << "a block that was never there is gone";
    }
  }
}

TriangleMesh mesh_of(const Blocks& blocks) {
  std::vector<std::shared_ptr<const SurfaceBlock>> list;
  for (const auto& [place, block] : blocks) list.push_back(block);
  return join_blocks(list);
}

TEST(Session, DrillsEarlierHolesToTheSamePoints) {
  // An operator that trembles and tilts: the hole is no union of a few ways along the axis.
  std::vector<ToolInput> inputs = straight_in(400);
  for (std::size_t n = 0; n < inputs.size(); ++n) {
    const double phase = 0.06 * static_cast<double>(n);
    inputs[n].pose.tip_mm += Vec3(0.1 * std::sin(phase), 0.0, 0.1 * std::cos(1.2 * phase));
    inputs[n].pose.axis = (inputs[n].pose.axis + Vec3(0.02 * std::sin(0.3 * phase), 0.0, 0.0)).normalized();
  }
  for (const EngineKind engine : {EngineKind::ring, EngineKind::voxel}) {
    SessionSetup whole = setup();
    whole.path = path();
    whole.engine = engine;
    BuiltSession built = build_session(ball(), whole);
    for (const ToolInput& input : inputs) built.session->step(input);
    SessionSetup again = whole;
    again.holes = {drilled_hole(inputs, whole.path.bit, whole.options.max_jump_mm)};
    const BuiltSession next = build_session(ball(), again);
    EXPECT_LT(built.bone.occupied_count(), build_session(ball(), whole).bone.occupied_count());
    EXPECT_EQ(next.bone.occupied_count(), built.bone.occupied_count());
  }
}

TEST(Session, TellsWhatChangesOfTheSurfaceThroughHolesAndUndo) {
  Session session(ball(), path(), setup());
  Blocks blocks;
  take(session.surface_changes(), blocks);
  const double whole_mm3 = measure_mesh(mesh_of(blocks)).volume_mm3;
  EXPECT_NEAR(whole_mm3, kSessionBall.volume_mm3(), 0.01 * kSessionBall.volume_mm3());
  EXPECT_TRUE(session.surface_changes().empty());

  session.run(straight_in(300));
  take(session.surface_changes(), blocks);
  const MeshQuality drilled = measure_mesh(mesh_of(blocks));
  EXPECT_TRUE(drilled.closed());
  // The cone is 2 mm high and has come 5 mm in; what it meets of the ball before is a cap of some hundredths of a mm.
  const double hole_mm3 = std::numbers::pi * (5.0 - 2.0 + 2.0 / 3.0);
  EXPECT_NEAR(whole_mm3 - drilled.volume_mm3, hole_mm3, 0.05 * hole_mm3);

  session.end_hole();
  session.run(straight_in(200, 3.0));
  take(session.surface_changes(), blocks);
  EXPECT_TRUE(measure_mesh(mesh_of(blocks)).closed());
  EXPECT_LT(measure_mesh(mesh_of(blocks)).volume_mm3, drilled.volume_mm3 - 1.0);
  session.undo();
  take(session.surface_changes(), blocks);
  EXPECT_NEAR(measure_mesh(mesh_of(blocks)).volume_mm3, drilled.volume_mm3, 0.01);
  session.undo();
  take(session.surface_changes(), blocks);
  EXPECT_EQ(measure_mesh(mesh_of(blocks)).volume_mm3, whole_mm3);
}

}  // namespace
}  // namespace spinaltap
