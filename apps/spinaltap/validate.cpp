#include <cstdio>
#include <memory>

#include "apps/report/validation_report.h"
#include "apps/spinaltap/command.h"
#include "core/base/staged_output.h"
#include "core/files/data_files.h"
#include "core/files/material_file.h"
#include "core/validation/force_validation.h"

namespace spinaltap {

void add_validate(CLI::App& program, Command& command) {
  struct Options {
    std::filesystem::path material, measurements, csv, plot;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* app =
      add_command(program, command, "validate", "Hold the laws of drilling forces against every published measurement",
                  "Example: spinaltap validate --csv validation.csv --plot validation.svg\n"
                  "Each source is left out of the fit that predicts it. What a source does not say (bit, "
                  "speed, feed, density) is spread over what is usual; of a range the middle counts.");
  app->add_option("--material", options->material, "A cutting model to hold against them as it is, with its band")
      ->type_name("FILE");
  app->add_option("--measurements", options->measurements, "Other measurements than the shipped ones")
      ->type_name("FOLDER");
  app->add_option("--csv", options->csv, "Write the table as CSV")->type_name("FILE");
  app->add_option("--plot", options->plot, "Write a plot, .svg, of the law that does better")->type_name("FILE");

  command.run = [options](const Progress& progress) {
    const Measurements measurements =
        options->measurements.empty() ? shipped_measurements() : read_measurements(options->measurements);
    const Material material =
        read_material(options->material.empty() ? data_file("materials/vertebra.json") : options->material, {});
    const ForceValidation validation = validate_forces(measurements, material, {}, progress);
    StagedOutput output;
    if (!options->csv.empty()) output.write(options->csv, validation_csv(measurements, validation));
    if (!options->plot.empty()) output.write(options->plot, svg_plot_file(validation_plot(validation.better())));
    output.commit();
    std::fputs(validation_text(measurements, validation).c_str(), stdout);
    print_figure("better law, sources left out", std::string(name_of(validation.better().law)));
    for (const std::filesystem::path& file : {options->csv, options->plot}) {
      if (!file.empty()) print_figure("written", file.string());
    }
    return validation_json(measurements, validation);
  };
}

}  // namespace spinaltap
