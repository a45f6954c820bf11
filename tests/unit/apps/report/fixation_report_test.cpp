#include "apps/report/fixation_report.h"

#include <gtest/gtest.h>

#include "apps/report/svg_plot.h"

namespace spinaltap {
namespace {

ScrewFixation made_fixation() {
  ScrewFixation fixation;
  fixation.pullout_n = {853.2, 443.9, 1643.0};
  fixation.stiffness_n_mm = {9876.0, 5000.0, 20000.0};
  fixation.max_torque_n_mm = {1200.0, 600.0, 2400.0};
  fixation.cortical_share = 0.25;
  fixation.engaged_mm = 38.5;
  fixation.rows = {{0.0, 0.0, 1.0}, {20.0, 700.0, 2.0}, {40.0, 1200.0, 1.5}};
  return fixation;
}

TEST(FixationReport, FiguresHaveTwoDigitsAndTheirBand) {
  EXPECT_EQ(banded_text({853.2, 443.9, 1643.0}), "850 (440 to 1,600)");
  EXPECT_EQ(banded_text({5.0, 0.0, 12.4}), "5.00 (0 to 12)");
  EXPECT_EQ(banded_text({}), "0 (0 to 0)");
  const std::vector<ReportRow> rows = fixation_rows(made_fixation());
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(rows[0].value, "850 (440 to 1,600)");
  EXPECT_EQ(rows[1].value, "25");
  EXPECT_EQ(rows[4].value, "38.5");
}

TEST(FixationReport, PlotShowsTheTorqueWithItsBand) {
  const Plot plot = insertion_torque_plot(made_fixation());
  ASSERT_EQ(plot.series.size(), 1u);
  EXPECT_EQ(plot.series[0].y, (std::vector<double>{0.0, 700.0, 1200.0}));
  ASSERT_EQ(plot.bands.size(), 1u);
  EXPECT_EQ(plot.bands[0].low, (std::vector<double>{0.0, 350.0, 600.0}));
  EXPECT_EQ(plot.bands[0].high, (std::vector<double>{0.0, 1400.0, 2400.0}));
  EXPECT_NE(svg_plot(plot).find("Insertion torque"), std::string::npos);
}

TEST(FixationReport, PlotOfAScrewThatHoldsNothingIsFlat) {
  ScrewFixation none = made_fixation();
  none.max_torque_n_mm = {};
  for (FixationRow& row : none.rows) row.torque_n_mm = 0.0;
  const Plot plot = insertion_torque_plot(none);
  EXPECT_EQ(plot.bands[0].high, (std::vector<double>{0.0, 0.0, 0.0}));
}

}  // namespace
}  // namespace spinaltap
