#pragma once

#include <span>
#include <string>
#include <vector>

namespace spinaltap::test {

struct Source {
  std::string name;
  std::string text;
};

struct UnusedName {
  std::string name;  ///< "Class::member" of a member
  std::string source;
  int line = 0;
};

/// What sources declare and nothing that runs needs: classes, functions, constants and other names. What runs is
/// main(), C functions, what macros and operators have, and on from there whatever is named; what only names itself, or
/// is named only by what is unused, is unused. `kept`: names that are used by others. Names are words here: of two
/// functions of one name, one that is used keeps the other.
std::vector<UnusedName> unused_names(std::span<const Source> sources, std::span<const std::string> kept);

}  // namespace spinaltap::test
