#include "core/files/data_files.h"

#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <vector>

#include "core/base/error.h"

namespace spinaltap {
namespace fs = std::filesystem;
namespace {

struct DataFolders {
  std::mutex mutex;
  fs::path set;
  std::vector<fs::path> added;
};
DataFolders& data_folders() {
  static DataFolders folders;
  return folders;
}

std::vector<fs::path> folders_to_search() {
  DataFolders& known = data_folders();
  const std::lock_guard lock(known.mutex);
  if (!known.set.empty()) return {known.set};
  if (const char* chosen = std::getenv("SPINALTAP_DATA_DIR")) return {chosen};
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  std::vector<fs::path> folders{program.parent_path().parent_path() / "share/spinaltap"};
  folders.insert(folders.end(), known.added.begin(), known.added.end());
  return folders;
}

}  // namespace

fs::path data_file(std::string_view name) {
  const std::vector<fs::path> folders = folders_to_search();
  for (const fs::path& folder : folders) {
    std::error_code error;
    if (fs::exists(folder / name, error)) return folder / name;
  }
  std::string looked_in;
  for (const fs::path& folder : folders) looked_in += (looked_in.empty() ? "" : ", ") + folder.string();
  fail("shipped file not found: ", name, ", looked for in ", looked_in, " (SPINALTAP_DATA_DIR may name its folder)");
}

std::vector<std::string> data_names(std::string_view folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(data_file(folder))) {
    if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

void set_data_folder(const fs::path& folder) {
  DataFolders& known = data_folders();
  const std::lock_guard lock(known.mutex);
  known.set = folder;
}

bool add_data_folder(const fs::path& folder) {
  DataFolders& known = data_folders();
  const std::lock_guard lock(known.mutex);
  if (std::find(known.added.begin(), known.added.end(), folder) == known.added.end()) known.added.push_back(folder);
  return true;
}

}  // namespace spinaltap
