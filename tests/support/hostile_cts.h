#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

namespace spinaltap::test {

/// Something that is not a good CT, and what the rejection must say.
struct HostileCt {
  std::string name;  ///< in letters
  /// Makes it in an empty folder and gives the path to read.
  std::function<std::filesystem::path(const std::filesystem::path& folder)> make;
  std::string word;  ///< in the message

  friend void PrintTo(const HostileCt& hostile, std::ostream* out) { *out << hostile.name; }
};

std::vector<HostileCt> hostile_cts();

}  // namespace spinaltap::test
