#include "vdb/grid/diff_grids.h"

#include <cmath>
#include <memory>

#include "apps/spinaltap/command.h"
#include "core/base/text_writer.h"

namespace spinaltap {
namespace {

std::string text_of(const std::array<int, 3>& index) {
  TextWriter text;
  text << '(' << index[0] << ", " << index[1] << ", " << index[2] << ')';
  return text.str();
}

Json json_of(const ActiveVoxels& active) {
  return {{"active_voxels", active.count}, {"low", active.low}, {"high", active.high}};
}

Json json_of(const GridDifference& grid) {
  Json json{{"name", grid.name}, {"same", grid.same}};
  json["a"] = grid.in_a ? json_of(grid.a) : Json();
  json["b"] = grid.in_b ? json_of(grid.b) : Json();
  if (!grid.in_a || !grid.in_b) return json;
  json["only_in_a"] = grid.only_in_a;
  json["only_in_b"] = grid.only_in_b;
  json["same_transform"] = grid.same_transform;
  json["same_background"] = grid.same_background;
  json["compared"] = grid.compared;
  json["different"] = grid.different;
  json["inactive_different"] = grid.inactive_different;
  json["l1"] = number_or_null(grid.l1);
  json["l2"] = number_or_null(grid.l2);
  json["linf"] = number_or_null(grid.linf);
  json["metadata"] = grid.metadata;
  if (grid.first) {
    json["first"] = {{"index", grid.first->index},
                     {"position_mm", to_json(grid.first->position_mm)},
                     {"a", number_or_null(static_cast<double>(grid.first->a))},
                     {"b", number_or_null(static_cast<double>(grid.first->b))}};
  }
  return json;
}

void print_active(const std::string& which, const ActiveVoxels& active) {
  TextWriter text;
  text << active.count << " from " << text_of(active.low) << " to " << text_of(active.high);
  print_figure("  active voxels of " + which, text.str());
}

void print(const GridDifference& grid) {
  print_figure("grid " + grid.name, !grid.in_a   ? "only in the second file"
                                    : !grid.in_b ? "only in the first file"
                                    : grid.same  ? "same"
                                                 : "different");
  if (grid.in_a) print_active("the first", grid.a);
  if (grid.in_b) print_active("the second", grid.b);
  if (!grid.in_a || !grid.in_b) return;
  print_figure("  active in the first only", static_cast<double>(grid.only_in_a), "", 0);
  print_figure("  active in the second only", static_cast<double>(grid.only_in_b), "", 0);
  if (!grid.same_transform) print_figure("  transform", "different");
  if (!grid.same_background) print_figure("  background", "different");
  print_figure("  voxels that differ", static_cast<double>(grid.different), "", 0);
  if (grid.inactive_different > 0) {
    print_figure("  inactive voxels that differ", static_cast<double>(grid.inactive_different), "", 0);
  }
  print_figure("  L1, mean", grid.l1, "", 9);
  print_figure("  L2, root mean square", grid.l2, "", 9);
  print_figure("  L-infinity, largest", grid.linf, "", 9);
  if (grid.first) {
    const VoxelDifference& first = *grid.first;
    TextWriter text;
    text << text_of(first.index) << " at " << first.position_mm.x() << ", " << first.position_mm.y() << ", "
         << first.position_mm.z() << " mm: " << first.a << " and " << first.b;
    print_figure("  first that differs", text.str());
  }
  for (const std::string& name : grid.metadata) print_figure("  metadata that differ", name);
}

}  // namespace

void add_diff(CLI::App& program, Command& command) {
  struct Options {
    std::filesystem::path a;
    std::filesystem::path b;
    DiffOptions diff;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* app = add_command(program, command, "diff", "Compare the grids of two .vdb files",
                              "Example: spinaltap diff before.vdb after.vdb --tolerance 1e-4\n"
                              "Grids of floats of any program, by name. The exit code is 0 where they are the same,\n"
                              "1 where they differ, 2 where a file cannot be read.");
  app->add_option("a", options->a, "The first file")->required()->type_name("FILE");
  app->add_option("b", options->b, "The second file")->required()->type_name("FILE");
  app->add_option("--tolerance", options->diff.tolerance,
                  "Largest difference of two values that counts as none, in the grid's unit")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber)
      ->type_name("X");

  command.run = [options, &command](const Progress&) -> Json {
    const std::vector<GridDifference> grids = diff_grids(options->a, options->b, options->diff);
    bool same = true;
    Json list = Json::array();
    for (const GridDifference& grid : grids) {
      print(grid);
      list.push_back(json_of(grid));
      same = same && grid.same;
    }
    command.exit_code = same ? kDone : kAnswerIsNo;
    return {{"same", same}, {"tolerance", options->diff.tolerance}, {"grids", list}};
  };
}

}  // namespace spinaltap
