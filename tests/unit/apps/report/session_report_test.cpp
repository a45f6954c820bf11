#include "apps/report/session_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"

namespace spinaltap {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

SessionEvent state_at(double depth_mm, int state) {
  return {.kind = EventKind::state, .depth_mm = depth_mm, .value = static_cast<double>(state)};
}

TEST(SessionReport, MarksWhereStatesBeginAndReturnsOnlyWhereTheyAreApart) {
  const std::vector<SessionEvent> events{state_at(0.2, 1),  state_at(1.4, 2),  state_at(20.0, 3), state_at(20.8, 2),
                                         state_at(25.0, 3), state_at(25.3, 4), state_at(25.4, 4)};
  const std::vector<PlotMarker> markers = state_markers(events);
  ASSERT_EQ(markers.size(), 6U);
  EXPECT_EQ(markers[0].x, 0.2);
  EXPECT_EQ(markers[0].label, "outer cortical");
  EXPECT_EQ(markers[2].x, 20.8);
  EXPECT_EQ(markers[2].label, "cancellous");
  EXPECT_EQ(markers[5].x, 25.3);
  EXPECT_EQ(markers[5].label, "inner cortical");
  EXPECT_TRUE(state_markers({}).empty());
}

TEST(SessionReport, SaysWhatEachKindOfEventIsWorthWithItsUnit) {
  const auto text = [](EventKind kind, double value) { return value_text({.kind = kind, .value = value}); };
  EXPECT_EQ(text(EventKind::contact, 0.0), "");
  EXPECT_EQ(text(EventKind::state, 2.0), "cancellous");
  EXPECT_EQ(text(EventKind::stop_thrust, 41.26), "41.3 N");
  EXPECT_EQ(text(EventKind::canal_breach, 0.456), "0.46 mm");
  EXPECT_EQ(text(EventKind::touch, 113.04), "113.0 N");
  EXPECT_EQ(text(EventKind::heat_limit, 51.26), "51.3 °C");
  EXPECT_EQ(text(EventKind::record_lost, 1234.0), "1,234 cycles");
}

TEST(SessionReport, ListsEventsAndCountsThoseThatItLeavesOut) {
  std::vector<SessionEvent> events(70, state_at(3.0, 2));
  HtmlReport report("events");
  add_events(events, 5, report);
  const std::string html = report.html();
  EXPECT_THAT(html, HasSubstr("cancellous"));
  EXPECT_THAT(html, HasSubstr("The first 60 of 70 events"));
  EXPECT_THAT(html, HasSubstr("5 further events were not kept"));
  HtmlReport none("none");
  add_events({}, 0, none);
  EXPECT_THAT(none.html(), Not(HasSubstr("<h2>")));
}

RealTimeReport a_run() {
  RealTimeReport run;
  run.seconds = 60.0;
  run.warnings = {"real-time priority not allowed"};
  run.collision = {.rate_hz = 999.5,
                   .cycles = 59'970,
                   .idle = 10,
                   .missed = 7,
                   .skipped = 20,
                   .wake_up = {60.0, 900.0, 2500.0, 8000.0},
                   .work_wall = {8.0, 20.0, 35.0, 1200.0},
                   .work_cpu = {7.5, 18.0, 30.0, 90.0},
                   .wake_up_histogram = {1, 2, 3},
                   .work_histogram = {50'000, 9'000, 970}};
  run.tool = run.collision;
  run.tool.cycles = 60'000;
  return run;
}

TEST(SessionReport, ShowsThreadsThatRanWithEverythingThatWasCounted) {
  const TextRows pace = pace_rows(a_run());
  ASSERT_EQ(pace.rows.size(), 2U);  // no display, no output
  EXPECT_EQ(pace.rows[0], (std::vector<std::string>{"collision", "999.5", "59,970", "7", "20", "10"}));
  const TextRows latency = latency_rows(a_run());
  ASSERT_EQ(latency.rows.size(), 6U);
  EXPECT_EQ(latency.rows[1], (std::vector<std::string>{"collision, work", "8.0", "20.0", "35.0", "1,200.0"}));
  HtmlReport report("run");
  add_real_time(a_run(), report);
  const std::string html = report.html();
  for (const char* part : {"59,970", "1,200.0", "real-time priority not allowed", "without real-time priority",
                           "How late cycles began", "How long cycles worked"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
}

TEST(SessionReport, TablesRejectRowsOfAnotherLength) {
  HtmlReport report("table");
  EXPECT_THROW(report.add_table({"a", "b"}, {{"1", "2"}, {"3"}}), Error);
}

}  // namespace
}  // namespace spinaltap
