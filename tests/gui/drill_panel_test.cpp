#include "apps/spinaltap-planner/drill/drill_panel.h"

#include <gmock/gmock.h>

#include <QAction>
#include <QComboBox>
#include <QCoreApplication>
#include <QElapsedTimer>
#include <QLabel>
#include <QListWidget>
#include <QRegularExpression>
#include <QToolButton>
#include <limits>
#include <stdexcept>

#include "apps/spinaltap-planner/drill/drill_figures_view.h"
#include "tests/gui/phantom_bone.h"

namespace spinaltap {
namespace {

class DrillPanelTest : public ::testing::Test {
 protected:
  template <class Widget>
  Widget& find(const char* name) {
    auto* widget = panel_.findChild<Widget*>(QString::fromLatin1(name));
    if (widget == nullptr) throw std::runtime_error(std::string("no widget ") + name);
    return *widget;
  }
  QToolButton& button(const char* name) { return find<QToolButton>(name); }
  std::string text(const char* name) { return find<QLabel>(name).text().toStdString(); }
  void choose(const char* name, const QVariant& value) {
    auto& box = find<QComboBox>(name);
    box.setCurrentIndex(box.findData(value));
  }
  bool wait_for(DrillPlayer::State state) {
    QElapsedTimer clock;
    clock.start();
    while (player_.state() != state && clock.elapsed() < 30'000) {
      QCoreApplication::processEvents(QEventLoop::AllEvents, 10);
    }
    return player_.state() == state;
  }

