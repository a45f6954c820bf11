#include <memory>

#include "apps/report/study_report.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/study_output.h"
#include "core/files/study_summary_json.h"
#include "vdb/sim/study.h"

namespace spinaltap {
namespace {

struct MergeOptions {
  std::vector<std::filesystem::path> folders;
  std::filesystem::path folder;
};

Json run_merge(const MergeOptions& options) {
  const StudyTable table = spinaltap::merge(options.folders);
  const std::filesystem::path output = options.folder.empty() ? options.folders.front() : options.folder;
  if (table.is_whole()) open_study_folder(output, table.identity);
  const StudySummary summary = write_study_results(output, table.identity, table.rows);
  print_study(summary, output);
  return to_json(summary);
}

}  // namespace

void add_merge(CLI::App& program, Command& command) {
  const auto options = std::make_shared<MergeOptions>();
  CLI::App* app = add_command(program, command, "merge",
                              "Join the shards of a study: the same files, byte for byte, as from one run of it",
                              "Example: spinaltap merge one/ two/ -o study/");
  app->add_option("folders", options->folders, "Folders that study wrote")->required()->type_name("FOLDER");
  app->add_option("-o,--output", options->folder, "Folder for the results; default: the first")->type_name("FOLDER");
  command.outputs = [options]() -> std::vector<std::filesystem::path> {
    if (!options->folder.empty()) return {};
    const std::filesystem::path& folder = options->folders.front();
    return {folder / "runs.csv", folder / "summary.json", folder / "breach_map.csv", folder / "report.html"};
  };
  command.run = [options](const Progress&) { return run_merge(*options); };
}

}  // namespace spinaltap
