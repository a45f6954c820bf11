#include <algorithm>
#include <cstdio>
#include <memory>

#include "apps/report/comparison_picture.h"
#include "apps/report/png.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/phantom_options.h"
#include "core/base/staged_output.h"
#include "core/base/text_writer.h"
#include "core/phantom/scanner.h"
#include "core/surface/surface_samples.h"
#include "mesh/surface_comparison.h"
#include "vdb/sim/bake_ct.h"
#include "vdb/sim/phantom_output.h"

namespace spinaltap {
namespace {

Json json_of(const SurfaceFigures& figures) {
  return {{"roughness_deg", figures.roughness_deg},
          {"volume_mm3", figures.volume_mm3},
          {"volume_change", figures.volume_change},
          {"mean_mm", figures.mean_mm},
          {"p99_mm", figures.p99_mm},
          {"max_mm", figures.max_mm},
          {"pieces", figures.pieces},
          {"euler_number", figures.euler_number}};
}

void print_row(const char* name, const SurfaceFigures& figures) {
  std::printf("  %-22s %9s %9s %9s %9s %9s %7zu\n", name, fixed_text(figures.roughness_deg, 2).c_str(),
              fixed_text(100.0 * figures.volume_change, 2).c_str(), fixed_text(figures.mean_mm, 3).c_str(),
              fixed_text(figures.p99_mm, 3).c_str(), fixed_text(figures.max_mm, 3).c_str(), figures.pieces);
}

Json report(const Comparison& comparison) {
  std::printf("  %-22s %9s %9s %9s %9s %9s %7s\n", "method, smoothing (mm)", "roughness", "volume", "mean", "99 %",
              "max", "pieces");
  std::printf("  %-22s %9s %9s %9s %9s %9s\n", "", "degrees", "%", "mm", "mm", "mm");
  print_row("ground truth", comparison.ground_truth_figures);
  Json surfaces = Json::array();
  for (const ComparedSurface& surface : comparison.surfaces) {
    TextWriter name;
    name << name_of(surface.method) << ", " << surface.smoothing_mm;
    Json one{
        {"method", name_of(surface.method)}, {"smoothing_mm", surface.smoothing_mm}, {"rbf_centres", surface.centres}};
    if (surface.bone) {
      print_row(name.str().c_str(), surface.figures);
      one.update(json_of(surface.figures));
    } else {
      std::printf("  %-22s no closed surface\n", name.str().c_str());
    }
    surfaces.push_back(one);
  }
  return {{"ground_truth", json_of(comparison.ground_truth_figures)}, {"surfaces", surfaces}};
}

}  // namespace

void add_compare(CLI::App& program, Command& command) {
  struct Options {
    PhantomCommandOptions phantom;
    ComparisonOptions comparison;
    std::filesystem::path output = "comparison.png";
  };
  const auto options = std::make_shared<Options>();
  CLI::App* app = add_command(program, command, "compare",
                              "Compare methods for a surface on a phantom, whose true surface is known",
                              "Example: spinaltap compare -o comparison.png --json comparison.json\n"
                              "Roughness is the spread of normals within 1 mm; volume the change against the ground "
                              "truth; distances are from the\n"
                              "surface to the ground truth.");
  app->add_option("-o,--output", options->output, "The picture to write, .png")
      ->capture_default_str()
      ->type_name("FILE");
  app->add_option("--method", options->comparison.methods, "Methods to compare: pixels, normals, contours")
      ->delimiter(',')
      ->transform(one_of(point_methods()))
      ->type_name("NAME,...");
  app->add_option("--smoothing", options->comparison.smoothings_mm, "Smoothings to compare, mm")
      ->delimiter(',')
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str()
      ->type_name("MM,...");
  app->add_option("--voxel", options->comparison.voxel_mm, "Voxel of the distance grids, mm")
      ->capture_default_str()
      ->type_name("MM");
  options->phantom.add_to(*app);

  command.run = [options](const Progress& progress) {
    const Phantom phantom = options->phantom.make();
    ScanOptions scanning = options->phantom.output_options().scan;
    // The whole body and some tissue above and below.
    const double height_mm = phantom.solid->bounds_mm().sizes().z() + 6.0;
    scanning.slices = std::max(scanning.slices, static_cast<int>(height_mm / scanning.slice_step_mm));
    const CtVolume ct = scan(*phantom.solid, scanning, progress);
    const ChosenBone bone = choose_bone(ct, std::nullopt, {}, progress);
    const Comparison comparison = compare_surfaces(*phantom.solid, ct, bone.mask, options->comparison, progress);
    StagedOutput output;
    output.write(options->output, encode_png(comparison_picture(comparison, progress)));
    output.commit();
    Json figures = report(comparison);
    print_figure("written", options->output.string());
    return figures;
  };
}

}  // namespace spinaltap
