#include "apps/spinaltap/did_you_mean.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <numeric>
#include <vector>

#include "core/base/error.h"

namespace spinaltap {
namespace {

/// Damerau (1964): edits of one letter, and swaps of two neighbours; of strings that are not edited twice in one place.
std::size_t edits_between(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before_last, last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    before_last = last;
    last = row;
  }
  return last[b.size()];
}

/// Small letters, with one kind of line, and without those in front.
std::string plain(std::string name) {
  name.erase(0, std::min(name.find_first_not_of('-'), name.size()));
  for (char& letter : name) {
    letter = letter == '_' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  }
  return name;
}

bool is_shown(const CLI::App* app) { return !app->get_name().empty(); }

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands(is_shown)) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

/// The command that was parsed last, within those before it.
const CLI::App& innermost(const CLI::App& program) {
  const CLI::App* app = &program;
  while (!app->get_subcommands().empty()) app = app->get_subcommands().back();
  return *app;
}

/// "spinaltap study submit".
std::string typed_name(const CLI::App& app) {
  const CLI::App* const parent = app.get_parent();
  return (parent == nullptr ? "" : typed_name(*parent) + " ") + app.get_name();
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t n = 0; n < names.size(); ++n) {
    text += (n == 0 ? "" : n + 1 == names.size() ? " and " : ", ") + names[n];
  }
  return text;
}

std::string unknown_option(const CLI::App& program, const CLI::App& app, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  if (name.size() > 1 && (std::isdigit(static_cast<unsigned char>(name[1])) != 0 || name[1] == '.')) {
    return "did not expect " + word + ": join numbers that begin with a minus to their option, --option=" + word;
  }
  const std::vector<std::string> names = option_names(app);
  std::string text = app.get_name() + " has no option " + name;
  if (const std::string near = did_you_mean(name, names); !near.empty()) return text + near;
  std::vector<std::string> others;
  for (const CLI::App* other : program.get_subcommands(is_shown)) {
    if (other->get_option_no_throw(name) != nullptr) others.push_back(other->get_name());
  }
  constexpr std::size_t kMostNamed = 6;
  if (others.empty() || others.size() > kMostNamed) return text;
  return text + ": " + listed(others) + (others.size() == 1 ? " has it" : " have it");
}

std::string unknown_command(const CLI::App& program, const CLI::App& app, const std::string& word) {
  std::vector<std::string> names = command_names(app);
  std::string text = "no such command: " + word;
  if (const std::string near = did_you_mean(word, names); !near.empty()) return text + near;
  for (const CLI::App* command : program.get_subcommands(is_shown)) {
    for (const std::string& name : command_names(*command)) {
      if (name == word) return joined(text, "; did you mean ", command->get_name(), " ", name, "?");
    }
  }
  return text;
}

}  // namespace

std::string nearest_name(const std::string& typed, std::span<const std::string> names) {
  const std::string wanted = plain(typed);
  std::size_t least = std::max<std::size_t>(1, wanted.size() / 3) + 1;
  std::string nearest;
  for (const std::string& name : names) {
    const std::size_t edits = edits_between(wanted, plain(name));
    if (edits >= least || edits >= plain(name).size()) continue;
    least = edits;
    nearest = name;
  }
  if (!nearest.empty()) return nearest;
  // A beginning that one name alone has.
  const auto begins = [&](const std::string& name) { return wanted.size() > 2 && plain(name).starts_with(wanted); };
  return std::ranges::count_if(names, begins) == 1 ? *std::ranges::find_if(names, begins) : "";
}

std::string did_you_mean(const std::string& typed, std::span<const std::string> names) {
  const std::string nearest = nearest_name(typed, names);
  return nearest.empty() ? "" : "; did you mean " + nearest + "?";
}

std::string usage_of(const CLI::App& app) {
  std::string text = typed_name(app);
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_positional()) continue;
    std::string name = option->get_name(true);
    for (char& letter : name) letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
    text += option->get_required() ? " " + name : " [" + name + "]";
  }
  return text;
}

std::string usage_error(const CLI::App& program, const CLI::ParseError& error) {
  const CLI::App& app = innermost(program);
  const std::string help = " (try " + typed_name(app) + " --help)";
  const std::vector<std::string> unexpected = app.remaining();
  const bool is_extra = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
  const bool is_missing = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
  const bool wants_command =
      !app.get_subcommands(is_shown).empty() && (&app == &program || app.get_require_subcommand_min() > 0);
  const auto is_option = [](const std::string& word) { return word.size() > 1 && word.front() == '-'; };
  // The first mistake, not what follows from it: options of a command that is none, an output that is missing where
  // its option was misspelt.
  if (wants_command && !unexpected.empty() && !is_option(unexpected.front())) {
    return unknown_command(program, app, unexpected.front()) + help;
  }
  const auto option = std::ranges::find_if(unexpected, is_option);
  if (option != unexpected.end()) return unknown_option(program, app, *option) + help;
  if (wants_command && is_missing) return "expected a command: " + listed(command_names(app)) + help;
  if (is_extra && !unexpected.empty()) {
    return "did not expect " + unexpected.front() + ": " + usage_of(app) + help;
  }
  return std::string(error.what()) + (is_missing ? ": " + usage_of(app) : "") + help;
}

std::string help_on(const CLI::App& program, std::span<const std::string> words) {
  const CLI::App* app = &program;
  std::string before;
  for (const std::string& word : words) {
    const std::vector<const CLI::App*> commands = app->get_subcommands(is_shown);
    const auto found = std::ranges::find(commands, word, [](const CLI::App* command) { return command->get_name(); });
    if (found == commands.end()) fail(unknown_command(program, *app, word), " (try spinaltap --help)");
    before += (before.empty() ? "" : " ") + app->get_name();
    app = *found;
  }
  // The program's own delegates to the command that was parsed, which is `help`.
  return app->get_formatter()->make_help(app, before.empty() ? app->get_name() : before + " " + app->get_name(),
                                         CLI::AppFormatMode::Normal);
}

}  // namespace spinaltap
