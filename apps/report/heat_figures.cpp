#include "apps/report/heat_figures.h"

#include <nlohmann/json.hpp>
#include <string>

#include "core/base/text_writer.h"

namespace spinaltap {

std::vector<ReportRow> heat_rows(const SolvedHeat& heat) {
  const DrillingHeat& drilling = heat.drilling;
  const HeatBalance& balance = drilling.balance;
  const Vec3& at = heat.hottest_mm;
  std::vector<ReportRow> rows{
      {"Hottest bone", fixed_text(heat.hottest_c, 1), "°C"},
      {"Hottest bone, at depth", fixed_text(heat.hottest_depth_mm, 1), "mm"},
      {"Hottest bone, at (x, y, z)",
       fixed_text(at.x(), 1) + ", " + fixed_text(at.y(), 1) + ", " + fixed_text(at.z(), 1), "mm"}};
  for (const HeatAtDistance& away : heat.distances) {
    if (!(away.distance_mm > 0.0)) continue;
    rows.push_back({"Hottest bone, " + fixed_text(away.distance_mm, 1) + " mm or more from the wall",
                    fixed_text(away.temperature_c, 1), "°C"});
  }
  for (std::size_t n = 0; n < kHarmfulC.size(); ++n) {
    rows.push_back({"Bone above " + fixed_text(kHarmfulC[n], 0) + " °C for " + fixed_text(kHarmfulS[n], 0) + " s",
                    fixed_text(heat.harmed_mm3[n], 1), "mm³"});
  }
  rows.push_back({"Bone ever above " + fixed_text(kHarmfulC[0], 0) + " °C", fixed_text(drilling.hot_0_mm3, 1), "mm³"});
  rows.push_back({"Heat that the bone got", fixed_text(balance.given_j, 2), "J"});
  if (heat.heat.is_irrigated) rows.push_back({"Heat that water took", fixed_text(balance.water_j, 2), "J"});
  if (!drilling.has_cooled) rows.push_back({"Still hot after", fixed_text(drilling.time_s, 0), "s"});
  return rows;
}

Json heat_json(const SolvedHeat& heat) {
  const DrillingHeat& drilling = heat.drilling;
  const HeatBalance& balance = drilling.balance;
  Json distances = Json::array();
  for (const HeatAtDistance& away : heat.distances) {
    distances.push_back({{"distance_mm", away.distance_mm}, {"temperature_c", away.temperature_c}});
  }
  return {{"is_irrigated", heat.heat.is_irrigated},
          {"first_temperature_c", heat.heat.bone.temperature_c},
          {"hottest_c", heat.hottest_c},
          {"hottest_mm", {heat.hottest_mm.x(), heat.hottest_mm.y(), heat.hottest_mm.z()}},
          {"hottest_depth_mm", heat.hottest_depth_mm},
          {"distances", distances},
          {"above_47c_60s_mm3", heat.harmed_mm3[0]},
          {"above_50c_30s_mm3", heat.harmed_mm3[1]},
          {"above_47c_mm3", drilling.hot_0_mm3},
          {"given_j", balance.given_j},
          {"missed_j", balance.missed_j},
          {"in_bone_j", balance.in_bone_j},
          {"drilled_j", balance.drilled_j},
          {"water_j", balance.water_j},
          {"time_s", drilling.time_s},
          {"has_cooled", drilling.has_cooled}};
}

}  // namespace spinaltap
