// A CT in the window: its slices at once, then its vertebrae, then the bones that are asked for.
#include <gmock/gmock.h>

#include <QProgressBar>
#include <QPushButton>
#include <QTableWidget>
#include <QToolButton>
#include <algorithm>

#include "core/ct/dicom_write.h"
#include "core/files/plan_file.h"
#include "tests/gui/planner_window.h"

namespace spinaltap::test {
namespace {

constexpr int kLongMs = 300000;

class PlannerCt : public PlannerWindow {
 protected:
  CtLevels& levels() { return planner().levels(); }
  QTableWidget& list() { return child<QTableWidget>("levels"); }
  QString state_of(int row) { return list().item(row, 1)->text(); }
  QString shown() { return child<QLabel>("shown").text(); }
  void click_row(int row) {
    input.click(*list().viewport(), list().visualItemRect(list().item(row, 0)).center() + QPoint(10, 0));
  }
  /// Drops the phantom's spine onto the window and waits for its vertebrae.
  void drop_spine() {
    drop(spine_folder());
    ASSERT_TRUE(wait_until([&] { return levels().search() == CtLevels::Search::found; }, kLongMs));
    ASSERT_EQ(levels().levels().size(), 4U);
  }
  bool is_baked(int row) { return levels().levels()[static_cast<std::size_t>(row)].state == CtLevel::State::baked; }
  bool has_box() { return QApplication::activeModalWidget() != nullptr; }
  /// Whether a pane shows anything but its ground: greys of a CT.
  bool shows_slice(const char* name) {
    const QImage picture = slice(name).grab().toImage().convertToFormat(QImage::Format_RGB32);
    int greys = 0;
    for (int y = 0; y < picture.height(); y += 5) {
      for (int x = 0; x < picture.width(); x += 5) {
        const QRgb pixel = picture.pixel(x, y);
        greys += qRed(pixel) == qGreen(pixel) && qGreen(pixel) == qBlue(pixel) && qRed(pixel) > 60 ? 1 : 0;
      }
    }
    return greys > 500;
  }
  /// How many pixels of a pane have the colour of the n-th level's outline.
  int outline_pixels(const char* name, const QColor& colour) {
    const QImage picture = slice(name).grab().toImage().convertToFormat(QImage::Format_RGB32);
    int count = 0;
    for (int y = 0; y < picture.height(); ++y) {
      for (int x = 0; x < picture.width(); ++x) count += picture.pixel(x, y) == colour.rgb() ? 1 : 0;
    }
    return count;
  }
};

TEST_F(PlannerCt, ShowsItsSlicesBeforeAnyVertebraIsLookedFor) {
  EXPECT_FALSE(shows_slice("axial"));
  drop(spine_folder());
  ASSERT_TRUE(wait_until([&] { return document().opened() != nullptr; }, 60000));
  EXPECT_EQ(levels().search(), CtLevels::Search::running);
  EXPECT_EQ(document().bone(), nullptr);
  let_work(50);
  for (const char* name : {"axial", "coronal", "sagittal"}) EXPECT_TRUE(shows_slice(name)) << name;
  // They can be used while the search goes on.
  const Vec3 before = planner().view().crosshair_mm();
  input.move(slice("axial"), slice("axial").rect().center());
  input.wheel(2);
  EXPECT_TRUE(wait_until([&] { return planner().view().crosshair_mm() != before; }));
  EXPECT_TRUE(child<QProgressBar>("levelsProgress").isVisible());
  EXPECT_TRUE(child<QToolButton>("levelsCancel").isVisible());
  EXPECT_EQ(levels().search(), CtLevels::Search::running);
  EXPECT_THAT(shown().toStdString(), testing::AllOf(testing::HasSubstr("CT spine"), testing::HasSubstr("no vertebra")));
}

TEST_F(PlannerCt, OutlinesAndNamesItsVertebraeOnceTheyAreFound) {
  drop_spine();
  EXPECT_EQ(document().bone(), nullptr);  // there are four: the person chooses
  EXPECT_FALSE(planner().is_working());
  ASSERT_EQ(list().rowCount(), 4);
  EXPECT_TRUE(list().isVisible());
  QStringList names;
  for (int row = 0; row < 4; ++row) names += list().item(row, 0)->text();
  EXPECT_EQ(names, (QStringList{"T11", "T12", "L1", "L2"}));
  planner().view().set_crosshair(levels().levels()[1].report.body_centre_mm);
  const QColor second(0xE6, 0x9F, 0x00);
  EXPECT_GT(outline_pixels("sagittal", second), 50);
  input.key("ctrl+l");
  ASSERT_TRUE(wait_until([&] { return !planner().view().shows_levels(); }));
  EXPECT_LT(outline_pixels("sagittal", second), 5);
}

TEST_F(PlannerCt, AClickOnAVertebraBakesItWhileTheSlicesAreUsed) {
  drop_spine();
  click_row(1);
  ASSERT_TRUE(wait_until([&] { return levels().is_baking(); }));
  EXPECT_LT((planner().view().crosshair_mm() - levels().levels()[1].report.body_centre_mm).norm(), 1e-9);
  input.move(slice("axial"), slice("axial").rect().center());
  input.wheel(3);
  let_work(100);
  const Vec3 looked_at = planner().view().crosshair_mm();
  EXPECT_TRUE(child<QToolButton>("levelsCancel").isVisible());
  ASSERT_TRUE(wait_until([&] { return document().bone() != nullptr; }, kLongMs));
  EXPECT_EQ(document().bone(), levels().levels()[1].bone);
  EXPECT_EQ(document().bone()->volume, document().opened()->volume);
  EXPECT_EQ(planner().view().crosshair_mm(), looked_at);  // what the person looks at stays
  EXPECT_THAT(shown().toStdString(), testing::HasSubstr("T12"));
  EXPECT_FALSE(document().bone()->surface.empty());
  EXPECT_FALSE(has_box());

  // Another one is ready while the plan for the first is not saved: that stays until the person says so.
  planner().suggest();
  ASSERT_TRUE(wait_until([&] { return !planner().job().is_running(); }, kLongMs));
  ASSERT_FALSE(document().paths().empty());
  EXPECT_THAT(shown().toStdString(), testing::HasSubstr("NOT SAVED"));
  const QLabel& line = child<QLabel>("shown");
  EXPECT_GE(line.width(), line.sizeHint().width());
  EXPECT_TRUE(window->rect().contains(QRect(line.mapTo(window.get(), QPoint(0, 0)), line.size())));
  window->show_page("ct");
  let_work(50);
  click_row(2);
  ASSERT_TRUE(wait_until([&] { return is_baked(2); }, kLongMs));
  EXPECT_EQ(document().bone(), levels().levels()[1].bone);
  EXPECT_FALSE(document().paths().empty());
  answer_box(QMessageBox::Cancel);
  click_row(2);
  ASSERT_TRUE(wait_until([&] { return !box_text.isEmpty() && !has_box(); }));
  EXPECT_EQ(document().bone(), levels().levels()[1].bone);
  take_keyboard_back();
  answer_box(QMessageBox::Discard);
  click_row(2);
  ASSERT_TRUE(wait_until([&] { return document().bone() == levels().levels()[2].bone; }));
  EXPECT_THAT(shown().toStdString(), testing::HasSubstr("L1"));
}

TEST_F(PlannerCt, AllAreBakedAndTheFirstIsShown) {
  drop_spine();
  input.click(child<QPushButton>("bakeAll"));
  ASSERT_TRUE(wait_until([&] { return document().bone() != nullptr; }, kLongMs));
  EXPECT_TRUE(levels().is_baking());
  EXPECT_EQ(document().bone(), levels().levels()[0].bone);
  ASSERT_TRUE(wait_until([&] { return !planner().is_working(); }, 2 * kLongMs));
  for (int row = 0; row < 4; ++row) EXPECT_TRUE(is_baked(row)) << row;
  EXPECT_EQ(document().bone(), levels().levels()[0].bone);
  window->show_page("ct");
  let_work(50);
  click_row(3);
  EXPECT_TRUE(wait_until([&] { return document().bone() == levels().levels()[3].bone; }));
}

TEST_F(PlannerCt, SearchAndBakesCanBeCancelled) {
  drop(spine_folder());
  ASSERT_TRUE(wait_until([&] { return child<QToolButton>("levelsCancel").isVisible(); }, 60000));
  let_work(100);  // it is laid out
  input.click(child<QToolButton>("levelsCancel"));
  ASSERT_TRUE(wait_until([&] { return !planner().is_working(); }, 60000));
  EXPECT_EQ(levels().search(), CtLevels::Search::cancelled);
  EXPECT_TRUE(shows_slice("axial"));
  EXPECT_FALSE(has_box());
  input.click(child<QPushButton>("findLevels"));
  ASSERT_TRUE(wait_until([&] { return levels().search() == CtLevels::Search::found; }, kLongMs));

  click_row(0);
  click_row(1);
  EXPECT_EQ(state_of(1), "waits");
  input.click(child<QToolButton>("levelsCancel"));
  ASSERT_TRUE(wait_until([&] { return !planner().is_working(); }, 60000));
  EXPECT_FALSE(is_baked(0));
  EXPECT_FALSE(is_baked(1));
  EXPECT_EQ(document().bone(), nullptr);
  EXPECT_FALSE(child<QToolButton>("levelsCancel").isVisible());
}

TEST_F(PlannerCt, WithoutASpineItStaysAndSaysWhy) {
  GridGeometry geometry;
  geometry.size = {60, 60, 30};
  geometry.spacing_mm = Vec3(1.0, 1.0, 2.0);
  std::vector<std::int16_t> hu(geometry.voxel_count(), 40);
  for (int k = 10; k < 20; ++k) {
    for (int i = 20; i < 40; ++i) hu[geometry.offset(i, 30, k)] = 700;
  }
  const std::filesystem::path ct = folder.path() / "ct";
  std::filesystem::create_directory(ct);
  write_dicom(make_ct_volume(geometry, std::move(hu)), ct);
  answer_box(QMessageBox::Ok);
  drop(ct);
  ASSERT_TRUE(wait_until([&] { return !box_text.isEmpty() && !has_box(); }, 60000));
  EXPECT_THAT(box_text.toStdString(), testing::HasSubstr("No vertebra was found"));
  EXPECT_NE(document().opened(), nullptr);
  EXPECT_TRUE(shows_slice("axial"));
  EXPECT_THAT(child<QLabel>("levelsWords").text().toStdString(),
              testing::AllOf(testing::HasSubstr("No vertebra was found"), testing::HasSubstr("Ctrl+B")));
}

TEST_F(PlannerCt, AnotherThatIsDroppedMeanwhileTakesItsPlace) {
  const std::filesystem::path other = folder.path() / "other";
  std::filesystem::copy(spine_folder(), other);
  // While the first is read.
  drop(spine_folder());
  ASSERT_TRUE(wait_until([&] { return planner().job().is_running() || document().opened(); }, 60000));
  drop(other);
  ASSERT_TRUE(wait_until([&] { return document().opened() && document().opened()->file == other; }, 60000));
  // While the vertebrae are looked for.
  drop(spine_folder());
  ASSERT_TRUE(wait_until([&] { return document().opened()->file == spine_folder(); }, 60000));
  ASSERT_TRUE(wait_until([&] { return levels().search() == CtLevels::Search::found; }, kLongMs));
  // While one is baked.
  click_row(2);
  ASSERT_TRUE(wait_until([&] { return levels().is_baking(); }));
  drop(other);
  ASSERT_TRUE(wait_until([&] { return document().opened()->file == other; }, 60000));
  EXPECT_EQ(document().levels(), nullptr);
  ASSERT_TRUE(wait_until([&] { return levels().search() == CtLevels::Search::found; }, kLongMs));
  EXPECT_EQ(document().bone(), nullptr);
  EXPECT_FALSE(has_box());
  // A file that is none leaves what is there.
  const std::filesystem::path broken = folder.path() / "broken";
  std::filesystem::create_directory(broken);
  answer_box(QMessageBox::Ok);
  drop(broken);
  ASSERT_TRUE(wait_until([&] { return !box_text.isEmpty() && !has_box(); }, 60000));
  EXPECT_EQ(document().opened()->file, other);
  EXPECT_EQ(list().rowCount(), 4);
}

TEST_F(PlannerCt, AnUnsavedPlanStaysUntilThePersonSaysSo) {
  show_phantom();
  document().remove_path(1);
  answer_box(QMessageBox::Cancel);
  drop(spine_folder());
  ASSERT_TRUE(wait_until([&] { return !box_text.isEmpty() && !has_box(); }));
  EXPECT_FALSE(planner().is_working());
  EXPECT_EQ(document().bone(), phantom_bone());
  EXPECT_EQ(document().paths().size(), 1U);
}

TEST_F(PlannerCt, APlanForItHasTheVertebraBakedThatItIsFor) {
  drop_spine();
  const LevelReport& t12 = levels().levels()[1].report;
  DrillPath path;
  path.name = "through the body";
  path.target_mm = t12.body_centre_mm - Vec3(0.0, 6.0, 0.0);
  path.entry_mm = t12.body_centre_mm + Vec3(14.0, 32.0, 2.0);
  const std::filesystem::path plan = folder.path() / "plan.json";
  write_plan({path}, plan);
  drop(spine_folder());
  ASSERT_TRUE(wait_until([&] { return levels().search() == CtLevels::Search::running; }, 60000));
  answer_box(QMessageBox::Open);  // it does not begin on the surface
  drop(plan);
  ASSERT_TRUE(wait_until([&] { return document().paths().size() == 1; }, kLongMs));
  EXPECT_EQ(document().bone(), levels().levels()[1].bone);
  EXPECT_THAT(shown().toStdString(), testing::AllOf(testing::HasSubstr("T12"), testing::HasSubstr("plan.json, saved")));
}

}  // namespace
}  // namespace spinaltap::test
