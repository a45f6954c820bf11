#include <gmock/gmock.h>

#include <QAction>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QMenuBar>
#include <QTabWidget>
#include <QTableWidget>
#include <map>
#include <vector>

#include "apps/spinaltap-planner/scene/scene_view.h"
#include "core/phantom/vertebra_ground_truth.h"
#include "core/session/record/session_record.h"
#include "tests/gui/planner_window.h"

namespace spinaltap::test {
namespace {

constexpr double kSurfaceMm = 0.03;  ///< of a bone baked at 0.4 mm against the phantom's formula

double phantom_distance_mm(const Vec3& p_mm) {
  double distance_mm = 0.0;
  Vertebra().evaluate({&p_mm, 1}, {&distance_mm, 1}, {});
  return distance_mm;
}

using PlannerWindowTest = PlannerWindow;

TEST_F(PlannerWindowTest, OpensABoneThroughItsDialog) {
  in_the_next_dialog([&] {
    input.type(text_of(phantom_file().string()));
    input.key("Return");
  });
  input.key("ctrl+o");
  ASSERT_TRUE(wait_until([&] { return document().bone() != nullptr; }, 60000));
  EXPECT_EQ(document().bone()->file, phantom_file());
  EXPECT_TRUE(document().paths().empty());
  EXPECT_TRUE(child<QAction>("suggest").isEnabled());
}

TEST_F(PlannerWindowTest, TheWheelTurnsNoNumberThatHasNotTheKeyboard) {
  show_phantom();
  const DrillPath before = *document().chosen_path();
  child<QTableWidget>("paths").setFocus();
  std::vector<QWidget*> fields{&child<QComboBox>("bit"), &child<QComboBox>("screw")};
  for (const char* name : {"bitDiameter", "bitLength", "entryL", "entryP", "entryS", "targetL", "targetP", "targetS"}) {
    fields.push_back(&child<QDoubleSpinBox>(name));
  }
  for (QWidget* field : fields) {
    for (const int steps : {3, -3}) {
      input.move(*field, field->rect().center());
      input.wheel(steps);
      let_work(30);
      const DrillPath& after = *document().chosen_path();
      EXPECT_EQ(after.entry_mm, before.entry_mm) << field->objectName().toStdString();
      EXPECT_EQ(after.target_mm, before.target_mm) << field->objectName().toStdString();
      EXPECT_EQ(after.bit.diameter_mm, before.bit.diameter_mm) << field->objectName().toStdString();
      EXPECT_EQ(after.bit.length_mm, before.bit.length_mm) << field->objectName().toStdString();
      EXPECT_EQ(after.screw.has_value(), before.screw.has_value()) << field->objectName().toStdString();
      EXPECT_FALSE(field->hasFocus()) << field->objectName().toStdString();
    }
  }
  // With the keyboard it turns.
  auto& box = child<QDoubleSpinBox>("targetS");
  input.click(box);
  ASSERT_TRUE(wait_until([&] { return box.hasFocus(); }));
  input.wheel(1);
  EXPECT_TRUE(wait_until([&] { return document().chosen_path()->target_mm != before.target_mm; }));
}

TEST_F(PlannerWindowTest, EveryKeyMeansOneThing) {
  std::map<QString, QStringList> meanings;  // of keys, whichever page is shown
  const auto add = [&](const QKeySequence& keys, const QString& what) {
    if (!keys.isEmpty()) meanings[keys.toString()] += what;
  };
  for (const QAction* action : window->findChildren<QAction*>()) {
    for (const QKeySequence& keys : action->shortcuts()) add(keys, action->text());
  }
  for (const QAction* menu : window->menuBar()->actions()) add(QKeySequence::mnemonic(menu->text()), menu->text());
  for (const QAbstractButton* button : window->findChildren<QAbstractButton*>())
    add(button->shortcut(), button->text());
  for (const QLabel* label : window->findChildren<QLabel*>()) {
    if (label->buddy() != nullptr) add(QKeySequence::mnemonic(label->text()), label->text());
  }
  const auto& pages = child<QTabWidget>("pages");
  for (int n = 0; n < pages.count(); ++n) add(QKeySequence::mnemonic(pages.tabText(n)), pages.tabText(n));
  EXPECT_GT(meanings.size(), 40U);
  for (const auto& [keys, what] : meanings) {
    EXPECT_EQ(what.size(), 1) << keys.toStdString() << ": " << what.join(", ").toStdString();
  }
}

TEST_F(PlannerWindowTest, WheelScrollsAndTheOtherPanesFollow) {
  show_phantom();
  SliceView& axial = slice("axial");
  const Vec3 before = planner().view().crosshair_mm();
  input.move(axial, axial.rect().center());
  input.wheel(3);
  const double step_mm = document().bone()->ct.geometry.spacing_mm.z();
  EXPECT_NEAR(std::abs(planner().view().crosshair_mm().z() - before.z()), 3.0 * step_mm, 1e-6);
  // The crosshair of the coronal pane lies on the height that the axial one shows.
  EXPECT_NEAR(slice("coronal").frame().to_pixel(planner().view().crosshair_mm()).z(), 0.0, 1e-6);
  input.wheel(-3);
  EXPECT_NEAR(planner().view().crosshair_mm().z(), before.z(), 1e-6);
}

TEST_F(PlannerWindowTest, LeftButtonMovesTheCrosshairThereAndSaysTheHuUnderThePointer) {
  show_phantom();
  SliceView& sagittal = slice("sagittal");
  const Vec3 body_mm = phantom_bone()->landmarks()->body.centre_mm;
  planner().view().set_crosshair(body_mm + Vec3(0.0, 6.0, 4.0));
  input.click(sagittal, pixel_of(sagittal, body_mm));
  const Vec3 seen = planner().view().crosshair_mm();
  EXPECT_NEAR(seen.y(), body_mm.y(), mm_per_pixel(sagittal));
  EXPECT_NEAR(seen.z(), body_mm.z(), mm_per_pixel(sagittal));
  EXPECT_THAT(status().toStdString(), testing::HasSubstr(" HU"));
}

TEST_F(PlannerWindowTest, RightButtonChangesTheWindow) {
  show_phantom();
  SliceView& coronal = slice("coronal");
  const HuWindow before = planner().view().window();
  const QPoint middle = coronal.rect().center();
  input.drag(coronal, middle, middle + QPoint(60, 0), MouseButton::right);
  EXPECT_GT(planner().view().window().width_hu, before.width_hu);
  EXPECT_NEAR(planner().view().window().level_hu, before.level_hu, 1.0);
  input.drag(coronal, middle, middle + QPoint(0, 40), MouseButton::right);
  EXPECT_NE(planner().view().window().level_hu, before.level_hu);
}

TEST_F(PlannerWindowTest, BothEndsAreDraggedOnASliceEachAsOneStepBack) {
  show_phantom();
  SliceView& axial = slice("axial");
  const DrillPath before = *document().chosen_path();
  const QPoint target = pixel_of(axial, before.target_mm);
  input.drag(axial, target, target + QPoint(12, -9));
  const double pixel_mm = mm_per_pixel(axial);
  const Vec3 moved = document().chosen_path()->target_mm - before.target_mm;
  EXPECT_NEAR(moved.x(), 12.0 * pixel_mm, pixel_mm);
  EXPECT_NEAR(moved.y(), -9.0 * pixel_mm, pixel_mm);
  EXPECT_NEAR(moved.z(), 0.0, 1e-9);

  const QPoint entry = pixel_of(axial, before.entry_mm);
  input.drag(axial, entry, entry + QPoint(14, 5));
  EXPECT_GT((document().chosen_path()->entry_mm - before.entry_mm).norm(), 5.0 * pixel_mm);
  EXPECT_NEAR(phantom_distance_mm(document().chosen_path()->entry_mm), 0.0, kSurfaceMm);

  EXPECT_EQ(document().undo_stack().count(), 2);
  EXPECT_TRUE(window->isWindowModified());
  input.key("ctrl+z");
  input.key("ctrl+z");
  EXPECT_EQ(document().chosen_path()->entry_mm, before.entry_mm);
  EXPECT_EQ(document().chosen_path()->target_mm, before.target_mm);
  EXPECT_FALSE(window->isWindowModified());
}

TEST_F(PlannerWindowTest, BothEndsAreDraggedIn3D) {
  show_phantom();
  SceneView& scene = window->panes().scene();
  scene.look_from("behind");
  let_work(300);
  const DrillPath before = *document().chosen_path();
  const QPoint entry = scene.to_pixel(before.entry_mm).toPoint();
  input.drag(scene, entry, entry + QPoint(0, 18));
  let_work(200);
  const Vec3 moved = document().chosen_path()->entry_mm;
  EXPECT_LT(moved.z(), before.entry_mm.z() - 1.0);  // down, seen from behind
  EXPECT_NEAR(phantom_distance_mm(moved), 0.0, kSurfaceMm);
  EXPECT_LT((scene.to_pixel(moved).toPoint() - entry - QPoint(0, 18)).manhattanLength(), 6);

  const QPoint target = scene.to_pixel(before.target_mm).toPoint();
  input.drag(scene, target, target + QPoint(20, 0));
  let_work(200);
  const Vec3 way = document().chosen_path()->target_mm - before.target_mm;
  EXPECT_LT(std::abs(way.y()), 1e-6);  // in the plane that faces the eye
  EXPECT_LT((scene.to_pixel(document().chosen_path()->target_mm).toPoint() - target - QPoint(20, 0)).manhattanLength(),
            3);
  EXPECT_EQ(document().undo_stack().count(), 2);
}

TEST_F(PlannerWindowTest, SuggestsPathsThatAreOfGradeA) {
  show_phantom(false);
  input.key("ctrl+g");
  ASSERT_TRUE(wait_until([&] { return document().paths().size() == 2; }, 60000));
  EXPECT_EQ(child<QTableWidget>("paths").rowCount(), 2);
  for (int index = 0; index < 2; ++index) {
    document().choose(index);
    let_work(50);
    EXPECT_EQ(planner().figures().value().graded.grade.grade, Grade::A);
    EXPECT_THAT(child<QLabel>("grade").text().toStdString(), testing::HasSubstr("A: no breach"));
  }
  input.key("ctrl+z");
  EXPECT_TRUE(document().paths().empty());
}

TEST_F(PlannerWindowTest, WarnsInWordsWhenAPathBreachesTheCanal) {
  show_phantom();
  const Landmarks& landmarks = *phantom_bone()->landmarks();
  ASSERT_TRUE(document().move_end(0, PathEnd::target, landmarks.origin_mm));
  let_work(50);
  EXPECT_THAT(child<QLabel>("warnings").text().toStdString(), testing::HasSubstr("breaches the canal by"));
}

TEST_F(PlannerWindowTest, TellsBesideTheGradeWhatStandsOutAndWhyThePathWasSuggested) {
  show_phantom(false);
  input.key("ctrl+g");
  ASSERT_TRUE(wait_until([&] { return document().paths().size() == 2; }, 60000));
  let_work(100);
  const auto text = [&](const char* name) { return child<QLabel>(name).text().toStdString(); };
  const PathFigures suggested = planner().figures().value();
  ASSERT_FALSE(suggested.reasons.empty());
  EXPECT_THAT(text("reasons"), testing::HasSubstr("technique: pedicle"));
  for (const std::string& reason : suggested.reasons) EXPECT_THAT(text("reasons"), testing::HasSubstr(reason));
  EXPECT_THAT(text("walls"), testing::AllOf(testing::HasSubstr("Heary I,"), testing::HasSubstr("facet (Babu) 0"),
                                            testing::HasSubstr("way in free"), testing::HasSubstr("head ")));
  for (const Finding& finding : suggested.graded.grade.findings) {
    EXPECT_THAT(text("warnings"), testing::HasSubstr(finding.words));
  }
}

TEST_F(PlannerWindowTest, NumbersAndToolsAreSetByTheKeyboardAlone) {
  show_phantom();
  auto& screw = child<QComboBox>("screw");
  screw.setFocus(Qt::TabFocusReason);
  let_work(20);
  input.key("Down");
  ASSERT_TRUE(document().chosen_path()->screw.has_value());
  auto& box = child<QDoubleSpinBox>("targetS");
  const Vec3 before = document().chosen_path()->target_mm;
  box.setFocus(Qt::TabFocusReason);
  let_work(20);
  input.key("Up");
  let_work(50);
  EXPECT_NEAR(document().chosen_path()->target_mm.z(), before.z() + 0.1, 0.006);
  EXPECT_EQ(document().chosen_path()->target_mm.head<2>(), before.head<2>());  // to the last bit
  input.key("ctrl+z");
  EXPECT_EQ(document().chosen_path()->target_mm, before);
}

TEST_F(PlannerWindowTest, APathIsRenamedByTypingAndNeverLikeAnother) {
  show_phantom();
  const std::string other = document().paths()[1].name;
  child<QTableWidget>("paths").setFocus(Qt::TabFocusReason);
  let_work(20);
  input.type(text_of(other));
  input.key("Return");
  EXPECT_TRUE(wait_until([&] { return document().paths()[0].name == other + " 2"; }));
  input.key("ctrl+z");
  EXPECT_TRUE(wait_until([&] { return document().paths()[0].name == phantom_paths()[0].name; }));
}

TEST_F(PlannerWindowTest, DrillsUndoesTheHoleAndSavesTheRecord) {
  show_phantom();
  const DrillPlayer& player = planner().player();
  input.key("alt+r");  // the page
  input.key("alt+s");  // the speed
  input.key("End");    // as fast as it goes
  EXPECT_EQ(child<QComboBox>("drill_speed").currentData().toDouble(), 0.0);
  input.key("F6");
  ASSERT_TRUE(wait_until([&] { return player.state() == DrillPlayer::State::stopped; }, 120000));
  const std::size_t removed = player.removed();
  EXPECT_GT(removed, 100000U);
  const std::filesystem::path record = folder.path() / "drilling.h5";
  in_the_next_dialog([&] {
    input.key("ctrl+a");
    input.type(text_of(record.string()));
    input.key("Return");
  });
  input.click(child<QAbstractButton>("drill_save_record"));
  ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(record) && !planner().job().is_running(); }, 60000));
  EXPECT_EQ(read_record(record).cycles.size(), player.done()->inputs.size());
  input.click(child<QAbstractButton>("drill_undo_hole"));
  EXPECT_TRUE(wait_until([&] { return player.removed() == 0 && !player.can_undo_hole(); }));
  input.key("shift+F9");
  EXPECT_TRUE(wait_until([&] { return player.removed() == removed && player.can_undo_hole(); }));
}

