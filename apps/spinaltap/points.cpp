#include <algorithm>
#include <memory>

#include "apps/spinaltap/command.h"
#include "apps/spinaltap/ct_options.h"
#include "apps/spinaltap/input_warnings.h"
#include "apps/spinaltap/level_output.h"
#include "core/base/staged_output.h"
#include "core/surface/surface_samples.h"

namespace spinaltap {

void add_points(CLI::App& program, Command& command) {
  struct Options {
    CtOptions ct;
    SampleOptions sample;
    std::filesystem::path output = "points.ply";
  };
  const auto options = std::make_shared<Options>();
  CLI::App* app = add_command(program, command, "points", "Write a bone's surface and off-surface points as PLY",
                              "Example: spinaltap points ct/ --seed-point -9,222,-638 --method contours -o t11.ply\n"
                              "Each point has x, y, z (mm, patient LPS), nx, ny, nz and value: 0 on the surface,\n"
                              "otherwise the signed distance from it, mm, positive outside.");
  app->add_option("ct", options->ct.folder, "Folder with a DICOM CT series, or a NIfTI, NRRD or MetaImage file")
      ->required()
      ->type_name("PATH");
  app->add_option("-o,--output", options->output, "The .ply file to write")->capture_default_str()->type_name("FILE");
  app->add_option("--method", options->sample.method,
                  "pixels: voxel centres and their neighbours; normals: voxel centres and estimated normals; contours "
                  "(default): sub-pixel edges")
      ->transform(one_of(point_methods()))
      ->type_name("NAME");
  app->add_option("--off-surface", options->sample.off_surface_mm,
                  "Distance of off-surface points along normals, mm; less where another part is near")
      ->capture_default_str()
      ->check(CLI::PositiveNumber)
      ->type_name("MM");
  options->ct.add_reading(*app);
  options->ct.add_choosing(*app);

  command.run = [options, &command](const Progress& progress) {
    const CtVolume ct = options->ct.read(progress);
    const ChosenBone bone = options->ct.choose(ct, progress);
    const SurfaceSamples samples = sample_surface(ct, bone.mask, options->sample, progress);
    StagedOutput output;
    write_points(samples, output.stage(options->output));
    output.commit();
    const std::size_t off_surface = samples.positions_mm.size() - samples.surface_count;
    print_figure("surface points", static_cast<double>(samples.surface_count), "", 0);
    print_figure("off-surface points", static_cast<double>(off_surface), "", 0);
    print_figure("pixels without a direction, dropped", static_cast<double>(samples.dropped), "", 0);
    print_figure("no room off the surface", static_cast<double>(samples.without_off), "", 0);
    print_figure("written", options->output.string());
    Json figures{{"surface_points", samples.surface_count},
                 {"off_surface_points", off_surface},
                 {"dropped", samples.dropped},
                 {"without_off_surface_point", samples.without_off},
                 {"ct_hash", ct.source_hash}};
    const bool accepts_warnings = options->ct.finding.accepts_warnings;
    report_input_warnings(ct.warnings, figures);
    command.exit_code = say_input_warnings(ct.warnings, accepts_warnings);
    print_warnings(bone.warnings);
    figures["warnings"] = bone.warnings.warnings;
    figures["severity"] = bone.warnings.severity;
    const std::string name = bone.found ? bone.found->report.name : level_name(bone.level);
    command.exit_code = std::max(command.exit_code, say_suspect(name, bone.warnings, accepts_warnings));
    return figures;
  };
}

}  // namespace spinaltap
