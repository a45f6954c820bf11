#pragma once

#include <CLI/CLI.hpp>

#include <span>
#include <string>

namespace spinaltap {

/// The name nearest to what was typed, by letters that are left out, put in, exchanged or swapped with the next; empty
/// where none is near: more than a third of the letters are wrong.
std::string nearest_name(const std::string& typed, std::span<const std::string> names);

/// "; did you mean bake?", or nothing where no name is near.
std::string did_you_mean(const std::string& typed, std::span<const std::string> names);

/// A command as it is typed, with the names of its arguments: "spinaltap drill BONE PLAN".
std::string usage_of(const CLI::App& app);

/// What a mistake on the command line is, on one line, for who typed it. `program`: as its parse() left it.
std::string usage_error(const CLI::App& program, const CLI::ParseError& error);

/// The help of a command: `words` are its name, and its own command's where it has some. Throws Error where it is none.
std::string help_on(const CLI::App& program, std::span<const std::string> words);

}  // namespace spinaltap
