#pragma once

#include <string>
#include <vector>

namespace spinaltap {

/// What a program of others came to.
struct ProcessResult {
  bool is_found = false;  ///< the program is there
  int exit_code = -1;     ///< 128 and the signal, where one ended it
  std::string output;
  std::string errors;
};

/// Runs a program of the PATH with these words, the first its name, and waits for it; no shell reads them. Throws Error
/// where the computer cannot start one.
ProcessResult run_process(const std::vector<std::string>& words);

/// The words as a shell takes them: quoted where they need it.
std::string shell_words(const std::vector<std::string>& words);

}  // namespace spinaltap
