// Keys that work on every page, and what the window says.
#include <gmock/gmock.h>

#include <QDoubleSpinBox>
#include <QInputDialog>
#include <QProgressBar>
#include <QStatusBar>
#include <QTabWidget>
#include <QToolButton>
#include <algorithm>
#include <atomic>
#include <thread>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/ct/dicom_write.h"
#include "core/files/data_files.h"
#include "core/files/screw_file.h"
#include "tests/gui/planner_window.h"

namespace spinaltap::test {
namespace {

using PlannerKeys = PlannerWindow;

TEST_F(PlannerKeys, DrillingKeysWorkOnEveryPage) {
  show_phantom();
  const DrillPlayer& player = planner().player();
  for (const char* page : {"plan", "path"}) {
    window->show_page(page);
    input.key("F6");
    ASSERT_TRUE(wait_until([&] { return player.seconds() > 1.2; }, 120000)) << page;
    input.key("F7");
    ASSERT_TRUE(wait_until([&] { return player.state() == DrillPlayer::State::stopped; })) << page;
    const double stopped_s = player.seconds();
    input.key("F8");
    ASSERT_TRUE(
        wait_until([&] { return player.state() == DrillPlayer::State::stopped && player.seconds() < stopped_s; }));
    input.key("F9");
    ASSERT_TRUE(wait_until([&] { return !player.can_undo_hole() && player.can_redo_hole(); })) << page;
  }
  // Where numbers are typed, too.
  window->show_page("plan");
  child<QDoubleSpinBox>("targetS").setFocus(Qt::TabFocusReason);
  input.key("F6");
  ASSERT_TRUE(wait_until([&] { return player.state() == DrillPlayer::State::drilling; }, 120000));
  input.key("F7");
  EXPECT_TRUE(wait_until([&] { return player.state() == DrillPlayer::State::stopped; }));
}

TEST_F(PlannerKeys, F1IsHelpAndDeleteRemovesTheChosenPath) {
  show_phantom();
  QString name;
  in_the_next_dialog([&] {
    name = QApplication::activeModalWidget()->objectName();
    input.key("Escape");
  });
  input.key("F1");
  EXPECT_TRUE(wait_until([&] { return name == "keys"; }));
  take_keyboard_back();

  slice("axial").setFocus();
  input.key("Delete");
  EXPECT_EQ(document().paths().size(), 1U);
  EXPECT_EQ(document().paths().front().name, "right");
  // Where a number is typed it is the number's.
  auto& box = child<QDoubleSpinBox>("targetS");
  box.setFocus(Qt::TabFocusReason);
  input.key("Delete");
  EXPECT_EQ(document().paths().size(), 1U);
}

TEST_F(PlannerKeys, ChoosingAPathBringsTheSlicesToIt) {
  show_phantom();
  planner().view().set_crosshair(document().paths()[0].entry_mm);
  input.key("ctrl+e");
  EXPECT_EQ(document().chosen(), 1);
  EXPECT_EQ(planner().view().crosshair_mm(), document().paths()[1].entry_mm);
  // Where the slices show the path already they stay.
  const DrillPath& left = document().paths()[0];
  const Vec3 middle_mm = 0.5 * (left.entry_mm + left.target_mm);
  planner().view().set_crosshair(middle_mm);
  input.key("ctrl+e");
  EXPECT_EQ(document().chosen(), 0);
  EXPECT_EQ(planner().view().crosshair_mm(), middle_mm);
}

TEST_F(PlannerKeys, SaysWhereAScrewIsLongerOrShorterThanItsPath) {
  show_phantom();
  const auto warnings = [&](double screw_mm) {
    DrillPath path = phantom_paths().front();
    path.screw = read_screws(data_file("screws/pedicle.json")).front();
    path.screw->length_mm = screw_mm;
    document().change_path(0, path, "screw");
    let_work(100);
    return child<QLabel>("warnings").text().toStdString();
  };
  const double path_mm = phantom_paths().front().length_mm();
  EXPECT_THAT(warnings(path_mm + 7.5), testing::HasSubstr("the screw is 7.5 mm longer than the path"));
  EXPECT_THAT(warnings(path_mm - 4.0), testing::HasSubstr("the screw is 4.0 mm shorter than the path"));
  EXPECT_THAT(warnings(path_mm), testing::Not(testing::HasSubstr("than the path")));
}

TEST_F(PlannerKeys, StatusAndProgressAreVisibleOnASmallScreen) {
  show_phantom();
  window->resize(1024, 700);
  planner().view().set_hovered(document().paths()[0].entry_mm);
  std::atomic<bool> ends = false;
  planner().job().start(QString("Opening %1").arg(QString(80, 'x')), [&](const Progress& progress) {
    while (!ends) {
      progress.report("fitting the function to the surface points", 0.5);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return std::function<void()>();
  });
  const QString said = "Saved a plan";
  window->statusBar()->showMessage(said);
  ASSERT_TRUE(wait_until([&] { return child<QProgressBar>("progress").value() == 50; }));
  let_work(100);
  EXPECT_EQ(window->width(), 1024);
  for (const char* name : {"working", "progress", "cancel", "hover"}) {
    const auto& part = child<QWidget>(name);
    const QRect place(part.mapTo(window.get(), QPoint(0, 0)), part.size());
    EXPECT_TRUE(part.isVisible()) << name;
    EXPECT_TRUE(window->rect().contains(place)) << name;
    EXPECT_GE(place.width(), part.minimumSizeHint().width()) << name;
  }
  // The message has the room to the left of them.
  const int room = child<QWidget>("working").mapTo(window.get(), QPoint(0, 0)).x();
  EXPECT_GE(room, window->fontMetrics().horizontalAdvance(said));
  EXPECT_EQ(window->statusBar()->currentMessage(), said);
  ends = true;
  ASSERT_TRUE(wait_until([&] { return !planner().job().is_running(); }));
}

/// A block of bone in soft tissue: a CT without a vertebra.
CtVolume made_block(std::int16_t bone_hu) {
  GridGeometry geometry;
  geometry.size = {24, 20, 12};
  geometry.spacing_mm = Vec3(0.8, 0.8, 2.0);
  std::vector<std::int16_t> hu(geometry.voxel_count(), 40);
  for (int k = 4; k < 8; ++k) {
    for (int i = 8; i < 16; ++i) hu[geometry.offset(i, 10, k)] = bone_hu;
  }
  return make_ct_volume(geometry, std::move(hu));
}

TEST_F(PlannerKeys, ACtWithoutAVertebraIsShownSoThatASeedCanBeSet) {
  const std::filesystem::path ct = folder.path() / "ct";
  std::filesystem::create_directory(ct);
  write_dicom(made_block(700), ct);
  answer_box(QMessageBox::Ok);
  window->open(ct);
  ASSERT_TRUE(wait_until([&] { return !box_text.isEmpty(); }, 60000));
  EXPECT_THAT(box_text.toStdString(), testing::AllOf(testing::HasSubstr("No vertebra was found"),
                                                     testing::HasSubstr("crosshair"), testing::HasSubstr("Ctrl+B")));
  ASSERT_EQ(document().bone(), nullptr);
  ASSERT_NE(document().opened(), nullptr);
  SliceView& axial = slice("axial");
  let_work(100);
  input.move(axial, axial.rect().center());
  EXPECT_TRUE(wait_until([&] { return status().contains(" HU"); }));
  // A seed that is in no body is said, and the CT stays.
  take_keyboard_back();
  answer_box(QMessageBox::Ok);
  input.key("ctrl+b");
  ASSERT_TRUE(wait_until([&] { return !box_text.isEmpty() && !planner().job().is_running(); }, 60000));
  EXPECT_NE(document().opened(), nullptr);
}

TEST_F(PlannerKeys, OneOfSeveralSeriesCanBeChosen) {
  const std::filesystem::path ct = folder.path() / "ct";
  for (const char* name : {"a", "b"}) {
    std::filesystem::create_directories(ct / name);
    write_dicom(made_block(*name == 'a' ? 700 : 900), ct / name);
  }
  QStringList offered;
  in_the_next_dialog([&] {
    auto* box = qobject_cast<QInputDialog*>(QApplication::activeModalWidget());
    if (box == nullptr) return;
    offered = box->comboBoxItems();
    box->setTextValue(offered.back());
    answer_box(QMessageBox::Ok);  // there is no vertebra in it
    box->accept();
  });
  window->open(ct);
  ASSERT_TRUE(wait_until([&] { return document().opened() != nullptr; }, 60000));
  EXPECT_EQ(offered.size(), 2);
  for (const QString& name : offered) {
    EXPECT_THAT(name.toStdString(), testing::AllOf(testing::HasSubstr("CT, 24 x 20"), testing::HasSubstr("axial")));
    EXPECT_THAT(name.toStdString(), testing::Not(testing::HasSubstr("1.2.")));  // no UID
  }
  EXPECT_EQ(document().opened()->options.reading.series, "2");
  ASSERT_TRUE(wait_until([&] { return !box_text.isEmpty(); }));
}

TEST_F(PlannerKeys, GapsCanBeInterpolatedWhichTheWindowSaysWithoutFlags) {
  const std::filesystem::path ct = folder.path() / "ct";
  std::filesystem::create_directory(ct);
  write_dicom(made_block(700), ct);
  std::filesystem::remove(ct / "0006.dcm");
  QString said;
  in_the_next_dialog([&] {
    auto* box = qobject_cast<QMessageBox*>(QApplication::activeModalWidget());
    if (box == nullptr) return;
    said = box->text() + box->informativeText();
    answer_box(QMessageBox::Ok);  // there is no vertebra in it
    box->button(QMessageBox::Yes)->click();
  });
  window->open(ct);
  ASSERT_TRUE(wait_until([&] { return document().opened() != nullptr; }, 60000));
  EXPECT_THAT(said.toStdString(), testing::AllOf(testing::HasSubstr("a slice is missing"),
                                                 testing::Not(testing::HasSubstr("CtReadOptions")),
                                                 testing::Not(testing::HasSubstr("--"))));
  EXPECT_TRUE(document().opened()->options.reading.resample);
  EXPECT_EQ(document().opened()->ct.geometry.size[2], 12);
  ASSERT_TRUE(wait_until([&] { return !box_text.isEmpty(); }));
}

TEST_F(PlannerKeys, ABrokenPlanIsSaidInWords) {
  show_phantom();
  const std::filesystem::path file = folder.path() / "plan.json";
  write_whole_file(file, "{\"format\": nonsense}");
  answer_box(QMessageBox::Ok);
  window->open(file);
  EXPECT_THAT(box_text.toStdString(),
              testing::AllOf(testing::HasSubstr("line 1, column 13"), testing::Not(testing::HasSubstr("exception")),
                             testing::Not(testing::HasSubstr("["))));
}

}  // namespace
}  // namespace spinaltap::test
