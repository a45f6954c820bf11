#include "apps/spinaltap-planner/drill/drill_output.h"

#include "apps/report/drilling_report.h"
#include "apps/report/picture_view.h"
#include "core/session/operator/pose_hand.h"
#include "core/session/record/session_record.h"
#include "mesh/remaining_mesh.h"

namespace spinaltap {

void write_record(const DoneDrilling& drilling, const std::filesystem::path& path, const Progress& progress) {
  SessionSetup setup = drilling.setup;
  setup.bone_hash = drilling.bone->bone->hash();
  BuiltSession built = build_session(*drilling.bone->bone, setup, progress);
  DrillSession& session = *built.session;
  PoseHand hand(drilling.inputs, false);
  RecordWriter record(path, record_words(setup, drilling.hand_words, "planner"), true);
  const auto observe = [&](const Cycle& cycle) {
    record.add_waiting(cycle);
    record.add_events(session.events());
  };
  run_session(session, hand, observe, progress);
  record.close(session.events());
}

void write_report(const DoneDrilling& drilling, const std::filesystem::path& folder, const Progress& progress) {
  const DrillPath& path = drilling.setup.path;
  PoseHand hand(drilling.inputs, false);
  const Drilling again = drill_bone(*drilling.bone->bone, drilling.setup, hand, {}, progress);
  progress.report("meshing", 0.0);
  const TriangleMesh surface = sharp_surface(again.drilled);
  const MeshQuality quality = measure_mesh(surface);
  DrillReportData data = report_data("Drilling " + path.name, &drilling.bone->ct,
                                     {again, *drilling.bone->bone, drilling.setup, drilling.hand_words, quality});
  data.renders = drill_pictures(drilling.bone->model(), again.drilled, path, progress);
  data.notes.emplace_back("Drilled in the planner. Rates are those of the same cycles run again as fast as they go.");
  if (!drilling.setup.holes.empty()) {
    data.notes.push_back("Holes that were in the bone before: " + std::to_string(drilling.setup.holes.size()) + ".");
  }
  StagedOutput output;
  stage_drilling(again, surface, data, folder, output);
  output.commit();
}

}  // namespace spinaltap
