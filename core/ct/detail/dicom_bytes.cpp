#include "core/ct/detail/dicom_bytes.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

namespace spinaltap {
namespace {

constexpr std::size_t kChunkBytes = 64 * 1024;
constexpr std::uint64_t kMaxInflation = 1032;  // deflate cannot shrink further

}  // namespace

struct DicomBytes::Inflater {
  z_stream zlib{};
  bool is_ready = false;
  bool is_done = false;
  std::vector<char> deflated = std::vector<char>(kChunkBytes);
  std::vector<char> inflated = std::vector<char>(kChunkBytes);
  std::size_t begin = 0;  ///< of what is left in `inflated`
  std::size_t end = 0;

  Inflater() { is_ready = inflateInit2(&zlib, -MAX_WBITS) == Z_OK; }
  ~Inflater() {
    if (is_ready) inflateEnd(&zlib);
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  /// Makes `inflated` hold at least `count` bytes where the stream does; gives how many it holds.
  std::size_t fill(std::ifstream& stream, std::size_t count) {
    if (end - begin >= count) return end - begin;
    std::copy(inflated.begin() + static_cast<std::ptrdiff_t>(begin),
              inflated.begin() + static_cast<std::ptrdiff_t>(end), inflated.begin());
    end -= begin;
    begin = 0;
    while (end < count && is_ready && !is_done) {
      if (zlib.avail_in == 0) {
        stream.read(deflated.data(), static_cast<std::streamsize>(deflated.size()));
        zlib.next_in = reinterpret_cast<Bytef*>(deflated.data());
        zlib.avail_in = static_cast<uInt>(stream.gcount());
        if (zlib.avail_in == 0) break;
      }
      zlib.next_out = reinterpret_cast<Bytef*>(inflated.data() + end);
      zlib.avail_out = static_cast<uInt>(inflated.size() - end);
      const int result = inflate(&zlib, Z_NO_FLUSH);
      end = inflated.size() - zlib.avail_out;
      is_done = result != Z_OK;  // the end, or broken: either way nothing follows
    }
    return end;
  }
};

DicomBytes::DicomBytes() = default;
DicomBytes::~DicomBytes() = default;

bool DicomBytes::open(const std::filesystem::path& file) {
  std::error_code error;
  // Opening a FIFO would wait for a writer.
  if (!std::filesystem::is_regular_file(file, error)) return false;
  size_ = std::filesystem::file_size(file, error);
  if (error) return false;
  stream_.open(file, std::ios::binary);
  return stream_.is_open();
}

void DicomBytes::inflate_from_here() {
  inflater_ = std::make_unique<Inflater>();
  size_ -= position_;  // how much deflated data there is
  position_ = 0;
}

bool DicomBytes::at_end() {
  if (inflater_) return inflater_->fill(stream_, 1) == 0;
  return position_ >= size_;
}

bool DicomBytes::may_hold(std::uint64_t count) const {
  const std::uint64_t max = inflater_ ? size_ * kMaxInflation : size_;
  return position_ <= max && count <= max - position_;
}

bool DicomBytes::read_plain(char* bytes, std::uint64_t count) {
  return may_hold(count) && stream_.read(bytes, static_cast<std::streamsize>(count));
}

bool DicomBytes::read(char* bytes, std::uint64_t count) {
  if (!inflater_) {
    if (!read_plain(bytes, count)) return false;
    position_ += count;
    return true;
  }
  while (count > 0) {
    const std::size_t held = inflater_->fill(stream_, 1);
    if (held == 0) return false;
    const std::size_t part = static_cast<std::size_t>(std::min<std::uint64_t>(held, count));
    std::memcpy(bytes, inflater_->inflated.data() + inflater_->begin, part);
    inflater_->begin += part;
    position_ += part;
    bytes += part;
    count -= part;
  }
  return true;
}

bool DicomBytes::peek(char* bytes, std::uint64_t count) {
  if (inflater_) {
    if (inflater_->fill(stream_, static_cast<std::size_t>(count)) < count) return false;
    std::memcpy(bytes, inflater_->inflated.data() + inflater_->begin, static_cast<std::size_t>(count));
    return true;
  }
  if (!read_plain(bytes, count)) return false;
  stream_.seekg(static_cast<std::streamoff>(position_));
  return true;
}

bool DicomBytes::skip(std::uint64_t count) {
  if (!may_hold(count)) return false;
  if (inflater_) {
    std::array<char, 4096> unused{};
    while (count > 0) {
      const std::uint64_t part = std::min<std::uint64_t>(count, unused.size());
      if (!read(unused.data(), part)) return false;
      count -= part;
    }
    return true;
  }
  position_ += count;
  constexpr std::uint64_t kShortWay = 1024;
  if (count <= kShortWay) {
    stream_.ignore(static_cast<std::streamsize>(count));  // keeps what the stream has buffered
  } else {
    stream_.seekg(static_cast<std::streamoff>(position_));
  }
  return true;
}

bool DicomBytes::rewind() {
  stream_.clear();
  stream_.seekg(0);
  position_ = 0;
  return static_cast<bool>(stream_);
}

}  // namespace spinaltap
