#include "apps/spinaltap-planner/script/planner_script.h"
#include "core/base/error.h"

namespace spinaltap {
namespace {

std::vector<std::string> words_of(const std::string& line, const std::string& where) {
  std::vector<std::string> words;
  std::string word;
  bool is_word = false, is_quoted = false;
  for (const char c : line) {
    if (c == '"') {
      is_quoted = !is_quoted;
      is_word = true;
    } else if (!is_quoted && (c == ' ' || c == '\t' || c == '\r')) {
      if (is_word) words.push_back(word);
      word.clear();
      is_word = false;
    } else if (!is_quoted && c == '#') {
      break;
    } else {
      word += c;
      is_word = true;
    }
  }
  if (is_quoted) fail(where, ": expected a closing \"");
  if (is_word) words.push_back(word);
  return words;
}

}  // namespace

std::vector<ScriptLine> read_script(std::istream& text, const std::string& file) {
  std::vector<ScriptLine> lines;
  int number = 0;
  for (std::string line; std::getline(text, line);) {
    ++number;
    std::vector<std::string> words = words_of(line, file + ", line " + std::to_string(number));
    if (words.empty()) continue;
    std::string command = std::move(words.front());
    words.erase(words.begin());
    lines.push_back({number, std::move(command), std::move(words)});
  }
  return lines;
}

}  // namespace spinaltap
