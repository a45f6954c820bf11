#pragma once

#include <istream>
#include <string>
#include <vector>

namespace spinaltap {

class MainWindow;

/// A line of a script: a command and its words.
struct ScriptLine {
  int number = 0;  ///< in the file, from 1; 0: of the command line
  std::string command;
  std::vector<std::string> words;
};

/// Splits lines into words: by blanks, "..." holds blanks, # begins a comment. Throws Error that names file and line.
std::vector<ScriptLine> read_script(std::istream& text, const std::string& file);

/// What scripts may say, for --help.
std::string script_help();

/// Does what the script says, as a person at the window would: each line begins when the one before has ended and is
/// drawn. Relative names of files are those of the current folder. Throws Error that names file and line.
void run_script(MainWindow& window, const std::vector<ScriptLine>& lines, const std::string& file);

}  // namespace spinaltap
