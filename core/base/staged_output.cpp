#include "core/base/staged_output.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>  // renameat2
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <locale>
#include <set>
#include <sstream>
#include <system_error>

#include "core/base/error.h"
#include "core/base/text_writer.h"

namespace spinaltap {
namespace fs = std::filesystem;
namespace {

constexpr const char* kPartialFile = ".spinaltap-partial-";

/// Makes a folder and those above it, and adds what it made to `made`, the uppermost first.
void make_folders(const fs::path& wanted, std::vector<fs::path>& made) {
  std::error_code error;
  std::vector<fs::path> missing;
  for (fs::path folder = wanted; !folder.empty() && !fs::exists(folder, error); folder = folder.parent_path()) {
    missing.push_back(folder);
  }
  for (auto folder = missing.rbegin(); folder != missing.rend(); ++folder) {
    if (!fs::create_directory(*folder, error) && error) {
      fail_as(ErrorKind::disk, "cannot make the folder ", folder->string(), ": ", error.message());
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

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

/// Whether a relative path stays below the folder that it begins in.
bool is_below(const fs::path& name) {
  return !name.empty() && name.is_relative() && std::none_of(name.begin(), name.end(), [](const fs::path& part) {
    return part == ".." || part == "." || part.empty();
  });
}

/// A file that gets its final name. What had that name before is kept beside the new one until all is sure.
class Move {
 public:
  Move(fs::path from, fs::path to) : from_(std::move(from)), to_(std::move(to)), old_(from_.string() + ".old") {}

  std::error_code go() {
    std::error_code error;
    fs::create_hard_link(to_, old_, error);  // none where nothing was there, or the file system has no links
    has_old_ = !error;
    fs::rename(from_, to_, error);
    is_done_ = !error;
    return error;
  }
  void take_back() {
    std::error_code ignored;
    if (is_done_ && has_old_) {
      fs::rename(to_, from_, ignored);
      fs::rename(old_, to_, ignored);
    } else if (is_done_) {
      fs::rename(to_, from_, ignored);
    } else if (has_old_) {
      fs::remove(old_, ignored);
    }
  }
  void keep() {
    std::error_code ignored;
    if (has_old_) fs::remove(old_, ignored);
  }

 private:
  fs::path from_, to_, old_;
  bool has_old_ = false, is_done_ = false;
};

constexpr std::string_view kListHead = "spinaltap-files ";

/// The list of a set of files: StagedOutput::list_in().
class FileList {
 public:
  FileList(const fs::path& folder, std::vector<fs::path> names)
      : folder_(folder), file_(folder / StagedOutput::kListName), names_(std::move(names)) {
    std::error_code error;
    if (!fs::is_regular_file(file_, error)) return;
    before_ = read_whole_file(file_);
    if (!before_->starts_with(kListHead))
      fail("expected a list of files in ", file_.string(), ", found something else");
    std::istringstream lines(*before_);
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
      const std::size_t space = line.find(' ');
      if (space == std::string::npos) continue;
      const fs::path name = line.substr(space + 1);
      if (is_below(name) && !std::binary_search(names_.begin(), names_.end(), name)) leftovers_.push_back(name);
    }
  }

  /// Before the files are moved: names also those that are to go, so that another run can go on.
  void begin() const {
    std::vector<fs::path> all = names_;
    all.insert(all.end(), leftovers_.begin(), leftovers_.end());
    try {
      put(text("unfinished", all));
    } catch (...) {
      take_back();
      throw;
    }
  }
  /// After it.
  void end() const {
    std::error_code ignored;
    for (const fs::path& name : leftovers_) fs::remove(folder_ / name, ignored);
    put(text("whole", names_));
  }
  /// As far as a disk lets it that has just failed.
  void take_back() const {
    std::error_code ignored;
    try {
      before_ ? put(*before_, false) : static_cast<void>(fs::remove(file_, ignored));
    } catch (const Error&) {  // what failed first is what is told
    }
  }

 private:
  std::string text(std::string_view state, const std::vector<fs::path>& names) const {
    TextWriter lines;
    lines << kListHead << state << '\n';
    for (const fs::path& name : names) {
      std::error_code error;
      const std::uintmax_t bytes = fs::file_size(folder_ / name, error);
      lines << (error ? 0 : bytes) << ' ' << name.string() << '\n';
    }
    return lines.str();
  }
  /// `is_sure`: on the disk when it returns.
  void put(const std::string& content, bool is_sure = true) const {
    const std::string prefix = ".spinaltap-list-";
    remove_stale(folder_, prefix);
    const fs::path temporary = partial_path(folder_, prefix);
    try {
      write_whole_file(temporary, content);
      if (is_sure) sync_to_disk(temporary);
      std::error_code error;
      fs::rename(temporary, file_, error);
      if (error) fail_as(ErrorKind::disk, "cannot write ", file_.string(), ": ", error.message());
    } catch (...) {
      std::error_code ignored;
      fs::remove(temporary, ignored);
      throw;
    }
    if (is_sure) sync_to_disk(folder_);
  }

  fs::path folder_, file_;
  std::vector<fs::path> names_;      ///< sorted
  std::vector<fs::path> leftovers_;  ///< of an earlier list
  std::optional<std::string> before_;
};

}  // namespace

StagedOutput::~StagedOutput() {
  std::error_code ignored;
  for (const Entry& entry : entries_) fs::remove(entry.temporary, ignored);
  remove_empty_folders(made_folders_);
}

void StagedOutput::remove_leftovers(const fs::path& folder) { remove_stale(folder, kPartialFile); }

fs::path StagedOutput::stage(const fs::path& final_path) {
  std::error_code error;
  if (final_path.filename().empty() || fs::is_directory(final_path, error)) {
    fail("expected the name of a file to write, found a folder: ", final_path.string());
  }
  make_folders(final_path.parent_path(), made_folders_);
  // A folder of our own beside the file: the file keeps its name, so that messages and writers that choose the format
  // by the extension are right.
  const fs::path folder = partial_path(final_path.parent_path(), kPartialFile);
  if (!fs::exists(folder, error)) {
    remove_leftovers(final_path.parent_path());
    if (!fs::create_directory(folder, error)) {
      fail_as(ErrorKind::disk, "cannot write into ", final_path.parent_path().string(), ": ", error.message());
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

std::vector<fs::path> StagedOutput::listed_files() const {
  std::vector<fs::path> names;
  const auto add = [&](const fs::path& file) {
    const fs::path name = file.lexically_relative(*list_folder_);
    if (is_below(name)) names.push_back(name);
  };
  for (const Entry& entry : entries_) add(entry.final_path);
  for (const fs::path& file : also_listed_) add(file);
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

void StagedOutput::commit() {
  std::error_code error;
  for (const Entry& entry : entries_) {
    if (!fs::is_regular_file(entry.temporary, error)) fail("was not written: ", entry.final_path.string());
  }
  for (const Entry& entry : entries_) sync_to_disk(entry.temporary);
  std::set<fs::path> folders;
  for (const Entry& entry : entries_) folders.insert(folder_of(entry.final_path));
  for (const fs::path& folder : made_folders_) folders.insert(folder_of(folder));

  std::optional<FileList> list;
  if (list_folder_) {
    list.emplace(*list_folder_, listed_files());
    list->begin();
  }
  std::vector<Move> moves;
  for (const Entry& entry : entries_) {
    Move& move = moves.emplace_back(entry.temporary, entry.final_path);
    if (const std::error_code failed = move.go()) {
      for (auto done = moves.rbegin(); done != moves.rend(); ++done) done->take_back();
      if (list) list->take_back();
      fail_as(ErrorKind::disk, "cannot write ", entry.final_path.string(), ": ", failed.message());
    }
  }
  for (Move& move : moves) move.keep();
  for (const fs::path& folder : folders) sync_to_disk(folder);
  if (list) list->end();
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
    fail_as(ErrorKind::disk, "cannot make the folder ", temporary_.string(), ": ",
            error ? error.message() : "it exists");
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
  for (const auto& entry : fs::recursive_directory_iterator(temporary_, error)) {
    if (entry.is_regular_file(error) || entry.is_directory(error)) sync_to_disk(entry.path());
  }
  const bool replaces = fs::exists(final_path_, error);
  fs::path old;
  if (replaces && ::renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, final_path_.c_str(), RENAME_EXCHANGE) == 0) {
    old = temporary_;
  } else {
    old = temporary_.string() + ".old";
    if (replaces) fs::rename(final_path_, old, error);
    if (!error) {
      fs::rename(temporary_, final_path_, error);
      std::error_code ignored;
      if (error && replaces) fs::rename(old, final_path_, ignored);
    }
    if (error) fail_as(ErrorKind::disk, "cannot write the folder ", final_path_.string(), ": ", error.message());
  }
  std::set<fs::path> folders{folder_of(final_path_)};
  for (const fs::path& folder : made_folders_) folders.insert(folder_of(folder));
  for (const fs::path& folder : folders) sync_to_disk(folder);
  temporary_.clear();
  made_folders_.clear();
  if (replaces) fs::remove_all(old, error);
}

void sync_to_disk(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail_as(ErrorKind::disk, "cannot open ", path.string(), ": ", std::strerror(errno));
  int status = 0;
  do {
    status = ::fsync(descriptor);
  } while (status != 0 && errno == EINTR);
  const int error = status != 0 ? errno : 0;
  ::close(descriptor);
  const bool cannot_sync = error == EINVAL || error == EROFS || error == ENOTSUP || error == ENOSYS;
  if (error != 0 && !cannot_sync) fail_as(ErrorKind::disk, "cannot write ", path.string(), ": ", std::strerror(error));
}

void write_whole_file(const fs::path& path, std::string_view content) {
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  file.close();
  if (!file) fail_as(ErrorKind::disk, "cannot write ", path.string(), ": ", std::strerror(errno));
}

std::uint64_t regular_file_size(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) fail_as(ErrorKind::file, "no such file: ", path.string());
  if (!fs::is_regular_file(path, error)) fail("expected a regular file, found something else: ", path.string());
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) fail_as(ErrorKind::file, "cannot read ", path.string(), ": ", error.message());
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
  if (!file) fail_as(ErrorKind::file, "cannot read ", path.string());
  return content;
}

}  // namespace spinaltap
