#pragma once

#include <string>

#include "apps/common/drilling.h"
#include "apps/report/drill_report.h"
#include "apps/spinaltap/hand_choice.h"
#include "core/ct/ct_volume.h"
#include "core/ct/density_law.h"
#include "mesh/mesh_quality.h"

namespace spinaltap {

/// All that drilling came to, for those who print and write it.
struct DrillFigures {
  const Drilling& drilling;
  const SessionBone& bone;
  const SessionSetup& setup;
  const HandPlan& hand;
  const DensityCalibration& density;
  const MeshQuality& mesh;
  std::uint64_t cycles_not_recorded = 0;
};

/// For the report; `ct` may be null.
DrillReportData report_data(const std::string& title, const CtVolume* ct, const DrillFigures& figures);
/// For people, on standard output.
void print_drilling(const DrillFigures& figures);
Json drilling_json(const DrillFigures& figures);

}  // namespace spinaltap
