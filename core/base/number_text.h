#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace spinaltap {

/// The number that the whole of `text` is, whatever the locale; nothing when it is none, or beyond a double's range.
/// Blanks around it and a plus sign are let pass. "nan" and "inf" are numbers here.
std::optional<double> parse_number(std::string_view text);

/// The shortest text that gives `number` back exactly, appended to `text`.
void append_number(double number, std::string& text);

/// Without blanks and tabs at both ends.
std::string_view trimmed(std::string_view text);

/// Text out of a file for a message: printable, 40 characters at most.
std::string shown(std::string_view text);
/// As shown(), in quotes.
std::string in_quotes(std::string_view text);

}  // namespace spinaltap
