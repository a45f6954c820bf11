#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

namespace spinaltap {

/// Files that appear together or not at all.
///
/// Each file is written into a temporary folder beside its final place; commit() syncs them to the disk and moves them
/// all. Without commit(), and where it fails, the old files are left or none, and none of the folders made for the new
/// ones. What a killed run left in the temporary folder is removed by the next one that writes beside it.
///
/// A kill while commit() moves them can leave some new files among old ones: a set with a list tells. See list_in().
class StagedOutput {
 public:
  /// Name of the list: a first line "spinaltap-files whole", or "spinaltap-files unfinished" while files are moved;
  /// then a line for each file: its bytes, a space, its name below the folder.
  static constexpr const char* kListName = "files.txt";

  StagedOutput() = default;
  ~StagedOutput();
  StagedOutput(const StagedOutput&) = delete;
  StagedOutput& operator=(const StagedOutput&) = delete;

  /// The temporary path to write instead of `final_path`. Missing parent folders are made.
  /// Throws Error where a folder cannot be made or `final_path` is a folder.
  std::filesystem::path stage(const std::filesystem::path& final_path);

  /// As stage(), and writes `content` there. Throws Error when the disk is full.
  void write(const std::filesystem::path& final_path, std::string_view content);

  /// Makes the files one set of `folder`, which gets their list, the last thing that commit() writes. Files that an
  /// earlier list there names and that are not of this set are removed then.
  void list_in(const std::filesystem::path& folder) { list_folder_ = folder; }
  /// Counts a file that is there already as one of the set.
  void also_list(const std::filesystem::path& final_path) { also_listed_.push_back(final_path); }

  /// Gives every staged file its final name, replacing old ones. Throws Error when one is missing or cannot be renamed,
  /// and puts back those that were.
  void commit();

  /// Removes what killed runs of this machine left where they wrote into `folder`, as the first stage() there does too.
  static void remove_leftovers(const std::filesystem::path& folder);

 private:
  struct Entry {
    std::filesystem::path temporary;
    std::filesystem::path final_path;
  };
  std::vector<std::filesystem::path> listed_files() const;

  std::vector<Entry> entries_;
  std::vector<std::filesystem::path> made_folders_;
  std::vector<std::filesystem::path> staging_folders_;  ///< those of made_folders_ that are temporary
  std::optional<std::filesystem::path> list_folder_;
  std::vector<std::filesystem::path> also_listed_;
};

/// A folder that appears whole or not at all: filled under a temporary name beside its own, synced to the disk,
/// renamed.
class StagedFolder {
 public:
  /// Makes the temporary folder. An existing `final_path` is replaced on commit() only where it holds `marker`, a file
  /// that says that we made it; otherwise Error is thrown, unless it is empty.
  StagedFolder(std::filesystem::path final_path, const std::filesystem::path& marker);
  /// Removes what was not committed, and the folders made for it.
  ~StagedFolder();
  StagedFolder(const StagedFolder&) = delete;
  StagedFolder& operator=(const StagedFolder&) = delete;

  const std::filesystem::path& temporary() const { return temporary_; }
  void commit();

 private:
  std::filesystem::path final_path_;
  std::filesystem::path temporary_;
  std::vector<std::filesystem::path> made_folders_;
};

/// Hands a file, or a folder's list of names, to the disk itself, so that it outlives a crash of the machine. Throws
/// Error where the disk rejects it; file systems that cannot sync are left alone.
void sync_to_disk(const std::filesystem::path& path);

/// Writes `content` to `path` (already a temporary name). Throws Error when the disk is full or the path not writable.
void write_whole_file(const std::filesystem::path& path, std::string_view content);

/// Bytes of a regular file. Throws Error when it is missing or not a regular file.
std::uint64_t regular_file_size(const std::filesystem::path& path);

/// The whole content of a regular file. Throws Error when it is missing, not a regular file, or over `max_bytes`.
std::string read_whole_file(const std::filesystem::path& path, std::size_t max_bytes = std::size_t{1} << 30);

}  // namespace spinaltap
