#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/ct/detail/volume_file.h"

namespace spinaltap::detail {

/// Raw bytes that may lie behind the last voxel: a line's end, or padding to a word. More have another header's sizes.
inline constexpr int kMaxSurplus = 4;

/// How a number is stored.
enum class StoredType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kInt64, kUint64, kFloat32, kFloat64 };

std::size_t bytes_of(StoredType type);

/// How the numbers of a file follow each other.
enum class VoxelEncoding {
  kRaw,
  kDeflated,  ///< a gzip or a zlib stream of the raw bytes
  kText,      ///< decimal, with blanks, commas or line ends between
};

/// Where some of a volume's values stand.
struct VoxelPart {
  static constexpr std::int64_t kFromEnd = -1;

  std::filesystem::path file;
  std::uint64_t at = 0;         ///< where they begin, bytes from the file's start
  int skip_lines = 0;           ///< to pass over from there
  std::int64_t skip_bytes = 0;  ///< then, of what a stream inflates to; kFromEnd: raw values are the last in the file
};

/// The values of a volume: in one part or several of one size, one after the other.
struct StoredVoxels {
  StoredType type = StoredType::kInt16;
  bool is_big_endian = false;
  VoxelEncoding encoding = VoxelEncoding::kRaw;
  std::size_t count = 0;
  std::vector<VoxelPart> parts;
};

/// Throws Error where a part is missing, or too small for its values, before memory is taken for them: plain ones must
/// be there, deflated ones at the rate that deflate can reach. Raw ones must be all there is: a file of other length
/// says that its header is of another, or counts a head of its own.
void check_stored(const StoredVoxels& voxels);

/// Gives all values to `take`. Throws Error as check_stored(), for streams that are broken or hold more, and for text
/// that is no number.
void read_stored(const StoredVoxels& voxels, const TakeValues& take);

}  // namespace spinaltap::detail
