#include <algorithm>
#include <memory>
#include <optional>

#include "apps/spinaltap/command.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/rbf/evaluated_file.h"
#include "core/rbf/field_volume.h"
#include "core/rbf/rbf_field.h"
#include "core/rbf/rbf_file.h"
#include "core/rbf/value_file.h"

namespace spinaltap {

namespace {

struct EvalOptions {
  std::filesystem::path model;
  std::filesystem::path points;
  std::filesystem::path output = "values.csv";
  bool gradient = false;
  double accuracy_mm = RbfField::kDefaultAccuracy;
  std::optional<double> low_pass_mm;
  std::optional<double> grid_mm;
};

/// Evaluates at the points of a file and writes them with their values.
ValueRange evaluate_points(const RbfField& field, const std::vector<Vec3>& points_mm, bool wants_gradients,
                           const std::filesystem::path& staged, const Progress& progress) {
  std::vector<double> values_mm(points_mm.size());
  std::vector<Vec3> gradients(wants_gradients ? points_mm.size() : 0);
  // Pieces large enough for any method of summation, small enough to be stopped between two.
  constexpr std::size_t kPiece = 1'000'000;
  for (std::size_t begin = 0; begin < points_mm.size(); begin += kPiece) {
    progress.report("evaluating", static_cast<double>(begin) / static_cast<double>(points_mm.size()));
    const std::size_t count = std::min(kPiece, points_mm.size() - begin);
    field.evaluate(std::span(points_mm).subspan(begin, count), std::span(values_mm).subspan(begin, count),
                   wants_gradients ? std::span(gradients).subspan(begin, count) : std::span<Vec3>());
  }
  progress.report("evaluating", 1.0);
  write_evaluated({points_mm, values_mm, gradients}, staged);
  const auto [min, largest] = std::minmax_element(values_mm.begin(), values_mm.end());
  return {*min, *largest};
}

/// Rejects options that do not go together before anything is read.
void check_options(const EvalOptions& options) {
  if (options.points.empty() != options.grid_mm.has_value()) {
    fail("expected either points or --grid, found ", options.grid_mm ? "both" : "neither");
  }
  if (!options.grid_mm) {
    check_evaluated_name(options.output);
  } else if (options.output.extension() != ".nrrd" || options.gradient) {
    fail("--grid: expected values alone and an output that ends in .nrrd, found ",
         options.gradient ? "--gradient" : options.output.string());
  }
}

Json evaluate(const EvalOptions& options, const Progress& progress) {
  check_options(options);
  StagedOutput output;
  const std::filesystem::path staged = output.stage(options.output);
  RbfModel model = read_rbf(options.model);
  if (options.low_pass_mm) model.low_pass_mm = *options.low_pass_mm;
  const RbfField field(std::move(model), options.accuracy_mm);
  const std::size_t centres = field.model().centres_mm.size();
  std::size_t points = 0;
  ValueRange range;
  if (options.grid_mm) {
    const GridGeometry lattice = lattice_over(field.model().centres_mm, *options.grid_mm);
    points = lattice.voxel_count();
    range = write_field_volume(field, lattice, staged, progress);
  } else {
    const std::vector<Vec3> points_mm = read_positions(options.points);
    points = points_mm.size();
    range = evaluate_points(field, points_mm, options.gradient, staged, progress);
  }
  output.commit();
  print_figure("points", static_cast<double>(points), "", 0);
  print_figure("centres", static_cast<double>(centres), "", 0);
  print_figure("min value", range.min_mm, "mm", 6);
  print_figure("largest value", range.largest_mm, "mm", 6);
  print_figure("written", options.output.string());
  return {
      {"points", points}, {"centres", centres}, {"min_value_mm", range.min_mm}, {"largest_value_mm", range.largest_mm}};
}

}  // namespace

void add_eval(CLI::App& program, Command& command) {
  const auto options = std::make_shared<EvalOptions>();
  CLI::App* app = add_command(program, command, "eval", "Evaluate a fitted radial basis function at points",
                              "Example: spinaltap eval surface.rbf points.csv -o values.csv --gradient\n"
                              "Points are x, y, z in mm, patient LPS: .csv, .csv.gz or .ply. The output has x, y, z,\n"
                              "value (mm, negative inside) and, with --gradient, gx, gy, gz (.ply: nx, ny, nz).\n"
                              "With --grid 0.5 -o field.nrrd instead of points: a volume for 3D Slicer or ParaView.");
  app->add_option("model", options->model, "What spinaltap fit wrote")->required()->type_name("FILE");
  app->add_option("points", options->points, "Where to evaluate: .csv, .csv.gz or .ply")->type_name("FILE");
  app->add_option("-o,--output", options->output, "The file to write: .csv or .ply; .nrrd with --grid")
      ->capture_default_str()
      ->type_name("FILE");
  app->add_flag("--gradient", options->gradient, "Write the gradient as well");
  app->add_option("--grid", options->grid_mm, "Instead of points: a lattice with this step over the centres' box, mm")
      ->check(CLI::PositiveNumber)
      ->type_name("MM");
  app->add_option("--accuracy", options->accuracy_mm, "Largest error of a value, mm")
      ->capture_default_str()
      ->check(CLI::PositiveNumber)
      ->type_name("MM");
  app->add_option("--low-pass", options->low_pass_mm,
                  "Smooth what is evaluated: leave out detail finer than about this, mm (default: as fitted)")
      ->check(CLI::NonNegativeNumber)
      ->type_name("MM");

  command.run = [options](const Progress& progress) { return evaluate(*options, progress); };
}

}  // namespace spinaltap
