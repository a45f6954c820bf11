#include "apps/spinaltap/drill_run.h"

#include <exception>
#include <optional>

#include "apps/report/drilling_report.h"
#include "apps/report/picture_view.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/drill_figures.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/files/data_files.h"
#include "core/files/material_file.h"
#include "core/rbf/rbf_field.h"
#include "core/rbf/rbf_file.h"
#include "core/session/record/session_record.h"
#include "mesh/cut_out.h"
#include "mesh/mesh_io.h"
#include "mesh/remaining_mesh.h"
#include "vdb/engine/points_file.h"
#include "vdb/remaining/live_mesh.h"

namespace spinaltap {
namespace {

/// A record of the session, where one is asked for.
class Recording {
 public:
  Recording(const DrillOptions& options, const SessionSetup& setup, const HandPlan& hand) {
    if (options.record.empty()) return;
    const std::string pace = options.is_real_time ? "real time" : "as fast as it goes";
    writer_.emplace(options.record, record_words(setup, hand.words, pace));
  }
  RecordWriter* writer() { return writer_ ? &*writer_ : nullptr; }
  /// What goes wrong is kept: a full disk shall not cost the other results.
  void close(const std::vector<SessionEvent>& events) {
    if (!writer_) return;
    try {
      writer_->close(events);
    } catch (const Error&) {
      trouble_ = std::current_exception();
    }
  }
  /// Cycles that did not get into it.
  std::uint64_t lost() const { return writer_ ? writer_->lost() : 0; }
  void rethrow_trouble() const {
    if (trouble_) std::rethrow_exception(trouble_);
  }

 private:
  std::optional<RecordWriter> writer_;
  std::exception_ptr trouble_;
};

}  // namespace

Json run_drill(const std::string& title, const CtVolume* ct, const Bone& bone, const DrillPath& path,
               const DrillOptions& options, const std::filesystem::path& folder, const Progress& progress) {
  options.check();
  SessionSetup setup = options.setup;
  setup.path = path;
  setup.has_clearances = !options.leaves_clearances;
  HandPlan hand = options.hand.plan(path, setup.volume.lead_in_mm, setup.options.spindle, options.is_real_time);
  const DensityCalibration density =
      read_density_law(options.density.empty() ? data_file("densities/vertebra.json") : options.density);
  setup.material =
      read_material(options.material.empty() ? data_file("materials/vertebra.json") : options.material, density.law);
  std::optional<RbfField> field;
  if (!options.field.empty()) field.emplace(RbfField::for_values(read_rbf(options.field), RbfField::kDefaultAccuracy));
  if (!options.record.empty()) setup.bone_hash = bone.hash();
  Recording recording(options, setup, hand);
  DrillingOptions how{.exact = field ? &*field : nullptr,
                      .log_step_mm = options.log_step_mm,
                      .real_time = options.real_time(hand),
                      .makes_splats = options.writes_splats,
                      .record = recording.writer()};
  // Beside the drilling, as a simulator shows it; where the clock does not count, nobody looks.
  std::optional<LiveMesh> live;
  if (how.real_time) {
    live.emplace(bone.model(), path.bit, setup.options.longest_jump_mm);
    how.display = [&live](const Cycle& cycle) { live->update(cycle.input); };
  }
  const Drilling drilling = drill_bone(bone, setup, *hand.hand, how, progress);
  const TriangleMesh surface = sharp_surface(drilling.drilled);
  recording.close(drilling.events);

  progress.report("meshing", 0.0);
  const MeshQuality quality = measure_mesh(surface);
  const DrillFigures figures{drilling, bone, setup, hand.words, quality, recording.lost()};
  DrillReportData data = report_data(title, ct, figures);
  data.renders = drill_pictures(bone.model(), drilling.drilled, path, progress);

  StagedOutput output;
  stage_drilling(drilling, surface, data, folder, output);
  for (std::size_t n = 0; options.writes_points && n < drilling.volumes.size(); ++n) {
    const std::string number = drilling.volumes.size() == 1 ? "" : "_" + std::to_string(n + 1);
    write_points(drilling.volumes[n], path, output.stage(folder / ("points" + number + ".vdb")),
                 {.density = density.law});
  }
  if (options.writes_splats) {
    output.write(folder / "splats.ply", splats_ply(drilling.splats));
    const DiscPattern& pattern = drilling.volumes.front().pattern();
    const double radius_mm = (pattern.ring_count() - 0.5) * pattern.spacing_mm();  // that the points stand for
    write_mesh(cut_out_cylinder(bone.model(), path, radius_mm, setup.volume.lead_in_mm),
               output.stage(folder / "around.ply"));
  }
  output.commit();

  print_drilling(figures, density);
  print_figure("report", (folder / "report.html").string());
  recording.rethrow_trouble();
  return drilling_json(figures, density);
}

}  // namespace spinaltap
