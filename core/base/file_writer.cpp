#include "core/base/file_writer.h"

#include <cerrno>
#include <cstring>

#include "core/base/error.h"

namespace spinaltap {

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
  if (!file_) fail("cannot write ", path_.string(), ": ", std::strerror(errno));
}

}  // namespace spinaltap
