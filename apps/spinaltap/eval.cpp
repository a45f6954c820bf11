#include <algorithm>
#include <memory>
#include <optional>

#include "apps/spinaltap/command.h"
#include "core/base/staged_output.h"
#include "core/rbf/evaluated_file.h"
#include "core/rbf/rbf_field.h"
#include "core/rbf/rbf_file.h"
#include "core/rbf/value_file.h"

namespace spinaltap {

void add_eval(CLI::App& program, Command& command) {
  struct Options {
    std::filesystem::path model;
    std::filesystem::path points;
    std::filesystem::path output = "values.csv";
    bool gradient = false;
    double accuracy_mm = RbfField::kDefaultAccuracy;
    std::optional<double> low_pass_mm;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* app = add_command(program, command, "eval", "Evaluate a fitted radial basis function at points",
                              "Example: spinaltap eval surface.rbf points.csv -o values.csv --gradient\n"
                              "Points are x, y, z in mm, patient LPS: .csv, .csv.gz or .ply. The output has x, y, z,\n"
                              "value (mm, negative inside) and, with --gradient, gx, gy, gz (.ply: nx, ny, nz).");
  app->add_option("model", options->model, "What spinaltap fit wrote")->required()->type_name("FILE");
  app->add_option("points", options->points, "Where to evaluate: .csv, .csv.gz or .ply")->required()->type_name("FILE");
  app->add_option("-o,--output", options->output, "The file to write: .csv or .ply")
      ->capture_default_str()
      ->type_name("FILE");
  app->add_flag("--gradient", options->gradient, "Write the gradient as well");
  app->add_option("--accuracy", options->accuracy_mm, "Largest error of a value, mm")
      ->capture_default_str()
      ->check(CLI::PositiveNumber)
      ->type_name("MM");
  app->add_option("--low-pass", options->low_pass_mm,
                  "Smooth what is evaluated: leave out detail finer than about this, mm (default: as fitted)")
      ->check(CLI::NonNegativeNumber)
      ->type_name("MM");

  command.run = [options](const Progress& progress) {
    check_evaluated_name(options->output);
    StagedOutput output;
    const std::filesystem::path staged = output.stage(options->output);
    RbfModel model = read_rbf(options->model);
    if (options->low_pass_mm) model.low_pass_mm = *options->low_pass_mm;
    const RbfField field(std::move(model), options->accuracy_mm);
    const std::vector<Vec3> points_mm = read_positions(options->points);
    std::vector<double> values_mm(points_mm.size());
    std::vector<Vec3> gradients(options->gradient ? points_mm.size() : 0);
    // Pieces large enough for any method of summation, small enough to be stopped between two.
    constexpr std::size_t kPiece = 1'000'000;
    for (std::size_t begin = 0; begin < points_mm.size(); begin += kPiece) {
      progress.report("evaluating", static_cast<double>(begin) / static_cast<double>(points_mm.size()));
      const std::size_t count = std::min(kPiece, points_mm.size() - begin);
      field.evaluate(std::span(points_mm).subspan(begin, count), std::span(values_mm).subspan(begin, count),
                     options->gradient ? std::span(gradients).subspan(begin, count) : std::span<Vec3>());
    }
    progress.report("evaluating", 1.0);
    write_evaluated({points_mm, values_mm, gradients}, staged);
    output.commit();
    const auto [least, most] = std::minmax_element(values_mm.begin(), values_mm.end());
    print_figure("points", static_cast<double>(points_mm.size()), "", 0);
    print_figure("centres", static_cast<double>(field.model().centres_mm.size()), "", 0);
    print_figure("least value", *least, "mm", 6);
    print_figure("largest value", *most, "mm", 6);
    print_figure("written", options->output.string());
    return Json{{"points", points_mm.size()},
                {"centres", field.model().centres_mm.size()},
                {"least_value_mm", *least},
                {"largest_value_mm", *most}};
  };
}

}  // namespace spinaltap
