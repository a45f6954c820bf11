#include "apps/spinaltap/drill_run.h"

#include <cmath>
#include <cstdio>
#include <map>
#include <optional>

#include "apps/common/data_files.h"
#include "apps/common/density_file.h"
#include "apps/common/drill_pictures.h"
#include "apps/common/material_file.h"
#include "apps/report/drill_report.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/mesh_figures.h"
#include "core/base/staged_output.h"
#include "core/drill/neighbour_distances.h"
#include "core/rbf/rbf_field.h"
#include "core/rbf/rbf_file.h"
#include "mesh/mesh_io.h"
#include "vdb/isosurface.h"
#include "vdb/points_file.h"

namespace spinaltap {
namespace {

std::string fixed(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

/// Mean cycles per second over a part of the rows, from their times.
double rate(const std::vector<DepthRow>& rows, std::size_t begin, std::size_t end) {
  double cycles = 0.0;
  double seconds = 0.0;
  for (std::size_t i = begin; i < end; ++i) {
    cycles += static_cast<double>(rows[i].cycles);
    seconds += static_cast<double>(rows[i].cycles) / rows[i].cycles_per_s;
  }
  return seconds > 0.0 ? cycles / seconds : 0.0;
}

struct Rates {
  double first_tenth;
  double middle_tenth;
  double last_tenth;
};

Rates rates_of(const std::vector<DepthRow>& rows) {
  const std::size_t count = rows.size();
  const std::size_t tenth = std::max<std::size_t>(1, count / 10);
  const std::size_t middle = (count - tenth) / 2;
  return {rate(rows, 0, tenth), rate(rows, middle, middle + tenth), rate(rows, count - tenth, count)};
}

DrillReportData report_data(const std::string& title, const CtVolume* ct, const BoneModel& bone, const DrillPath& path,
                            const Drilling& drilling, const MeshQuality& mesh, const DrillOptions& options) {
  DrillReportData data;
  data.title = title;
  data.ct = ct;
  data.path = path;
  data.bone_bounds_mm = bone.bounds_mm();
  for (const DepthRow& row : drilling.rows) {
    data.depth_mm.push_back(row.depth_mm);
    data.density_hu.push_back(row.hu);
    data.density_g_per_cm3.push_back(row.density_g_cm3);
    data.thrust_N.push_back(row.thrust_n);
    data.cycles_per_s.push_back(row.cycles_per_s);
    data.removed_points.push_back(static_cast<double>(row.removed));
  }
  const Rates rates = rates_of(drilling.rows);
  const auto count = [](std::size_t value) { return std::to_string(value); };
  data.figures = {
      {"Advance per cycle", fixed(options.drilling.motion.step_mm, 4), "mm"},
      {"Discs", count(static_cast<std::size_t>(drilling.discs)), ""},
      {"Points per disc", count(drilling.points_per_disc), ""},
      {"Points in the cylinder", count(drilling.points), ""},
      {"Points in bone", count(drilling.points_in_bone), ""},
      {"Points removed", count(drilling.removed), ""},
      {"Cycles", count(drilling.cycles), ""},
      {"Time in the engine", fixed(drilling.seconds, 2), "s"},
      {"Rate, first tenth of the path", fixed(rates.first_tenth, 0), "cycles/s"},
      {"Rate, middle tenth", fixed(rates.middle_tenth, 0), "cycles/s"},
      {"Rate, last tenth", fixed(rates.last_tenth, 0), "cycles/s"},
      {"Greatest thrust", fixed(drilling.most_thrust_n, 2), "N"},
      {"First bone at depth", fixed(drilling.entry_depth_mm, 2), "mm"},
      {"Drilled mesh, triangles", count(mesh.triangles), ""},
      {"Drilled mesh, closed", mesh.closed() ? "yes" : "no", ""},
      {"Drilled mesh, pieces", count(mesh.pieces), ""},
      {"Drilled mesh, volume", fixed(mesh.volume_mm3 / 1000.0, 2), "cm³"},
  };
  if (options.drilling.motion.offset_mm != 0.0) {
    data.figures.push_back({"Sideways offset from the path", fixed(options.drilling.motion.offset_mm, 2), "mm"});
  }
  if (options.drilling.motion.tilt_deg != 0.0) {
    data.figures.push_back({"Tilt against the path", fixed(options.drilling.motion.tilt_deg, 1), "degrees"});
  }
  return data;
}

}  // namespace

void DrillOptions::add_to(CLI::App& app) {
  app.add_option("--density", density, "Law of density, or a calibration; default: the shipped densities/vertebra.json")
      ->type_name("FILE");
  app.add_option("--material", material, "Law of resistance; default: the shipped materials/vertebra.json")
      ->type_name("FILE");
  app.add_option("--radius", drilling.volume.radius_mm, "Radius of the point volume, mm")
      ->capture_default_str()
      ->type_name("MM");
  app.add_option("--spacing", drilling.volume.spacing_mm, "Distance between points, mm")
      ->capture_default_str()
      ->type_name("MM");
  app.add_option("--fine-spacing", drilling.fine_spacing_mm,
                 "Distance between points near the bone's surface and the target, mm; 0: the same everywhere")
      ->capture_default_str()
      ->type_name("MM");
  app.add_option("--fine-near", drilling.fine_near_mm, "How far along the path from the surface points are fine, mm")
      ->capture_default_str()
      ->type_name("MM");
  app.add_option("--fine-tip", drilling.fine_tip_mm, "How far before the target points are fine, mm")
      ->capture_default_str()
      ->type_name("MM");
  app.add_option("--hu-bits", drilling.volume.hu_bits,
                 "Bits for a point's CT number: 8 (steps of 16 HU) or 16 (default)")
      ->transform(CLI::CheckedTransformer(std::map<std::string, HuBits>{{"8", HuBits::eight}, {"16", HuBits::sixteen}}))
      ->type_name("BITS");
  app.add_option("--subdivision", drilling.volume.subdivision, "How discs are divided: rings (default) or hexagons")
      ->transform(CLI::CheckedTransformer(std::map<std::string, DiscSubdivision>{
          {"rings", DiscSubdivision::rings}, {"hexagons", DiscSubdivision::hexagons}}))
      ->type_name("NAME");
  app.add_option("--jitter", drilling.volume.jitter, "Random displacement of points, share of the spacing, 0 to 0.5")
      ->capture_default_str()
      ->type_name("SHARE");
  app.add_option("--jitter-seed", drilling.volume.jitter_seed, "Seed of the jitter")
      ->capture_default_str()
      ->type_name("N");
  app.add_option("--rbf", field,
                 "A surface that `fit` wrote: decides exactly which points are bone, in place of the grid; slower")
      ->type_name("FILE");
  app.add_option("--engine", drilling.engine, "Drilling engine: ring (default), leaf, arc, reference; same result")
      ->transform(CLI::CheckedTransformer(engine_kinds()))
      ->type_name("NAME");
  app.add_flag("--points", writes_points, "Also write the points left as points.vdb, for Houdini, Blender, ParaView");
  app.add_option("--lead-in", drilling.volume.lead_in_mm, "How far before the entry the drilling starts, mm")
      ->capture_default_str()
      ->type_name("MM");
  app.add_option("--step", drilling.motion.step_mm, "Advance a cycle, mm")->capture_default_str()->type_name("MM");
  app.add_option("--offset", drilling.motion.offset_mm, "Sideways shift of the bit from the path, mm")
      ->capture_default_str()
      ->type_name("MM");
  app.add_option("--tilt", drilling.motion.tilt_deg, "Angle between bit and path, degrees")
      ->capture_default_str()
      ->type_name("DEG");
  app.add_option("--log-step", drilling.log_step_mm, "Depth for one row of log.csv, mm")
      ->capture_default_str()
      ->type_name("MM");
}

Json run_drill(const std::string& title, const CtVolume* ct, const BoneModel& bone, const DrillPath& path,
               const DrillOptions& options, const std::filesystem::path& folder, const Progress& progress) {
  const DensityCalibration density =
      read_density_law(options.density.empty() ? data_file("densities/vertebra.json") : options.density);
  const Material material =
      read_material(options.material.empty() ? data_file("materials/vertebra.json") : options.material, density.law);
  std::optional<RbfField> field;
  if (!options.field.empty()) field.emplace(RbfField::for_values(read_rbf(options.field), RbfField::kDefaultAccuracy));
  DrillingOptions settings = options.drilling;
  if (field) settings.exact = &*field;
  const Drilling drilling = drill_bone(bone, path, material, settings, progress);
  progress.report("meshing", 0.0);
  const TriangleMesh mesh = bone_surface(drilling.drilled);
  const MeshQuality quality = measure_mesh(mesh);
  DrillReportData data = report_data(title, ct, bone, path, drilling, quality, options);
  data.renders = drill_pictures(bone, drilling.drilled, path, progress);

  StagedOutput output;
  output.write(folder / "log.csv", log_csv(drilling.rows));
  write_bone(drilling.drilled, output.stage(folder / "drilled.vdb"));
  write_mesh(mesh, output.stage(folder / "drilled.stl"));
  for (std::size_t n = 0; options.writes_points && n < drilling.volumes.size(); ++n) {
    const std::string number = drilling.volumes.size() == 1 ? "" : "_" + std::to_string(n + 1);
    write_points(drilling.volumes[n], path, output.stage(folder / ("points" + number + ".vdb")),
                 {.density = density.law});
  }
  output.write(folder / "report.html", drill_report(data));
  output.commit();

  const Rates rates = rates_of(drilling.rows);
  print_figure("points in the cylinder", static_cast<double>(drilling.points), "", 0);
  print_figure("points in bone", static_cast<double>(drilling.points_in_bone), "", 0);
  print_figure("points removed", static_cast<double>(drilling.removed), "", 0);
  const NeighbourDistances neighbours = neighbour_distances(drilling.volumes.front(), false);
  print_figure("nearest neighbours, mean", neighbours.mean_mm, "mm", 4);
  print_figure("nearest neighbours, standard deviation", neighbours.deviation_mm, "mm", 4);
  print_figure("memory", drilling.bytes_per_point, "bytes/point", 3);
  print_figure("cycles", static_cast<double>(drilling.cycles), "", 0);
  print_figure("rate, first tenth of the path", rates.first_tenth, "cycles/s", 0);
  print_figure("rate, last tenth", rates.last_tenth, "cycles/s", 0);
  print_figure("greatest thrust", drilling.most_thrust_n, "N", 2);
  print_figure("density at 0 HU", density.law.at_0_hu, "g/cm3", 4);
  print_figure("density per 1000 HU", 1000.0 * density.law.per_hu, "g/cm3", 4);
  if (density.rms_residual_g_cm3 > 0.0) {
    print_figure("calibration misses the line by", density.rms_residual_g_cm3, "g/cm3 rms", 4);
  }
  Json figures{{"path", path.name},
               {"length_mm", path.length_mm()},
               {"discs", drilling.discs},
               {"points_per_disc", drilling.points_per_disc},
               {"points", drilling.points},
               {"points_in_bone", drilling.points_in_bone},
               {"removed", drilling.removed},
               {"bytes_per_point", drilling.bytes_per_point},
               {"nearest_neighbours_mm",
                {{"least", neighbours.least_mm},
                 {"mean", neighbours.mean_mm},
                 {"deviation", neighbours.deviation_mm},
                 {"most", neighbours.most_mm}}},
               {"cycles", drilling.cycles},
               {"engine_seconds", drilling.seconds},
               {"cycles_per_s_first_tenth", rates.first_tenth},
               {"cycles_per_s_middle_tenth", rates.middle_tenth},
               {"cycles_per_s_last_tenth", rates.last_tenth},
               {"greatest_thrust_N", drilling.most_thrust_n},
               {"density_at_0_hu_g_cm3", density.law.at_0_hu},
               {"density_per_hu_g_cm3", density.law.per_hu},
               {"calibration_rms_g_cm3", density.rms_residual_g_cm3},
               {"calibration_most_g_cm3", density.most_residual_g_cm3},
               {"mesh", report_mesh(quality)}};
  print_figure("report", (folder / "report.html").string());
  return figures;
}

}  // namespace spinaltap
