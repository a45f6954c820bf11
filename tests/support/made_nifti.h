#pragma once

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap::test {

/// A NIfTI CT put together byte by byte, so that tests of the reader do not rest on the library it uses. Stored as 16
/// bit signed, 32 bit float or 64 bit float.
struct MadeNifti {
  enum class Type : std::int16_t { kInt16 = 4, kFloat = 16, kDouble = 64 };
  Type type = Type::kInt16;
  std::array<std::int64_t, 8> dim{3, 4, 3, 2, 1, 1, 1, 1};
  std::vector<double> values;         ///< as stored, i fastest
  Mat3 ras_steps = Mat3::Identity();  ///< column c: step of index c, RAS, mm
  Vec3 ras_origin_mm = Vec3::Zero();
  double slope = 0.0;
  double intercept = 0.0;
  double values_at = -1.0;      ///< vox_offset; -1: right behind the header
  std::int16_t sform_code = 1;  ///< scanner
  std::int16_t qform_code = 0;
  Vec3 quaternion = Vec3::Zero();    ///< b, c and d
  Vec3 q_origin_mm = Vec3::Zero();   ///< qoffset, RAS
  Vec3 pixdim = Vec3::Constant(-1);  ///< below 0: as long as `ras_steps`
  std::uint8_t unit = 0;             ///< xyzt_units
  bool is_second = false;            ///< NIfTI-2
  bool is_big_endian = false;
  const char* magic = nullptr;  ///< nullptr: of header and voxels in one file

  std::string bytes() const {
    const std::size_t header_bytes = is_second ? 544 : 352;
    std::string file(header_bytes, '\0');
    put<std::int32_t>(file, 0, is_second ? 540 : 348);
    for (std::size_t n = 0; n < 8; ++n) {
      if (is_second)
        put<std::int64_t>(file, 16 + 8 * n, dim[n]);
      else
        put<std::int16_t>(file, 40 + 2 * n, static_cast<std::int16_t>(dim[n]));
    }
    const auto bits = static_cast<std::int16_t>(8 * value_bytes());
    put<std::int16_t>(file, is_second ? 12 : 70, static_cast<std::int16_t>(type));
    put<std::int16_t>(file, is_second ? 14 : 72, bits);
    const double offset = values_at < 0.0 ? static_cast<double>(header_bytes) : values_at;
    for (std::size_t n = 0; n < 4; ++n) {
      put_real(file, is_second ? 104 + 8 * n : 76 + 4 * n,
               n == 0                                           ? 1.0
               : pixdim[static_cast<Eigen::Index>(n) - 1] < 0.0 ? ras_steps.col(static_cast<int>(n) - 1).norm()
                                                                : pixdim[static_cast<Eigen::Index>(n) - 1]);
    }
    if (is_second)
      put<std::int64_t>(file, 168, static_cast<std::int64_t>(offset));
    else
      put<float>(file, 108, static_cast<float>(offset));
    put_real(file, is_second ? 176 : 112, slope);
    put_real(file, is_second ? 184 : 116, intercept);
    if (is_second) {
      put<std::int32_t>(file, 344, qform_code);
      put<std::int32_t>(file, 348, sform_code);
      put<std::int32_t>(file, 500, unit);
    } else {
      put<std::int16_t>(file, 252, qform_code);
      put<std::int16_t>(file, 254, sform_code);
      file[123] = static_cast<char>(unit);
    }
    for (std::size_t n = 0; n < 3; ++n) {
      put_real(file, is_second ? 352 + 8 * n : 256 + 4 * n, quaternion[static_cast<Eigen::Index>(n)]);
      put_real(file, is_second ? 376 + 8 * n : 268 + 4 * n, q_origin_mm[static_cast<Eigen::Index>(n)]);
    }
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) {
        const auto n = static_cast<std::size_t>(4 * row + column);
        put_real(file, is_second ? 400 + 8 * n : 280 + 4 * n, column < 3 ? ras_steps(row, column) : ras_origin_mm[row]);
      }
    }
    std::memcpy(file.data() + (is_second ? 4 : 344),
                magic != nullptr ? magic
                : is_second      ? "n+2\0\r\n\032\n"
                                 : "n+1",
                is_second ? 8 : 4);
    if (static_cast<std::size_t>(offset) > file.size() && offset < 1e6) file.resize(static_cast<std::size_t>(offset));
    for (const double value : values) {
      const std::size_t at = file.size();
      file.resize(at + value_bytes());
      if (type == Type::kInt16) put<std::int16_t>(file, at, static_cast<std::int16_t>(value));
      if (type == Type::kFloat) put<float>(file, at, static_cast<float>(value));
      if (type == Type::kDouble) put<double>(file, at, value);
    }
    return file;
  }

 private:
  std::size_t value_bytes() const { return type == Type::kInt16 ? 2 : type == Type::kFloat ? 4 : 8; }
  template <class Number>
  void put(std::string& file, std::size_t at, Number number) const {
    std::array<char, sizeof number> raw{};
    std::memcpy(raw.data(), &number, raw.size());
    if (is_big_endian) std::reverse(raw.begin(), raw.end());
    std::memcpy(file.data() + at, raw.data(), raw.size());
  }
  void put_real(std::string& file, std::size_t at, double value) const {
    if (is_second)
      put<double>(file, at, value);
    else
      put<float>(file, at, static_cast<float>(value));
  }
};

/// The bytes as a gzip file.
inline std::string gzipped(const std::string& bytes) {
  z_stream stream{};
  constexpr int kGzip = 16 + MAX_WBITS;
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kGzip, 8, Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::runtime_error("cannot begin to gzip");
  }
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  std::string copy = bytes;
  stream.next_in = reinterpret_cast<Bytef*>(copy.data());
  stream.avail_in = static_cast<uInt>(copy.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const int result = deflate(&stream, Z_FINISH);
  packed.resize(packed.size() - stream.avail_out);
  deflateEnd(&stream);
  if (result != Z_STREAM_END) throw std::runtime_error("cannot gzip");
  return packed;
}

}  // namespace spinaltap::test
