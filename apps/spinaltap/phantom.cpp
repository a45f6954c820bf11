#include <memory>

#include "apps/spinaltap/command.h"
#include "apps/spinaltap/phantom_options.h"
#include "core/base/error.h"
#include "core/files/data_files.h"
#include "core/files/phantom_file.h"
#include "vdb/grid/mesh_solid.h"

namespace spinaltap {

void PhantomCommandOptions::add_to(CLI::App& app) {
  ScanOptions& scan = phantom.scan;
  CLI::Option* anatomy_option =
      app.add_option("--anatomy", anatomy, "Measures of the vertebra; default: the shipped phantom/l3.json")
          ->type_name("FILE");
  app.add_option("--mesh", meshes, "Scan this closed surface (STL, PLY, OBJ) and not a vertebra; several as LEVEL=FILE")
      ->excludes(anatomy_option)
      ->type_name("FILE");
  mesh_frame.add_to(app);
  app.add_option("--seed", scan.seed, "Seed of the noise")->capture_default_str()->type_name("N");
  app.add_option("--noise", scan.noise_hu, "Standard deviation of the noise, HU")
      ->capture_default_str()
      ->type_name("HU");
  app.add_option("--slices", scan.slices, "Number of slices")->capture_default_str()->type_name("N");
  app.add_option("--slice-step", scan.slice_step_mm, "Distance between slices, mm")
      ->capture_default_str()
      ->type_name("MM");
  app.add_option("--slice-width", scan.slice_width_mm, "Thickness over which a slice averages, mm")
      ->capture_default_str()
      ->type_name("MM");
  app.add_option("--pixel", scan.pixel_mm, "Pixel size, mm")->capture_default_str()->type_name("MM");
  app.add_option("--size", scan.columns, "Columns and rows of a slice")->capture_default_str()->type_name("N");
  app.add_option("--blur", scan.blur_mm, "Standard deviation of the blur in a slice, mm")
      ->capture_default_str()
      ->type_name("MM");
  app.add_option("--sharpness", scan.sharpness, "Of the kernel: 0 for a soft one, 1 to 3 for bone and lung kernels")
      ->capture_default_str()
      ->type_name("SHARPNESS");
  app.add_option("--surroundings", surroundings, "What the bone lies in")
      ->capture_default_str()
      ->check(CLI::IsMember({"tissue", "air"}));
  app.add_option("--ground-truth-voxel", phantom.ground_truth_voxel_mm, "Voxel of ground_truth.vdb, mm")
      ->capture_default_str()
      ->type_name("MM");
}

std::vector<std::string> PhantomCommandOptions::named_meshes() const {
  const auto is_named = [](const std::string& entry) {
    const std::size_t sign = entry.find('=');
    return sign != std::string::npos && level_from_name(entry.substr(0, sign)).has_value();
  };
  if (meshes.size() == 1 && !is_named(meshes.front())) return {};
  return meshes;
}

Phantom PhantomCommandOptions::make() const {
  if (meshes.size() > 1) fail("expected one mesh, found ", meshes.size());
  if (!meshes.empty()) return {make_mesh_solid(mesh_frame.read(meshes.front())), std::nullopt};
  auto vertebra = std::make_unique<Vertebra>(read_anatomy(anatomy.empty() ? data_file("phantom/l3.json") : anatomy));
  const VertebraGroundTruth ground_truth = vertebra_ground_truth(*vertebra);
  return {std::move(vertebra), ground_truth};
}

PhantomOptions PhantomCommandOptions::output_options() const {
  constexpr double kTissueHu = 40.0;
  constexpr double kAirHu = -1000.0;
  PhantomOptions options = phantom;
  options.scan.rows = options.scan.columns;
  options.scan.surroundings_hu = surroundings == "air" ? kAirHu : kTissueHu;
  return options;
}

void add_phantom(CLI::App& program, Command& command) {
  struct Options {
    std::filesystem::path folder;
    PhantomCommandOptions phantom;
    SpineCommandOptions spine;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* app = add_command(
      program, command, "phantom",
      "Make a virtual CT of an L3 vertebra, a spine, or closed meshes, with the ground truth beside it",
      "Examples: spinaltap phantom l3/ --noise 20 --seed 7\n"
      "          spinaltap phantom spine/ --spine T6-L5 --pixel 0.7 --slice-step 1 --soft-tissue\n"
      "          spinaltap phantom trunk/ --random-trunk 12\n"
      "Writes l3/ct/*.dcm, l3/ground_truth.vdb, l3/ground_truth.json and l3/plan.json; of a spine ct/*.dcm,\n"
      "ground_truth.json and ground_truth_labels.nii.gz.");
  app->add_option("folder", options->folder, "Folder to make")->required()->type_name("FOLDER");
  options->phantom.add_to(*app);
  options->spine.add_to(*app);
  const CLI::Option* slices = app->get_option("--slices");

  command.outputs = [options] { return std::vector{options->folder}; };
  command.run = [options, slices](const Progress& progress) -> Json {
    options->spine.meshes = options->phantom.named_meshes();
    options->spine.mesh_frame = options->phantom.mesh_frame;
    if (options->spine.asked_for()) {
      std::optional<TrunkOptions> trunk;
      if (options->spine.trunk_seed) trunk = random_trunk_options(*options->spine.trunk_seed);
      const std::unique_ptr<Spine> spine = trunk ? std::make_unique<Spine>(trunk->spine) : options->spine.make();
      ScanOptions scan = trunk ? trunk->scan : options->phantom.output_options().scan;
      if (trunk) {
        print_figure("patient", describe(*trunk));
      } else if (slices->count() == 0) {
        // Meshes end at their bone: without a margin the CT would cut them.
        const double beyond_mm = options->spine.meshes.empty() ? 0.0 : 30.0;
        scan.slices = static_cast<int>((spine->bounds_mm().sizes().z() + beyond_mm) / scan.slice_step_mm) + 1;
      }
      if (!options->spine.centre_mm.empty()) scan.centre_mm = Vec3(options->spine.centre_mm.data());
      const std::unique_ptr<Surroundings> surroundings =
          trunk ? std::make_unique<TrunkTissue>(*spine, trunk->tissue) : options->spine.surroundings_of(*spine);
      write_spine_phantom(*spine, surroundings.get(), scan, options->folder, progress);
      print_figure("seed", static_cast<double>(scan.seed), "", 0);
      print_figure("bodies", static_cast<double>(spine->part_count()), "", 0);
      print_figure("written", options->folder.string());
      return read_json(options->folder / "ground_truth.json");
    }
    const Phantom phantom = options->phantom.make();
    write_phantom(*phantom.solid, phantom.ground_truth, options->phantom.output_options(), options->folder, progress);
    Json figures = read_json(options->folder / "ground_truth.json");
    print_figure("seed", static_cast<double>(options->phantom.phantom.scan.seed), "", 0);
    if (phantom.ground_truth) {
      print_figure("pedicle width, left", phantom.ground_truth->left.width_mm, "mm");
      print_figure("pedicle height, left", phantom.ground_truth->left.height_mm, "mm");
    }
    print_figure("written", options->folder.string());
    return figures;
  };
}

}  // namespace spinaltap
