// zlib's gz functions read plain files too, and need neither the packed nor the unpacked content as a whole in memory.

#include "core/base/file_stream.h"

#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/base/text_fields.h"

namespace spinaltap {
namespace {

constexpr std::size_t kMaxPiece = std::size_t{1} << 20;
constexpr std::size_t kBuffer = 2 * kMaxPiece;  // holds a piece, and at least as much is read at once
constexpr std::uint64_t kMaxDeflateRatio = 1032;

}  // namespace

void FileReader::Close::operator()(gzFile_s* file) const { gzclose_r(file); }

FileReader::FileReader(const std::filesystem::path& path) : name_(path.string()) {
  max_bytes_ = regular_file_size(path);
  file_.reset(gzopen(path.c_str(), "rb"));
  if (!file_) fail_as(ErrorKind::file, "cannot read ", name_);
  gzbuffer(file_.get(), 1U << 17);
  const bool is_packed = gzdirect(file_.get()) == 0;
  if (is_packed != name_.ends_with(".gz")) {
    fail(is_packed ? "expected a name that ends in .gz, found gzip data in " : "expected gzip data, found other in ",
         name_);
  }
  if (is_packed) max_bytes_ *= kMaxDeflateRatio;
  buffer_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kBuffer, max_bytes_ + 1)));
}

bool FileReader::fill(std::size_t count) {
  if (count > kMaxPiece) fail("expected pieces of at most ", kMaxPiece, " bytes, found more in ", name_);
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  if (count > buffer_.size()) return false;
  const std::size_t room = buffer_.size() - end_;
  const int got = gzread(file_.get(), buffer_.data() + end_, static_cast<unsigned>(room));
  int status = Z_OK;
  gzerror(file_.get(), &status);
  if (got < 0 || (status != Z_OK && status != Z_STREAM_END)) {
    if (status == Z_ERRNO) fail_as(ErrorKind::file, "cannot read ", name_);
    fail("expected a whole gzip file, found a damaged one or one cut short: ", name_);
  }
  end_ += static_cast<std::size_t>(got);
  read_ += static_cast<std::uint64_t>(got);
  return end_ >= count;
}

bool FileReader::line(std::string_view& text) {
  std::size_t searched = 0;
  while (true) {
    const void* found = std::memchr(buffer_.data() + begin_ + searched, '\n', end_ - begin_ - searched);
    std::size_t length = end_ - begin_;
    std::size_t taken = length;
    if (found != nullptr) {
      length = static_cast<std::size_t>(static_cast<const char*>(found) - (buffer_.data() + begin_));
      taken = length + 1;
    } else {
      searched = length;
      if (length >= kMaxPiece) fail("expected lines of at most ", kMaxPiece, " bytes, found a longer one in ", name_);
      if (fill(length + 1)) continue;
      if (length == 0) return false;
    }
    text = {buffer_.data() + begin_, length};
    if (text.ends_with('\r')) text.remove_suffix(1);
    begin_ += taken;
    return true;
  }
}

bool FileReader::skip(std::uint64_t count) {
  while (count > 0) {
    if (!has(1)) return false;
    const std::size_t piece = static_cast<std::size_t>(std::min<std::uint64_t>(count, end_ - begin_));
    begin_ += piece;
    count -= piece;
  }
  return true;
}

bool TextLines::next(std::string_view& line) {
  ++number_;
  return file_.line(line);
}

bool TextLines::next_filled(std::string_view& line) {
  while (next(line)) {
    if (!trimmed(line).empty()) return true;
  }
  return false;
}

std::string TextLines::place() const { return file_.name() + ", line " + std::to_string(number_); }

FileWriter::FileWriter(const std::filesystem::path& path) : path_(path) {
  errno = 0;
  file_.open(path, std::ios::binary | std::ios::trunc);
  check();
}

void FileWriter::write(std::string_view bytes) {
  errno = 0;
  file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  check();
}

void FileWriter::write(std::span<const double> numbers) {
  write({reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()});
}

void FileWriter::close() {
  errno = 0;
  file_.close();
  check();
}

void FileWriter::check() const {
  if (!file_) fail_as(ErrorKind::disk, "cannot write ", path_.string(), ": ", std::strerror(errno));
}

}  // namespace spinaltap
