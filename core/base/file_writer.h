#pragma once

#include <filesystem>
#include <fstream>
#include <span>
#include <string_view>

namespace spinaltap {

/// Writes a file from front to back, piece by piece, for content that is too large to hold twice. `path` is a staged
/// (temporary) name: without close() half a file stays there. Throws Error when the disk is full.
class FileWriter {
 public:
  explicit FileWriter(const std::filesystem::path& path);

  void write(std::string_view bytes);
  /// The numbers' bytes as they stand in memory.
  void write(std::span<const double> numbers);

  /// Call last: only then do all bytes have their place on the disk.
  void close();

 private:
  void check() const;

  std::filesystem::path path_;
  std::ofstream file_;
};

}  // namespace spinaltap
