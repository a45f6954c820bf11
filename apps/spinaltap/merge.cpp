#include <memory>

#include "apps/report/study_results.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/study_output.h"
#include "core/base/error.h"
#include "core/files/study_summary_json.h"

namespace spinaltap {
namespace {

struct MergeOptions {
  std::vector<std::filesystem::path> folders;
  std::filesystem::path folder;
};

Json merge(const MergeOptions& options) {
  const StudyIdentity identity = read_study_identity(options.folders.front());
  StudyRows rows;
  for (const std::filesystem::path& folder : options.folders) {
    if (read_study_identity(folder).study != identity.study) {
      fail("expected shards of one study, found one study in ", options.folders.front().string(), " and another in ",
           folder.string());
    }
    read_study_parts(folder, identity, rows);
  }
  const std::filesystem::path output = options.folder.empty() ? options.folders.front() : options.folder;
  if (rows.size() == identity.runs) open_study_folder(output, identity);
  const StudySummary summary = write_study_results(output, identity, rows);
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
  command.run = [options](const Progress&) { return merge(*options); };
}

}  // namespace spinaltap
