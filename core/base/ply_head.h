#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/file_stream.h"

namespace spinaltap {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

constexpr std::size_t bytes_of(PlyType type) {
  constexpr std::size_t kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[static_cast<int>(type)];
}

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  std::optional<PlyType> count_type = {};  ///< of a list: a count stands before its items
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties = {};
};

enum class PlyFormat { ascii, little_endian, big_endian };

/// What stands at the beginning of a PLY file ("The PLY Polygon File Format", G. Turk, 1994).
struct PlyHead {
  PlyFormat format = PlyFormat::little_endian;
  std::vector<std::string> comments = {};
  std::vector<PlyElement> elements = {};
};

/// Reads a head and leaves `file` at the first element. Counts are as written: nobody has checked them. Throws Error
/// when it is none.
PlyHead read_ply_head(FileReader& file);

/// A head as text, up to and with "end_header\n".
std::string encode(const PlyHead& head);

}  // namespace spinaltap
