#include <memory>
#include <optional>
#include <sstream>

#include "apps/common/bit_shapes.h"
#include "apps/common/bone_path.h"
#include "apps/common/plan_file.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/path_options.h"
#include "core/base/error.h"

namespace spinaltap {

void PathOptions::add_to(CLI::App& app) {
  CLI::Option* entry_option =
      app.add_option("--entry", entry_mm, "Entry on the bone's surface: x,y,z in patient LPS, mm")
          ->delimiter(',')
          ->expected(3)
          ->type_name("X,Y,Z");
  app.add_option("--target", target_mm, "Target inside the bone: x,y,z in patient LPS, mm")
      ->delimiter(',')
      ->expected(3)
      ->needs(entry_option)
      ->type_name("X,Y,Z");
  app.add_option("--diameter", bit.diameter_mm, "Diameter of the bit, mm")->capture_default_str()->type_name("MM");
  app.add_option("--bit-length", bit.length_mm, "Length of the bit, tip included, mm")
      ->capture_default_str()
      ->type_name("MM");
  app.add_option("--tip-length", bit.tip_length_mm, "Length of the bit's conical tip, mm")
      ->capture_default_str()
      ->type_name("MM");
  app.add_option("--shape", bit.shape, "Shape of the bit: drill (default), round-burr, conical-burr, tapered-screw")
      ->transform(CLI::CheckedTransformer(bit_shapes()))
      ->type_name("NAME");
  app.add_option("--tip-diameter", bit.tip_diameter_mm,
                 "Diameter of the very tip, mm: a twist drill's chisel edge, a conical burr's or a screw's end")
      ->capture_default_str()
      ->type_name("MM");
  app.add_option("--shank-diameter", bit.shank_diameter_mm, "Diameter of a burr's shank, mm")
      ->capture_default_str()
      ->type_name("MM");
}

std::optional<DrillPath> PathOptions::given_path(const std::string& name) const {
  if (entry_mm.empty()) return std::nullopt;
  if (target_mm.empty()) fail("--entry was given: expected --target x,y,z too");
  DrillPath path{name, Vec3(entry_mm[0], entry_mm[1], entry_mm[2]), Vec3(target_mm[0], target_mm[1], target_mm[2]),
                 bit};
  check_path(path);
  return path;
}

Json report_paths(const std::vector<DrillPath>& paths) {
  Json list = Json::array();
  for (const DrillPath& path : paths) {
    std::ostringstream text;
    text.precision(4);
    text << "(" << path.entry_mm.x() << ", " << path.entry_mm.y() << ", " << path.entry_mm.z() << ") to ("
         << path.target_mm.x() << ", " << path.target_mm.y() << ", " << path.target_mm.z() << "), " << path.length_mm()
         << " mm";
    print_figure("path " + path.name, text.str());
    list.push_back({{"name", path.name},
                    {"entry_mm", to_json(path.entry_mm)},
                    {"target_mm", to_json(path.target_mm)},
                    {"length_mm", path.length_mm()}});
  }
  return {{"paths", list}};
}

void add_plan(CLI::App& program, Command& command) {
  struct Options {
    std::filesystem::path bone;
    std::filesystem::path output = "plan.json";
    std::string name = "path";
    PathOptions path;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* app = add_command(program, command, "plan",
                              "Write a plan: from given points, or the widest straight way into the vertebral body",
                              "Examples: spinaltap plan bone.vdb --entry 18,42,3 --target 9,-6,5 -o plan.json\n"
                              "          spinaltap plan bone.vdb -o plan.json\n"
                              "A phantom brings its own plan.json along.");
  app->add_option("bone", options->bone, "bone.vdb")->required()->type_name("FILE");
  app->add_option("-o,--output", options->output, "The plan to write")->capture_default_str()->type_name("FILE");
  app->add_option("--name", options->name, "Name of the path")->capture_default_str();
  options->path.add_to(*app);

  command.run = [options](const Progress& progress) {
    const BoneModel bone = read_bone(options->bone);
    std::optional<DrillPath> path = options->path.given_path(options->name);
    if (path) {
      check_path_meets_bone(*path, bone);
    } else {
      path = suggest_path(bone, options->path.bit, progress);
      path->name = options->name;
    }
    write_plan({*path}, options->output);
    Json figures = report_paths({*path});
    print_figure("written", options->output.string());
    return figures;
  };
}

}  // namespace spinaltap
