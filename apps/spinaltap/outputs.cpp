#include <algorithm>
#include <map>
#include <string_view>

#include "apps/spinaltap/command.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;

/// Options that name a file to write, whatever the command.
constexpr std::array kFileOptions{"--json", "--report", "--picture", "--contact-sheet", "--events", "--plot", "--csv"};

/// What commands write into the folder of their -o. A study's folder is not here: a study goes on in it.
const std::map<std::string_view, std::vector<const char*>>& files_in_folders() {
  static const std::vector<const char*> drilled{StagedOutput::kListName, "report.html", "drilled.vdb",
                                                "drilled.stl",           "log.csv",     "events.csv"};
  static const std::map<std::string_view, std::vector<const char*>> files{
      {"drill", drilled},
      {"demo", {"phantom", "bone.vdb", "bone.stl", "plan.json", "report.html"}},
      {"grade", {"report.html", "grade.json", "grade.csv"}},
      {"study", {}},
      {"merge", {"runs.csv", "summary.json", "breach_map.csv", "report.html"}},
  };
  return files;
}

/// The option's value, given or default; empty where it has none or the command has no such option.
fs::path path_of(const CLI::App& app, const std::string& name) {
  const CLI::Option* const option = app.get_option_no_throw(name);
  if (option == nullptr || (option->count() == 0 && option->get_default_str().empty())) return {};
  return option->as<fs::path>();
}

bool is_there(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(path, error);
  if (!fs::exists(status)) return false;
  return !fs::is_directory(status) || !fs::is_empty(path, error);
}

}  // namespace

std::vector<fs::path> outputs_of(const Command& command) {
  const CLI::App& app = *command.app;
  std::vector<fs::path> outputs = command.outputs ? command.outputs() : std::vector<fs::path>();
  for (const char* option : kFileOptions) outputs.push_back(path_of(app, option));
  const auto in_folder = files_in_folders().find(app.get_name());
  const fs::path output = path_of(app, "--output");
  if (in_folder != files_in_folders().end() && !output.empty()) {
    for (const char* name : in_folder->second) outputs.push_back(output / name);
  } else if (!command.outputs) {
    outputs.push_back(output);
  }
  std::erase_if(outputs, [](const fs::path& path) { return path.empty(); });
  return outputs;
}

void check_outputs(const Command& command) {
  for (const fs::path& path : outputs_of(command)) {
    if (!command.is_forced && is_there(path)) {
      fail(path.string(), " is there already: expected another name, or --force to replace it");
    }
  }
  if (!command.json_file.empty()) StagedOutput().write(command.json_file, "{}");
}

}  // namespace spinaltap