TEST_F(PlannerWindowTest, StopsStepsBackAndGoesOnByKeys) {
  show_phantom();
  const DrillPlayer& player = planner().player();
  input.key("alt+r");
  input.key("F6");
  ASSERT_TRUE(wait_until([&] { return player.seconds() > 1.5; }, 120000));
  input.key("F7");
  ASSERT_TRUE(wait_until([&] { return player.state() == DrillPlayer::State::stopped; }));
  const double stopped_s = player.seconds();
  input.key("F8");
  ASSERT_TRUE(
      wait_until([&] { return player.state() == DrillPlayer::State::stopped && player.seconds() < stopped_s; }));
  EXPECT_NEAR(player.seconds(), stopped_s - 1.0, 0.01);
  input.key("F7");
  EXPECT_TRUE(wait_until([&] { return player.seconds() > stopped_s; }));
  input.key("F7");
  EXPECT_TRUE(wait_until([&] { return player.state() == DrillPlayer::State::stopped; }));
}

TEST_F(PlannerWindowTest, IsReadableOnASmallScreen) {
  show_phantom();
  window->resize(1024, 700);
  let_work(100);
  EXPECT_LE(window->minimumSizeHint().width(), 1024);
  EXPECT_LE(window->minimumSizeHint().height(), 700);
  for (const char* name : {"axial", "coronal", "sagittal", "3d"}) {
    EXPECT_GE(window->panes().pane(name)->width(), 250) << name;
  }
}

}  // namespace
}  // namespace spinaltap::test
