#include "core/files/data_files.h"

#include <cstdlib>

#include "core/base/error.h"

namespace spinaltap {
namespace fs = std::filesystem;

fs::path data_file(std::string_view name) {
  const char* chosen = std::getenv("SPINALTAP_DATA_DIR");
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path folder =
      chosen != nullptr ? fs::path(chosen) : program.parent_path().parent_path() / "share/spinaltap";
  fs::path path = folder / name;
  if (!fs::exists(path, error)) fail("shipped file not found: ", path.string(), " (set SPINALTAP_DATA_DIR)");
  return path;
}

}  // namespace spinaltap
