#include <memory>

#include "apps/common/bake_cache.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/ct_options.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"

namespace spinaltap {

void add_bake(CLI::App& program, Command& command) {
  struct Options {
    CtOptions ct;
    std::filesystem::path output = "bone.vdb";
    std::filesystem::path cache;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* app = add_command(program, command, "bake", "Make bone.vdb (distance and CT numbers) from a CT",
                              "Example: spinaltap bake ct/ --labels vertebrae.nii.gz --label 22 -o bone.vdb");
  app->add_option("ct", options->ct.folder, "Folder with a DICOM CT series, or a NIfTI file")
      ->required()
      ->type_name("PATH");
  app->add_option("-o,--output", options->output, "The .vdb file to write")->capture_default_str()->type_name("FILE");
  app->add_option(
         "--cache", options->cache,
         "Folder to keep finished stages in, for bakes with other options; default: OUTPUT.cache, from which a "
         "stopped bake goes on, removed at the end")
      ->type_name("FOLDER");
  options->ct.add_reading(*app);
  options->ct.add_baking(*app);

  command.run = [options](const Progress& progress) {
    // Before the work: a place that cannot be written to is said at once.
    StagedOutput output;
    const std::filesystem::path staged = output.stage(options->output);
    const CtVolume ct = options->ct.read(progress);
    const bool keep_cache = !options->cache.empty();
    options->ct.bake.cache = keep_cache ? options->cache : std::filesystem::path(options->output.string() + ".cache");
    const auto remove_cache = [&] {
      if (!keep_cache) BakeCache(options->ct.bake.cache).remove();
    };
    try {
      const BakedCt baked = options->ct.make_bone(ct, progress);
      write_bone(baked.bone, staged);
      output.commit();
      remove_cache();
      Json figures = report_baked(ct, baked);
      print_figure("written", options->output.string());
      return figures;
    } catch (const Cancelled&) {
      throw;  // the next run goes on from what is finished
    } catch (...) {
      remove_cache();
      throw;
    }
  };
}

}  // namespace spinaltap
