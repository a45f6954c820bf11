#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/base/file_stream.h"

namespace spinaltap::test {

/// What a file in gzip's format holds, whose name ends in .gz. Throws Error as FileReader does.
inline std::string gunzip(const std::filesystem::path& path) {
  constexpr std::size_t kPiece = std::size_t{1} << 12;
  FileReader file(path);
  std::string all;
  std::string_view piece;
  while (file.bytes(kPiece, piece)) all += piece;
  while (file.bytes(1, piece)) all += piece;
  return all;
}

}  // namespace spinaltap::test