  PlanDocument document_;
  DrillPlayer player_{document_};
  DrillPanel panel_{document_, player_};
};

TEST_F(DrillPanelTest, OffersOnlyWhatMakesSense) {
  const auto enabled = [&] {
    std::string names;
    for (const char* name : {"drill_start", "drill_go_on", "drill_back", "drill_undo_hole", "drill_redo_hole",
                             "drill_save_record", "drill_write_report"}) {
      if (button(name).isEnabled()) names += std::string(names.empty() ? "" : " ") + (name + 6);
    }
    return names;
  };
  EXPECT_EQ(enabled(), "");
  document_.set_bone(test::phantom_bone());
  EXPECT_EQ(enabled(), "");
  document_.set_paths(test::phantom_paths());
  EXPECT_EQ(enabled(), "start");
  choose("drill_speed", 4.0);
  button("drill_start").click();
  EXPECT_EQ(enabled(), "go_on");
  EXPECT_EQ(button("drill_go_on").text(), "Stop");
  ASSERT_TRUE(wait_for(DrillPlayer::State::drilling));
  EXPECT_EQ(button("drill_go_on").text(), "Stop");
  while (player_.seconds() < 1.0) QCoreApplication::processEvents(QEventLoop::AllEvents, 10);
  EXPECT_EQ(enabled(), "go_on back");
  button("drill_go_on").click();
  EXPECT_EQ(enabled(), "start go_on back undo_hole save_record write_report");
  EXPECT_EQ(button("drill_go_on").text(), "Go on");
  EXPECT_EQ(button("drill_go_on").defaultAction()->shortcut(), QKeySequence("F7"));
  choose("drill_speed", 0.0);
  button("drill_go_on").click();
  ASSERT_TRUE(wait_for(DrillPlayer::State::stopped));
  EXPECT_EQ(enabled(), "start back undo_hole save_record write_report");
  button("drill_undo_hole").click();
  EXPECT_EQ(enabled(), "start redo_hole");
}

TEST_F(DrillPanelTest, ShowsWhatIsDrilledWhoeverAskedForIt) {
  document_.set_bone(test::phantom_bone());
  document_.set_paths(test::phantom_paths());
  player_.start({.tool_operator = "tremor", .feed_mm_s = 3.0, .stops_on_breach = true, .speed = 4.0});
  EXPECT_EQ(panel_.plan().tool_operator, "tremor");
  EXPECT_EQ(panel_.plan().feed_mm_s, 3.0);
  EXPECT_TRUE(panel_.plan().stops_on_breach);
  EXPECT_EQ(panel_.plan().speed, 4.0);
  EXPECT_EQ(player_.plan().speed, 4.0);
  player_.stop();
}

TEST_F(DrillPanelTest, TellsTheFiguresInWords) {
  document_.set_bone(test::phantom_bone());
  DrillPath path = test::phantom_paths().front();
  path.target_mm = path.entry_mm + 30.0 * path.direction();  // whole steps of 1 µm to the end
  document_.set_paths({path});
  EXPECT_EQ(text("drill_state"), "Ready");
  EXPECT_EQ(text("drill_depth"), "–");
  choose("drill_speed", 0.0);
  button("drill_start").click();
  ASSERT_TRUE(wait_for(DrillPlayer::State::stopped));
  EXPECT_EQ(text("drill_state").substr(0, 7), "Ended: ");
  EXPECT_EQ(text("drill_depth"), "30.00 mm");
  EXPECT_THAT(text("drill_heat"), ::testing::MatchesRegex("[0-9.]+ °C, at most [0-9.]+ °C"));
  EXPECT_GT(player_.last()->heat.max_temperature_c, 37.0);
  const Plot heat = drill_plot(DrillCurve::temperature, player_.rows(), 30.0);
  ASSERT_EQ(heat.series.size(), 1U);
  EXPECT_EQ(heat.series.front().y.size(), player_.rows().size());
  EXPECT_EQ(heat.y_unit, "°C");
  EXPECT_FALSE(heat.y_from_zero);
  EXPECT_EQ(text("drill_feed"), "1.00 mm/s");
  EXPECT_EQ(static_cast<std::size_t>(find<QListWidget>("drill_events").count()), player_.events().size());
  EXPECT_GT(player_.events().size(), 1U);
}

TEST_F(DrillPanelTest, ShowsWhyADrillingFailed) {
  document_.set_bone(test::phantom_bone());
  DrillPath path = test::phantom_paths().front();
  path.entry_mm.x() += 200.0;
  path.target_mm.x() += 200.0;
  document_.set_paths({path});
  button("drill_start").click();
  ASSERT_TRUE(wait_for(DrillPlayer::State::idle));
  EXPECT_FALSE(find<QLabel>("drill_trouble").isHidden());
  EXPECT_THAT(text("drill_trouble"), ::testing::HasSubstr("bone"));
}

TEST_F(DrillPanelTest, GivesThePlanThatWasChosen) {
  choose("drill_operator", "push");
  choose("drill_speed", 0.25);
  const DrillPlan plan = panel_.plan();
  EXPECT_EQ(plan.tool_operator, "push");
  EXPECT_EQ(plan.push_n, 40.0);
  EXPECT_EQ(plan.speed, 0.25);
  EXPECT_FALSE(find<QWidget>("drill_feed_wanted").isEnabled());
  EXPECT_TRUE(find<QWidget>("drill_push").isEnabled());
}

TEST_F(DrillPanelTest, MillsWhatAFileSaysAndTellsTheEngineThatWasTaken) {
  document_.set_bone(test::phantom_bone());
  document_.set_paths({test::burr_path()});
  EXPECT_EQ(panel_.plan().engine, EngineKind::automatic);
  EXPECT_EQ(button("drill_choose_milling").text(), "Choose a file…");
  choose("drill_operator", "milling");
  button("drill_start").click();
  EXPECT_THAT(text("drill_trouble"), ::testing::HasSubstr("choose its file"));
  choose("drill_operator", "on-path");
  panel_.set_milling(test::entry_milling());
  EXPECT_EQ(panel_.plan().tool_operator, "milling");
  ASSERT_TRUE(panel_.plan().milling);
  EXPECT_EQ(button("drill_choose_milling").text(), "patch");
  for (const char* name : {"drill_feed_wanted", "drill_push", "drill_stop_on_breach"}) {
    EXPECT_FALSE(find<QWidget>(name).isEnabled()) << name;
  }
  choose("drill_speed", 0.0);
  button("drill_start").click();
  EXPECT_TRUE(find<QLabel>("drill_trouble").isHidden());
  ASSERT_TRUE(wait_for(DrillPlayer::State::stopped));
  EXPECT_EQ(text("drill_engine_used"), "voxel");
  EXPECT_THAT(text("drill_removed"), ::testing::HasSubstr(" voxels"));
  EXPECT_THAT(text("drill_canal"), ::testing::HasSubstr("not watched"));
  EXPECT_THAT(text("drill_heat"), ::testing::HasSubstr("not worked out"));
  button("drill_undo_hole").click();
  EXPECT_EQ(text("drill_engine_used"), "–");
  choose("drill_operator", "on-path");
  choose("drill_engine", static_cast<int>(EngineKind::leaf));
  EXPECT_EQ(panel_.plan().engine, EngineKind::leaf);
  EXPECT_FALSE(panel_.plan().milling);
  button("drill_start").click();
  ASSERT_TRUE(wait_for(DrillPlayer::State::stopped));
  EXPECT_EQ(text("drill_engine_used"), "leaf");
  EXPECT_THAT(text("drill_removed"), ::testing::HasSubstr(" points"));
}

TEST_F(DrillPanelTest, HasAShortcutATipAndAPlaceInTheTabOrderForEachButton) {
  const auto buttons = panel_.findChildren<QToolButton*>(QRegularExpression("^drill_"));
  EXPECT_EQ(buttons.size(), 8);
  QStringList keys;
  for (const QToolButton* one : buttons) {
    const QKeySequence key = one->defaultAction()->shortcut();
    EXPECT_FALSE(key.isEmpty()) << one->objectName().toStdString();
    EXPECT_FALSE(one->toolTip().isEmpty());
    EXPECT_TRUE((one->focusPolicy() & Qt::TabFocus) != 0);
    keys << key.toString();
  }
  EXPECT_EQ(keys.removeDuplicates(), 0);
}

TEST(ClearanceWords, WarnBelowAMillimetreAndBeyondTheWall) {
  EXPECT_EQ(clearance_words(2.314), "2.31 mm");
  EXPECT_EQ(clearance_words(0.62), "0.62 mm, near");
  EXPECT_EQ(clearance_words(-0.4), "beyond by 0.40 mm");
  EXPECT_EQ(clearance_words(std::numeric_limits<double>::infinity()), "far");
}

}  // namespace
}  // namespace spinaltap
