#pragma once

#include <string>

namespace spinaltap::test {

/// How often a part stands in a text.
inline std::size_t times_in(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++found;
  return found;
}

}  // namespace spinaltap::test
