#include "apps/spinaltap-planner/opened_bone.h"

#include <gmock/gmock.h>

#include "apps/spinaltap-planner/plan_document.h"
#include "tests/gui/phantom_bone.h"

namespace spinaltap {
namespace {

TEST(OpenedBone, HoldsWallsLandmarksSlicesAndSurface) {
  const OpenedBone& bone = *test::phantom_bone();
  EXPECT_EQ(bone.file, test::phantom_file());
  ASSERT_NE(bone.landmarks(), nullptr);
  EXPECT_FALSE(bone.surface.empty());
  const DrillPath path = test::phantom_paths().front();
  EXPECT_GT(sample_hu(bone.ct, path.target_mm), -200.0);  // in the body's cancellous bone, not beyond it
}

TEST(StickToSurface, FindsThePhantomsSurfaceFromNearAndFar) {
  const OpenedBone& bone = *test::phantom_bone();
  const Vertebra vertebra;
  const DrillPath path = test::phantom_paths().front();
  for (const double off_mm : {-4.0, -0.3, 0.2, 3.0, 25.0}) {
    const Vec3 place = stick_to_surface(bone, path.entry_mm - off_mm * path.direction());
    double distance_mm = 1.0;
    vertebra.evaluate({&place, 1}, {&distance_mm, 1}, {});
    EXPECT_NEAR(distance_mm, 0.0, 0.03) << off_mm;  // the grid of 0.4 mm: docs/bone-vdb.md
  }
}

TEST(EntryBehind, LiesOnTheBackOfThePhantomStraightBehindTheTarget) {
  const OpenedBone& bone = *test::phantom_bone();
  const DrillPath path = test::phantom_paths().front();
  const Vec3 entry = entry_behind(bone, path.target_mm);
  double distance_mm = 1.0;
  Vertebra().evaluate({&entry, 1}, {&distance_mm, 1}, {});
  EXPECT_NEAR(distance_mm, 0.0, 0.03);
  EXPECT_GT(entry.y(), path.target_mm.y() + 10.0);
  const Vec3 beyond = bone.model().bounds_mm().max() + Vec3(5.0, 0.0, 0.0);  // no bone behind: the nearest place
  EXPECT_LT((entry_behind(bone, beyond) - stick_to_surface(bone, beyond)).norm(), 1e-6);
}

TEST(PlanDocument, UndoesAndRedoesEveryChange) {
  PlanDocument document;
  document.set_bone(test::phantom_bone());
  const std::vector<DrillPath> paths = test::phantom_paths();
  EXPECT_EQ(document.add_path(paths[0]), 0);
  EXPECT_EQ(document.add_path(paths[0]), 1);
  EXPECT_EQ(document.paths()[1].name, "left 2");
  const std::uint64_t drag = document.new_drag();
  for (int step = 1; step <= 5; ++step) {
    EXPECT_TRUE(document.move_end(1, PathEnd::target, paths[0].target_mm + Vec3(0.1 * step, 0.0, 0.0), drag));
  }
  EXPECT_EQ(document.undo_stack().count(), 3);
  document.undo_stack().undo();
  EXPECT_EQ(document.paths()[1].target_mm, paths[0].target_mm);
  document.undo_stack().redo();
  EXPECT_EQ(document.paths()[1].target_mm, Vec3(paths[0].target_mm + Vec3(0.5, 0.0, 0.0)));
  document.remove_path(0);
  EXPECT_EQ(document.chosen(), 0);
  document.undo_stack().undo();
  EXPECT_EQ(document.paths().size(), 2U);
  while (document.undo_stack().canUndo()) document.undo_stack().undo();
  EXPECT_TRUE(document.paths().empty());
  EXPECT_EQ(document.chosen(), -1);
  EXPECT_EQ(document.chosen_path(), nullptr);
}

TEST(PlanDocument, KeepsWhatCanBeRedoneFromADragThatIsGivenUp) {
  PlanDocument document;
  document.set_bone(test::phantom_bone());
  const std::vector<DrillPath> paths = test::phantom_paths();
  document.add_path(paths[0]);
  document.add_path(paths[1]);
  document.undo_stack().setClean();
  document.remove_path(0);
  QUndoStack& stack = document.undo_stack();
  stack.undo();
  stack.undo();
  const std::uint64_t drag = document.new_drag();
  for (int step = 1; step <= 3; ++step) {
    EXPECT_TRUE(document.move_end(0, PathEnd::target, paths[0].target_mm + Vec3(0.1 * step, 0.0, 0.0), drag));
  }
  EXPECT_EQ(stack.count(), 2);
  document.give_up(drag);
  EXPECT_EQ(document.paths().size(), 1U);
  EXPECT_EQ(document.paths()[0].target_mm, paths[0].target_mm);
  EXPECT_EQ(stack.index(), 1);
  EXPECT_EQ(stack.count(), 3);
  EXPECT_FALSE(stack.isClean());
  stack.redo();
  EXPECT_TRUE(stack.isClean());
  ASSERT_EQ(document.paths().size(), 2U);
  EXPECT_EQ(document.paths()[1].target_mm, paths[1].target_mm);
  stack.redo();
  ASSERT_EQ(document.paths().size(), 1U);
  EXPECT_EQ(document.paths()[0].name, paths[1].name);
  // One that was undone meanwhile, or that another change came after, is let alone.
  const std::uint64_t other = document.new_drag();
  EXPECT_TRUE(document.move_end(0, PathEnd::target, paths[1].target_mm + Vec3(0.1, 0.0, 0.0), other));
  document.add_path(paths[0]);
  document.give_up(other);
  EXPECT_EQ(document.paths().size(), 2U);
  stack.undo();
  stack.undo();
  document.give_up(other);
  EXPECT_EQ(document.paths()[0].target_mm, paths[1].target_mm);
  EXPECT_EQ(stack.count(), 5);
}

TEST(PlanDocument, RejectsAMoveThatLeavesNoPath) {
  PlanDocument document;
  document.set_bone(test::phantom_bone());
  document.add_path(test::phantom_paths().front());
  const DrillPath before = *document.chosen_path();
  EXPECT_FALSE(document.move_end(0, PathEnd::target, before.entry_mm));
  EXPECT_EQ(document.chosen_path()->target_mm, before.target_mm);
}

}  // namespace
}  // namespace spinaltap
