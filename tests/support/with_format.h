#pragma once

#include <string>

namespace spinaltap::test {

/// A text of JSON, an object, with "format" and "version" as its first keys: what files of version 2 begin with.
inline std::string with_format(const std::string& format, std::string text, int version = 2) {
  const std::size_t begin = text.find('{');
  if (begin == std::string::npos) return text;
  const std::string head = "\"format\": \"" + format + "\", \"version\": " + std::to_string(version);
  const bool is_empty = text.find(':') == std::string::npos;
  return text.insert(begin + 1, head + (is_empty ? "" : ", "));
}

}  // namespace spinaltap::test
