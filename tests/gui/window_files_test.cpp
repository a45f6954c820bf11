// What is opened, saved and could be lost; the rest of what people do with the window is in window_test.cpp.
#include <gmock/gmock.h>

#include <QApplication>
#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

#include "apps/spinaltap-planner/scene/scene_view.h"
#include "core/base/error.h"
#include "core/files/plan_file.h"
#include "tests/gui/planner_window.h"
#include "tests/support/full_disk.h"

namespace spinaltap::test {
namespace {

using PlannerWindowTest = PlannerWindow;

TEST_F(PlannerWindowTest, SavesAndReopensTheSame) {
  show_phantom();
  document().move_end(0, PathEnd::target, document().paths()[0].target_mm + Vec3(0.3, -0.2, 0.7));
  const std::filesystem::path file = folder.path() / "my plan.json";
  in_the_next_dialog([&] {
    input.key("ctrl+a");
    input.type(text_of(file.string()));
    input.key("Return");
  });
  input.key("ctrl+s");
  ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(file) && !planner().has_unsaved_changes(); }));
  const std::vector<DrillPath> saved = document().paths();

  document().set_paths({});
  window->open(file);
  ASSERT_EQ(document().paths().size(), saved.size());
  for (std::size_t n = 0; n < saved.size(); ++n) {
    EXPECT_EQ(document().paths()[n].name, saved[n].name);
    EXPECT_EQ(document().paths()[n].entry_mm, saved[n].entry_mm);
    EXPECT_EQ(document().paths()[n].target_mm, saved[n].target_mm);
  }
  EXPECT_EQ(planner().plan_file(), file);
  // And by way of 3D Slicer's markups.
  const std::filesystem::path markups = folder.path() / "plan.mrk.json";
  planner().save_plan(markups);
  window->open(markups);
  EXPECT_EQ(document().paths().at(1).entry_mm, saved[1].entry_mm);
}

TEST_F(PlannerWindowTest, APictureOfTheWindowShows3DAsItNowIs) {
  show_phantom();
  SceneView& scene = window->panes().scene();
  const std::filesystem::path file = folder.path() / "window.png";
  for (const char* view : {"left", "hole"}) {
    scene.look_from(view);
    planner().view().set_bone_opacity(0.4);
    window->save_picture(file, {});
    const QRect place(scene.mapTo(window.get(), QPoint(0, 0)), scene.size());
    EXPECT_EQ(QImage(text_of(file.string())).convertToFormat(QImage::Format_RGB32).copy(place), scene.picture());
  }
}

TEST_F(PlannerWindowTest, ForeignPlanIsRejectedInWordsAndNothingIsLost) {
  show_phantom();
  const std::filesystem::path file = folder.path() / "foreign.json";
  std::vector<DrillPath> paths = phantom_paths();
  for (DrillPath& path : paths) {
    path.entry_mm += Vec3(500.0, 0.0, 0.0);
    path.target_mm += Vec3(500.0, 0.0, 0.0);
  }
  write_plan(paths, file);
  answer_box(QMessageBox::Ok);
  window->open(file);
  EXPECT_THAT(box_text.toStdString(), testing::HasSubstr("meets this bone"));
  EXPECT_EQ(document().paths().front().entry_mm, phantom_paths().front().entry_mm);
}

TEST_F(PlannerWindowTest, BrokenCtIsSaidInWordsAndTheOldBoneStays) {
  show_phantom();
  const std::filesystem::path ct = folder.path() / "ct";
  std::filesystem::create_directory(ct);
  std::ofstream(ct / "IM0001.dcm") << "no DICOM at all";
  answer_box(QMessageBox::Ok);
  window->open(ct);
  ASSERT_TRUE(wait_until([&] { return !box_text.isEmpty(); }));
  EXPECT_THAT(box_text.toStdString(), testing::HasSubstr("Opening ct"));
  EXPECT_EQ(document().bone(), phantom_bone());
  EXPECT_EQ(document().paths().size(), 2U);
}

TEST_F(PlannerWindowTest, FullDiskIsSaidInWordsAndTheOldPlanStays) {
  show_phantom();
  const std::filesystem::path file = folder.path() / "plan.json";
  planner().save_plan(file);
  document().remove_path(1);
  answer_box(QMessageBox::Ok);
  {
    const FullDisk disk(16);
    input.key("ctrl+s");
    ASSERT_TRUE(wait_until([&] { return !box_text.isEmpty(); }));
  }
  EXPECT_THAT(box_text.toStdString(), testing::HasSubstr("Cannot save the plan"));
  EXPECT_THAT(box_text.toStdString(), testing::HasSubstr("plan.json"));
  EXPECT_TRUE(planner().has_unsaved_changes());
  EXPECT_EQ(read_plan(file).size(), 2U);
}

TEST_F(PlannerWindowTest, TakesAPlanThatIsDroppedOnIt) {
  show_phantom(false);
  const std::filesystem::path file = folder.path() / "plan.json";
  write_plan(phantom_paths(), file);
  drop(file);
  EXPECT_TRUE(wait_until([&] { return document().paths().size() == 2; }));
}

TEST_F(PlannerWindowTest, ClosingAsksForWhatIsNotSaved) {
  show_phantom();
  document().remove_path(1);
  let_work(20);
  answer_box(QMessageBox::Cancel);
  window->close();
  EXPECT_THAT(box_text.toStdString(), testing::HasSubstr("not saved"));
  EXPECT_TRUE(window->isVisible());
  answer_box(QMessageBox::Discard);
  window->close();
  EXPECT_FALSE(window->isVisible());
}

TEST_F(PlannerWindowTest, ClosingDuringLongWorkAsksAndThenStopsIt) {
  std::atomic<bool> has_ended = false;
  planner().job().start("A bake", [&](const Progress& progress) -> std::function<void()> {
    try {
      for (;;) {
        progress.report("baking", 0.5);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
    } catch (const Cancelled&) {
      has_ended = true;
      throw;
    }
  });
  answer_box(QMessageBox::NoButton);
  window->close();
  EXPECT_THAT(box_text.toStdString(), testing::HasSubstr("A bake is still running"));
  window.reset();
  EXPECT_TRUE(has_ended);
}

}  // namespace
}  // namespace spinaltap::test
