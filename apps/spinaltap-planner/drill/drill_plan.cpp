#include "apps/spinaltap-planner/drill/drill_plan.h"

#include "apps/report/text.h"
#include "core/files/data_files.h"
#include "core/files/density_file.h"
#include "core/files/material_file.h"

namespace spinaltap {

HandChoice hand_choice(const DrillPlan& plan) {
  HandChoice choice;
  choice.name = plan.hand;
  if (plan.hand == "push") {
    choice.push_n = plan.push_n;
  } else {
    choice.feed = short_number(plan.feed_mm_s);
  }
  return choice;
}

SessionSetup session_setup(const DrillPath& path, const DrillPlan& plan) {
  SessionSetup setup;
  setup.path = path;
  const DensityLaw density = read_density_law(data_file("densities/vertebra.json")).law;
  setup.material = read_material(data_file("materials/vertebra.json"), density);
  setup.options.stop.on_breach = plan.stops_on_breach;
  return setup;
}

}  // namespace spinaltap
