#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace spinaltap::test {

/// A name that C++ text declares or defines at the scope of a namespace or a class, and the words that its declaration
/// has: what it needs where it is used itself.
struct Declaration {
  std::string name;   ///< empty where nobody calls it by name: operators, macros, specialisations
  std::string owner;  ///< the class whose member it is; empty of a namespace's
  int line = 0;       ///< where the name is, from 1
  bool is_class = false;
  bool is_override = false;        ///< says so
  bool is_root = false;            ///< used whoever names it: main(), C functions for users
  std::vector<std::string> words;  ///< identifiers, not its own name and its qualifiers
};

/// The declarations of a C++ source or header. Enough of C++ for this project's code: a preprocessor's lines are left
/// out, fields belong to their class, and what a class has without a name that is called (constructors, operators,
/// overriding functions) is a declaration of the class's own name.
std::vector<Declaration> declarations(std::string_view text);

}  // namespace spinaltap::test
