#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "apps/report/drill_report.h"
#include "core/base/staged_output.h"
#include "core/ct/ct_volume.h"
#include "core/ct/hu_to_density.h"
#include "mesh/mesh_quality.h"
#include "mesh/remaining_mesh.h"
#include "vdb/sim/drilling.h"
#include "vdb/sim/solve_heat.h"

namespace spinaltap {

/// All that drilling came to, for those who print and write it.
struct DrillFigures {
  const Drilling& drilling;
  const Bone& bone;
  const SessionSetup& setup;
  const std::map<std::string, std::string>& operator_words;  ///< OperatorPlan::words
  const MeshQuality& mesh;                                   ///< less the chips
  LooseChips chips = {};
  std::uint64_t cycles_not_recorded = 0;
  const SolvedHeat* heat = nullptr;  ///< of the whole drilling, where it was asked for
};

/// Mean cycles per second along the way; 0 where none was measured.
struct DrillRates {
  double first_tenth = 0.0;
  double middle_tenth = 0.0;
  double last_tenth = 0.0;
};
DrillRates drill_rates(const std::vector<DepthRow>& rows);

/// For the report, but for its pictures; `ct` may be null.
DrillReportData report_data(const std::string& title, const CtVolume* ct, const DrillFigures& figures);

/// Writes report.html, drilled.vdb, drilled.stl, log.csv and events.csv into a folder, to be committed by the caller.
/// `surface`: of the drilled bone.
void stage_drilling(const Drilling& drilling, const TriangleMesh& surface, const DrillReportData& data,
                    const std::filesystem::path& folder, StagedOutput& output);

/// "12.0, -3.5, 40.0 to 52.0, 36.5, 80.0 mm"
std::string region_text(const Box3& region_mm);

/// Where and why an operator ended short of its target; empty where it did not.
std::string end_words(const Drilling& drilling, const DrillPath& path);

/// What a record says beside the session's setup: of the operator (OperatorPlan::words) and the pace.
std::map<std::string, std::string> record_words(const std::map<std::string, std::string>& operator_words,
                                                const std::string& pace);

}  // namespace spinaltap
