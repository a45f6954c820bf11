#include "core/base/staged_output.h"

#include <signal.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <system_error>

#include "core/base/error.h"

namespace spinaltap {
namespace fs = std::filesystem;
namespace {

/// Makes a folder and those above it, and adds what it made to `made`, the uppermost first.
void make_folders(const fs::path& wanted, std::vector<fs::path>& made) {
  std::error_code error;
  std::vector<fs::path> missing;
  for (fs::path folder = wanted; !folder.empty() && !fs::exists(folder, error); folder = folder.parent_path()) {
    missing.push_back(folder);
  }
  for (auto folder = missing.rbegin(); folder != missing.rend(); ++folder) {
    if (!fs::create_directory(*folder, error) && error) {
      fail("cannot make the folder ", folder->string(), ": ", error.message());
    }
    made.push_back(*folder);
  }
}

/// Deepest first; a folder that something else has been put into stays.
void remove_empty_folders(const std::vector<fs::path>& made) {
  std::error_code ignored;
  for (auto folder = made.rbegin(); folder != made.rend(); ++folder) fs::remove(*folder, ignored);
}

/// `prefix` and who writes: the machine and its process.
std::string partial_prefix(const std::string& prefix) {
  std::array<char, 256> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0) return prefix;
  return prefix + host.data() + "-";
}

/// A temporary name beside a file.
fs::path partial_path(const fs::path& parent, const std::string& prefix) {
  return parent / (partial_prefix(prefix) + std::to_string(::getpid()));
}

/// Removes what killed processes of this machine left under such names.
void remove_stale(const fs::path& parent, const std::string& prefix) {
  const std::string ours = partial_prefix(prefix);
  const fs::path folder = parent.empty() ? fs::path(".") : parent;
  std::error_code ignored;
  std::vector<fs::path> stale;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(ours)) continue;
    long process = 0;
    const char* const end = name.data() + name.size();
    const auto [rest, error] = std::from_chars(name.data() + ours.size(), end, process);
    if (error != std::errc() || rest != end || process <= 0) continue;
    if (::kill(static_cast<pid_t>(process), 0) != 0 && errno == ESRCH) stale.push_back(entry.path());
  }
  for (const fs::path& path : stale) fs::remove_all(path, ignored);
}

}  // namespace

StagedOutput::~StagedOutput() {
  std::error_code ignored;
  for (const Entry& entry : entries_) fs::remove(entry.temporary, ignored);
  remove_empty_folders(made_folders_);
}

fs::path StagedOutput::stage(const fs::path& final_path) {
  std::error_code error;
  if (final_path.filename().empty() || fs::is_directory(final_path, error)) {
    fail("expected the name of a file to write, found a folder: ", final_path.string());
  }
  make_folders(final_path.parent_path(), made_folders_);
  // A folder of our own beside the file: the file keeps its name, so that messages and writers that choose the format
  // by the extension are right.
  const std::string prefix = ".spinaltap-partial-";
  const fs::path folder = partial_path(final_path.parent_path(), prefix);
  if (!fs::exists(folder, error)) {
    remove_stale(final_path.parent_path(), prefix);
    if (!fs::create_directory(folder, error)) {
      fail("cannot write into ", final_path.parent_path().string(), ": ", error.message());
    }
    made_folders_.push_back(folder);
    staging_folders_.push_back(folder);
  }
  Entry entry{folder / final_path.filename(), final_path};
  entries_.push_back(entry);
  return entry.temporary;
}

void StagedOutput::write(const fs::path& final_path, std::string_view content) {
  write_whole_file(stage(final_path), content);
}

void StagedOutput::commit() {
  std::error_code error;
  for (const Entry& entry : entries_) {
    if (!fs::is_regular_file(entry.temporary, error)) fail("was not written: ", entry.final_path.string());
  }
  for (const Entry& entry : entries_) {
    fs::rename(entry.temporary, entry.final_path, error);
    if (error) fail("cannot write ", entry.final_path.string(), ": ", error.message());
  }
  entries_.clear();
  for (const fs::path& folder : staging_folders_) fs::remove(folder, error);
  staging_folders_.clear();
  made_folders_.clear();
}

StagedFolder::StagedFolder(fs::path final_path, const fs::path& marker) : final_path_(std::move(final_path)) {
  // "out/" and "out" are one folder.
  if (!final_path_.has_filename()) final_path_ = final_path_.parent_path();
  if (final_path_.empty()) fail("expected the name of a folder to write, found none");
  std::error_code error;
  if (fs::exists(final_path_, error)) {
    if (!fs::is_directory(final_path_, error)) fail("expected a folder, found a file: ", final_path_.string());
    if (!fs::is_empty(final_path_, error) && !fs::exists(final_path_ / marker, error)) {
      fail("the folder ", final_path_.string(), " holds other files (no ", marker.string(),
           "), so it is not replaced; choose another");
    }
  }
  const std::string prefix = "." + final_path_.filename().string() + ".partial-";
  temporary_ = partial_path(final_path_.parent_path(), prefix);
  remove_stale(final_path_.parent_path(), prefix);
  make_folders(final_path_.parent_path(), made_folders_);
  if (!fs::create_directory(temporary_, error)) {
    remove_empty_folders(made_folders_);
    fail("cannot make the folder ", temporary_.string(), ": ", error ? error.message() : "it exists");
  }
}

StagedFolder::~StagedFolder() {
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
  remove_empty_folders(made_folders_);
}

void StagedFolder::commit() {
  if (temporary_.empty()) fail("the folder is written already: ", final_path_.string());
  std::error_code error;
  const fs::path old = temporary_.string() + ".old";
  const bool replaces = fs::exists(final_path_, error);
  if (replaces) fs::rename(final_path_, old, error);
  if (!error) {
    fs::rename(temporary_, final_path_, error);
    std::error_code ignored;
    if (error && replaces) fs::rename(old, final_path_, ignored);
  }
  if (error) fail("cannot write the folder ", final_path_.string(), ": ", error.message());
  temporary_.clear();
  made_folders_.clear();
  if (replaces) fs::remove_all(old, error);
}

void write_whole_file(const fs::path& path, std::string_view content) {
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  file.close();
  if (!file) fail("cannot write ", path.string(), ": ", std::strerror(errno));
}

std::uint64_t regular_file_size(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) fail("no such file: ", path.string());
  if (!fs::is_regular_file(path, error)) fail("expected a regular file, found something else: ", path.string());
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) fail("cannot read ", path.string(), ": ", error.message());
  return size;
}

std::string read_whole_file(const fs::path& path, std::size_t max_bytes) {
  const std::uint64_t size = regular_file_size(path);
  if (size > max_bytes) {
    fail("expected at most ", max_bytes, " bytes, found ", size, " in ", path.string());
  }
  std::ifstream file(path, std::ios::binary);
  std::string content(static_cast<std::size_t>(size), '\0');
  file.read(content.data(), static_cast<std::streamsize>(content.size()));
  if (!file) fail("cannot read ", path.string());
  return content;
}

}  // namespace spinaltap
