#include "core/ct/detail/stored_voxels.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <optional>
#include <string>

#include "core/base/error.h"
#include "core/base/text_fields.h"

namespace spinaltap::detail {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kChunkBytes = 64 * 1024;
constexpr std::uint64_t kMaxInflation = 1032;  // deflate cannot shrink further

[[noreturn]] void fail_short(const VoxelPart& part) {
  fail("cannot read the voxels (file cut short?) of ", part.file.string());
}

/// Reads a part from front to back, inflated where it is deflated.
class PartBytes {
 public:
  PartBytes(const VoxelPart& part, VoxelEncoding encoding, std::uint64_t wanted) : part_(part) {
    std::error_code error;
    // Opening a FIFO would wait for a writer.
    if (fs::is_regular_file(part.file, error)) stream_.open(part.file, std::ios::binary);
    if (!stream_.is_open()) fail_as(ErrorKind::file, "no such file with the voxels: ", part.file.string());
    const std::uint64_t size = fs::file_size(part.file, error);
    if (error) fail_short(part_);
    const bool is_from_end = part.skip_bytes == VoxelPart::kFromEnd;
    const std::uint64_t start = is_from_end ? size - std::min(size, wanted) : part.at;
    stream_.seekg(static_cast<std::streamoff>(start));
    if (!is_from_end) skip_lines();
    if (encoding == VoxelEncoding::kDeflated) {
      is_deflated_ = inflateInit2(&zlib_, 32 + MAX_WBITS) == Z_OK;  // 32: gzip or zlib, whichever it is
      if (!is_deflated_) fail_short(part_);
      packed_.resize(kChunkBytes);
    }
    if (!is_from_end) skip_bytes(static_cast<std::uint64_t>(part.skip_bytes));
  }
  ~PartBytes() {
    if (is_deflated_) inflateEnd(&zlib_);
  }
  PartBytes(const PartBytes&) = delete;
  PartBytes& operator=(const PartBytes&) = delete;

  /// How many bytes there were, up to `count`.
  std::size_t read(char* bytes, std::size_t count) {
    if (!is_deflated_) {
      stream_.read(bytes, static_cast<std::streamsize>(count));
      return static_cast<std::size_t>(stream_.gcount());
    }
    zlib_.next_out = reinterpret_cast<Bytef*>(bytes);
    zlib_.avail_out = static_cast<uInt>(count);
    while (zlib_.avail_out > 0 && !is_done_) inflate_some();
    return count - zlib_.avail_out;
  }

  /// How many plain bytes of the file are left.
  std::uint64_t rest() {
    const std::streampos at = stream_.tellg();
    stream_.seekg(0, std::ios::end);
    const std::streamoff left = stream_.tellg() - at;
    return left > 0 ? static_cast<std::uint64_t>(left) : 0;
  }

 private:
  void inflate_some() {
    if (zlib_.avail_in == 0) {
      stream_.read(packed_.data(), static_cast<std::streamsize>(packed_.size()));
      zlib_.next_in = reinterpret_cast<Bytef*>(packed_.data());
      zlib_.avail_in = static_cast<uInt>(stream_.gcount());
      if (zlib_.avail_in == 0) {
        if (!is_between_) fail("broken gzip stream (file cut short?) in ", part_.file.string());
        is_done_ = true;
        return;
      }
    }
    if (is_between_ && has_ended_) {
      // Gzip files may be put one behind the other; what else follows is padding.
      if (*zlib_.next_in != 0x1f) {
        is_done_ = true;
        return;
      }
      inflateReset(&zlib_);
    }
    is_between_ = false;
    const int result = inflate(&zlib_, Z_NO_FLUSH);
    if (result == Z_STREAM_END) {
      has_ended_ = true;
      is_between_ = true;
    } else if (result != Z_OK && result != Z_BUF_ERROR) {
      fail("broken gzip stream in ", part_.file.string());
    }
  }

  void skip_lines() {
    for (int line = 0; line < part_.skip_lines; ++line) {
      char c = '\0';
      while (stream_.get(c) && c != '\n') {
      }
      if (!stream_) fail_short(part_);
    }
  }

  void skip_bytes(std::uint64_t count) {
    std::array<char, 4096> unused{};
    while (count > 0) {
      const auto some = static_cast<std::size_t>(std::min<std::uint64_t>(count, unused.size()));
      if (read(unused.data(), some) != some) fail_short(part_);
      count -= some;
    }
  }

  const VoxelPart& part_;
  std::ifstream stream_;
  z_stream zlib_{};
  bool is_deflated_ = false;
  bool has_ended_ = false;   ///< a stream at least
  bool is_between_ = false;  ///< streams
  bool is_done_ = false;
  std::vector<char> packed_;
};

template <class Stored>
void convert(const char* bytes, bool swapped, std::span<double> values) {
  for (std::size_t n = 0; n < values.size(); ++n) {
    std::array<char, sizeof(Stored)> raw{};
    std::memcpy(raw.data(), bytes + n * raw.size(), raw.size());
    if (swapped) std::reverse(raw.begin(), raw.end());
    Stored stored;
    std::memcpy(&stored, raw.data(), raw.size());
    values[n] = static_cast<double>(stored);
  }
}

using Convert = void (*)(const char*, bool, std::span<double>);

Convert convert_of(StoredType type) {
  constexpr std::array<Convert, 10> kConverts{convert<std::int8_t>,   convert<std::uint8_t>,  convert<std::int16_t>,
                                              convert<std::uint16_t>, convert<std::int32_t>,  convert<std::uint32_t>,
                                              convert<std::int64_t>,  convert<std::uint64_t>, convert<float>,
                                              convert<double>};
  return kConverts[static_cast<std::size_t>(type)];
}

/// The numbers of a text, which may be longer than memory: a token at a time.
class PartNumbers {
 public:
  PartNumbers(PartBytes& bytes, const VoxelPart& part) : bytes_(bytes), part_(part) {}

