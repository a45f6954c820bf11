#pragma once

#include <sys/wait.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace spinaltap::test {

/// What a run of the program came to.
struct ProgramRun {
  int exit_code = -1;
  std::string output;
  std::string errors;
};

/// Runs a command of the shell in `folder`.
inline ProgramRun run_command(const std::string& command, const std::filesystem::path& folder) {
  const std::filesystem::path errors = folder / ".errors";
  const std::string whole = "cd '" + folder.string() + "' && (" + command + ") 2>'" + errors.string() + "'";
  ProgramRun run;
  FILE* pipe = ::popen(whole.c_str(), "r");
  if (pipe == nullptr) return run;
  char buffer[4096];
  for (std::size_t got = 0; (got = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) run.output.append(buffer, got);
  const int status = ::pclose(pipe);
  run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  std::ostringstream text;
  text << std::ifstream(errors).rdbuf();
  run.errors = text.str();
  std::filesystem::remove(errors);
  return run;
}

/// Runs the program with arguments as a shell splits them, in `folder`. `before` goes in front, for example "ulimit -f
/// 8;".
inline ProgramRun run_program(const std::string& arguments, const std::filesystem::path& folder,
                              const std::string& before = "") {
  return run_command(before + " '" + SPINALTAP_PROGRAM + "' " + arguments, folder);
}

/// Everything below a folder, sorted; hidden and temporary files too.
inline std::vector<std::string> everything_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    names.push_back(entry.path().lexically_relative(folder).string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace spinaltap::test
