#include <map>
#include <memory>

#include "apps/spinaltap/command.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/rbf/fit_rbf.h"
#include "core/rbf/rbf_file.h"
#include "core/rbf/value_file.h"

namespace spinaltap {
namespace {

Json report_fit(const FitReport& report) {
  print_figure("points", static_cast<double>(report.points), "", 0);
  print_figure("merged into others", static_cast<double>(report.merged_points), "", 0);
  print_figure("centres", static_cast<double>(report.centres), "", 0);
  print_figure("rounds of choosing centres", report.rounds, "", 0);
  print_figure("iterations of the solver", report.iterations, "", 0);
  print_figure("mean residual", report.mean_residual_mm, "mm", 6);
  print_figure("largest residual", report.max_residual_mm, "mm", 6);
  return {{"points", report.points},
          {"merged_points", report.merged_points},
          {"centres", report.centres},
          {"rounds", report.rounds},
          {"iterations", report.iterations},
          {"mean_residual_mm", report.mean_residual_mm},
          {"max_residual_mm", report.max_residual_mm}};
}

}  // namespace

void add_fit(CLI::App& program, Command& command) {
  struct Options {
    std::filesystem::path points;
    std::filesystem::path output = "surface.rbf";
    bool error_bars = false;
    FitOptions fit;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* app =
      add_command(program, command, "fit", "Fit a radial basis function to points with values (mm, patient LPS)",
                  "Example: spinaltap fit points.csv.gz -o surface.rbf --accuracy 0.01\n"
                  "Each point has x, y, z and value, the signed distance from the surface, negative inside, and\n"
                  "perhaps error_bar: .csv, .csv.gz, or .ply as spinaltap points writes it.");
  app->add_option("points", options->points, "Points with values: .csv, .csv.gz or .ply")
      ->required()
      ->type_name("FILE");
  app->add_option("-o,--output", options->output, "The file to write; for spinaltap eval")
      ->capture_default_str()
      ->type_name("FILE");
  const std::map<std::string, RadialKernel> kernels{{"biharmonic", RadialKernel::biharmonic},
                                                    {"triharmonic", RadialKernel::triharmonic}};
  app->add_option("--kernel", options->fit.kernel,
                  "biharmonic (default): r, with a linear polynomial; triharmonic: r^3, with a quadratic one")
      ->transform(one_of(kernels))
      ->type_name("NAME");
  app->add_option("--accuracy", options->fit.accuracy_mm,
                  "Largest difference, at any point, from what the equations ask there, mm")
      ->capture_default_str()
      ->check(CLI::PositiveNumber)
      ->type_name("MM");
  app->add_option("--smoothing", options->fit.smoothing_mm,
                  "Lets the fit miss each value by this times the point's weight, mm; 0: interpolate")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber)
      ->type_name("MM");
  app->add_flag("--error-bars", options->error_bars,
                "Stay within each point's error_bar of its value instead of meeting it, as smoothly as that allows");
  CLI::Option* reduce =
      app->add_option("--reduce", options->fit.reduction_mm,
                      "Use as few centres as keep all points within this, mm; 0: every point is a centre")
          ->capture_default_str()
          ->check(CLI::NonNegativeNumber)
          ->type_name("MM");
  app->add_option("--slabs", options->fit.slabs, "With --reduce: choose centres slab by slab of z, so many slabs")
      ->capture_default_str()
      ->needs(reduce)
      ->check(CLI::PositiveNumber)
      ->type_name("N");
  app->add_option("--merge", options->fit.merge_mm,
                  "Points nearer to each other than this become one, with their mean value, mm")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber)
      ->type_name("MM");

  command.run = [options](const Progress& progress) {
    // A place that cannot be written is told before the work, not after it.
    StagedOutput output;
    const std::filesystem::path staged = output.stage(options->output);
    RbfValues values = read_values(options->points);
    if (options->error_bars && values.error_bars_mm.empty()) {
      fail("--error-bars: expected a column error_bar, found none in ", options->points.string());
    }
    if (!options->error_bars) values.error_bars_mm.clear();
    const RbfFit fit = fit_rbf(values, options->fit, progress);
    write_rbf(fit.model, staged);
    output.commit();
    Json figures = report_fit(fit.report);
    print_figure("written", options->output.string());
    return figures;
  };
}

}  // namespace spinaltap
