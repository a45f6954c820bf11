#include <memory>

#include "apps/spinaltap/command.h"
#include "apps/spinaltap/ct_options.h"
#include "core/base/staged_output.h"

namespace spinaltap {

void add_bake(CLI::App& program, Command& command) {
  struct Options {
    CtOptions ct;
    std::filesystem::path output = "bone.vdb";
  };
  const auto options = std::make_shared<Options>();
  CLI::App* app = add_command(program, command, "bake", "Make bone.vdb (distance and CT numbers) from a CT",
                              "Example: spinaltap bake ct/ --labels vertebrae.nii.gz --label 22 -o bone.vdb");
  app->add_option("ct", options->ct.folder, "Folder with a DICOM CT series, or a NIfTI file")
      ->required()
      ->type_name("PATH");
  app->add_option("-o,--output", options->output, "The .vdb file to write")->capture_default_str()->type_name("FILE");
  options->ct.add_reading(*app);
  options->ct.add_baking(*app);

  command.run = [options](const Progress& progress) {
    const CtVolume ct = options->ct.read(progress);
    const BakedCt baked = options->ct.make_bone(ct, progress);
    StagedOutput output;
    write_bone(baked.bone, output.stage(options->output));
    output.commit();
    Json figures = report_baked(ct, baked);
    print_figure("written", options->output.string());
    return figures;
  };
}

}  // namespace spinaltap
