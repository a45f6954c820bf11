#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

namespace spinaltap {

/// Files that appear together or not at all.
///
/// Each file is written into a temporary folder beside its final place; commit() moves them all. Without commit() the
/// destructor removes what was written, and the folders it made, so a failed run leaves the old files or none. What a
/// killed run left in the temporary folder is removed by the next one that writes beside it.
class StagedOutput {
 public:
  StagedOutput() = default;
  ~StagedOutput();
  StagedOutput(const StagedOutput&) = delete;
  StagedOutput& operator=(const StagedOutput&) = delete;

  /// The temporary path to write instead of `final_path`. Missing parent folders are made.
  /// Throws Error where a folder cannot be made or `final_path` is a folder.
  std::filesystem::path stage(const std::filesystem::path& final_path);

  /// As stage(), and writes `content` there. Throws Error when the disk is full.
  void write(const std::filesystem::path& final_path, std::string_view content);

  /// Gives every staged file its final name, replacing old ones. Throws Error when one is missing or cannot be renamed.
  void commit();

 private:
  struct Entry {
    std::filesystem::path temporary;
    std::filesystem::path final_path;
  };
  std::vector<Entry> entries_;
  std::vector<std::filesystem::path> made_folders_;
  std::vector<std::filesystem::path> staging_folders_;  ///< those of made_folders_ that are temporary
};

/// A folder that appears whole or not at all: filled under a temporary name beside its own, then renamed.
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

/// Writes `content` to `path` (already a temporary name). Throws Error when the disk is full or the path not writable.
void write_whole_file(const std::filesystem::path& path, std::string_view content);

/// Bytes of a regular file. Throws Error when it is missing or not a regular file.
std::uint64_t regular_file_size(const std::filesystem::path& path);

/// The whole content of a regular file. Throws Error when it is missing, not a regular file, or over `max_bytes`.
std::string read_whole_file(const std::filesystem::path& path, std::size_t max_bytes = std::size_t{1} << 30);

}  // namespace spinaltap
