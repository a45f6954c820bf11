#include "core/base/gzip.h"

#include <zlib.h>

#include <algorithm>
#include <limits>

#include "core/base/error.h"

namespace spinaltap {
namespace {

constexpr int kGzipFormat = 16 + MAX_WBITS;

Bytef* zlib_bytes(const char* data) { return reinterpret_cast<Bytef*>(const_cast<char*>(data)); }  // zlib only reads it

/// zlib counts in 32 bits: the next piece of what is left.
uInt next_piece(std::size_t left) {
  return static_cast<uInt>(std::min<std::size_t>(left, std::numeric_limits<uInt>::max() / 2));
}

}  // namespace

std::string gzip(std::string_view data) {
  z_stream stream{};
  constexpr int kMemoryLevel = 8;
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzipFormat, kMemoryLevel, Z_DEFAULT_STRATEGY) != Z_OK) {
    fail("gzip: not enough memory");
  }
  std::string result;
  std::string buffer(std::size_t{1} << 18, '\0');
  int status = Z_OK;
  std::size_t taken = 0;
  while (status == Z_OK) {
    if (stream.avail_in == 0 && taken < data.size()) {
      stream.next_in = zlib_bytes(data.data() + taken);
      stream.avail_in = next_piece(data.size() - taken);
      taken += stream.avail_in;
    }
    stream.next_out = zlib_bytes(buffer.data());
    stream.avail_out = static_cast<uInt>(buffer.size());
    status = deflate(&stream, taken == data.size() ? Z_FINISH : Z_NO_FLUSH);
    result.append(buffer, 0, buffer.size() - stream.avail_out);
  }
  deflateEnd(&stream);
  if (status != Z_STREAM_END) fail("gzip: zlib gives up with ", status);
  return result;
}

}  // namespace spinaltap