  std::optional<double> next() {
    token_.clear();
    for (int c = get(); c >= 0; c = get()) {
      const bool is_between = c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ',';
      if (is_between && token_.empty()) continue;
      if (is_between) break;
      token_ += static_cast<char>(c);
      if (token_.size() > kMaxToken) break;
    }
    if (token_.empty()) return std::nullopt;
    const std::optional<double> number = parse_number(token_);
    if (!number) fail("expected numbers, found ", in_quotes(token_), " among the voxels in ", part_.file.string());
    return number;
  }

 private:
  static constexpr std::size_t kMaxToken = 64;

  int get() {
    if (at_ == end_) {
      end_ = bytes_.read(chunk_.data(), chunk_.size());
      at_ = 0;
      if (end_ == 0) return -1;
    }
    return static_cast<unsigned char>(chunk_[at_++]);
  }

  PartBytes& bytes_;
  const VoxelPart& part_;
  std::string token_;
  std::vector<char> chunk_ = std::vector<char>(kChunkBytes);
  std::size_t at_ = 0;
  std::size_t end_ = 0;
};

void check_surplus(std::uint64_t wanted, std::uint64_t surplus, const VoxelPart& part) {
  if (surplus <= kMaxSurplus) return;
  fail("expected ", wanted, " bytes of voxels, found ", surplus,
       " more (other sizes or another type than the header says, or a head of the data's own?): ", part.file.string());
}

void check_part(const StoredVoxels& voxels, const VoxelPart& part, std::size_t count) {
  std::error_code error;
  if (!fs::is_regular_file(part.file, error))
    fail_as(ErrorKind::file, "no such file with the voxels: ", part.file.string());
  const std::uint64_t size = fs::file_size(part.file, error);
  const bool is_from_end = part.skip_bytes == VoxelPart::kFromEnd;
  const std::uint64_t there = size - std::min(size, part.at);
  const std::uint64_t wanted = count * bytes_of(voxels.type);
  std::uint64_t min_bytes = wanted;
  if (voxels.encoding == VoxelEncoding::kDeflated) min_bytes = wanted / kMaxInflation;
  if (voxels.encoding == VoxelEncoding::kText) min_bytes = 2 * count - 1;
  if (voxels.encoding == VoxelEncoding::kRaw && !is_from_end) min_bytes += static_cast<std::uint64_t>(part.skip_bytes);
  if (error || there < min_bytes) {
    fail("expected ", wanted, " bytes of voxels, found ", there, " (cut short?): ", part.file.string());
  }
  const bool is_counted = voxels.encoding == VoxelEncoding::kRaw && !is_from_end && part.skip_lines == 0;
  if (is_counted) check_surplus(wanted, there - min_bytes, part);
}

void read_numbers(const StoredVoxels& voxels, const VoxelPart& part, std::size_t count, const TakeValues& take) {
  constexpr std::size_t kValues = 8192;
  PartBytes bytes(part, voxels.encoding, count * bytes_of(voxels.type));
  std::vector<double> values;
  if (voxels.encoding == VoxelEncoding::kText) {
    PartNumbers numbers(bytes, part);
    for (std::size_t left = count; left > 0; left -= values.size()) {
      values.resize(std::min(kValues, left));
      for (double& value : values) {
        const std::optional<double> number = numbers.next();
        if (!number) fail_short(part);
        value = *number;
      }
      take(values);
    }
    if (numbers.next()) fail("expected ", count, " numbers, found more in ", part.file.string());
    return;
  }
  std::vector<char> raw;
  const bool is_swapped = voxels.is_big_endian != (std::endian::native == std::endian::big);
  for (std::size_t left = count; left > 0; left -= values.size()) {
    values.resize(std::min(kValues, left));
    raw.resize(values.size() * bytes_of(voxels.type));
    if (bytes.read(raw.data(), raw.size()) != raw.size()) fail_short(part);
    convert_of(voxels.type)(raw.data(), is_swapped, values);
    take(values);
  }
  char more = '\0';
  if (voxels.encoding == VoxelEncoding::kDeflated && bytes.read(&more, 1) != 0) {
    fail("expected ", count * bytes_of(voxels.type), " bytes of voxels, found a gzip stream of more in ",
         part.file.string());
  }
  // Where skipped lines end is known only now.
  if (voxels.encoding == VoxelEncoding::kRaw && part.skip_lines > 0)
    check_surplus(count * bytes_of(voxels.type), bytes.rest(), part);
}

}  // namespace

std::size_t bytes_of(StoredType type) {
  switch (type) {
    case StoredType::kInt8:
    case StoredType::kUint8:
      return 1;
    case StoredType::kInt16:
    case StoredType::kUint16:
      return 2;
    case StoredType::kInt32:
    case StoredType::kUint32:
    case StoredType::kFloat32:
      return 4;
    default:
      return 8;
  }
}

void check_stored(const StoredVoxels& voxels) {
  if (voxels.parts.empty() || voxels.count == 0 || voxels.count % voxels.parts.size() != 0) {
    fail("expected files of voxels that share ", voxels.count, " evenly, found ", voxels.parts.size());
  }
  for (const VoxelPart& part : voxels.parts) check_part(voxels, part, voxels.count / voxels.parts.size());
}

void read_stored(const StoredVoxels& voxels, const TakeValues& take) {
  check_stored(voxels);
  for (const VoxelPart& part : voxels.parts) read_numbers(voxels, part, voxels.count / voxels.parts.size(), take);
}

}  // namespace spinaltap::detail
