#include "core/base/hdf5_file.h"

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string_view>

#include "core/base/detail/hdf5_parts.h"

namespace spinaltap {
namespace {

using detail::check_disk;
using detail::checked;
using detail::dimensions;
using detail::Id;
using detail::in_file;
using detail::in_memory;
using detail::QuietHdf5;
namespace fs = std::filesystem;

/// Whether the file is being written, or its writer was killed: from the flags in the file's first bytes (HDF5's
/// format, superblock version 3). Throws Error where it is no HDF5 file.
bool may_have_writer(const std::filesystem::path& path) {
  constexpr std::string_view kSignature = "\x89HDF\r\n\x1a\n";
  constexpr std::size_t kVersion = 8;
  constexpr std::size_t kFlags = 11;
  constexpr unsigned kWriters = 1U | 4U;  // of any kind; that lets others read
  std::array<char, kFlags + 1> head{};
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), head.size());
  if (!file || std::string_view(head.data(), kSignature.size()) != kSignature) {
    fail("expected an HDF5 file, found something else: ", path.string());
  }
  return head[kVersion] >= 3 && (static_cast<unsigned>(head[kFlags]) & kWriters) != 0;
}

/// Of rows, within the file's table.
Id selection(hid_t dataset, const Hdf5Row& row, std::uint64_t first, std::uint64_t count, const fs::path& path) {
  Id space(checked(H5Dget_space(dataset), "find rows in", path), H5Sclose);
  std::vector<hsize_t> start(dimensions(0, row).size(), 0);
  start[0] = first;
  checked(
      H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, dimensions(count, row).data(), nullptr),
      "find rows in", path);
  return space;
}

/// Of as many rows in memory.
Id memory_of(const Hdf5Row& row, std::uint64_t count, const fs::path& path) {
  const std::vector<hsize_t> size = dimensions(count, row);
  return {checked(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), "find rows in", path),
          H5Sclose};
}

hsize_t attribute_count(hid_t object, const fs::path& path) {
#if H5_VERSION_GE(1, 12, 0)
  H5O_info2_t info{};
  checked(H5Oget_info3(object, &info, H5O_INFO_NUM_ATTRS), "read", path);
#else
  H5O_info_t info{};
  checked(H5Oget_info2(object, &info, H5O_INFO_NUM_ATTRS), "read", path);
#endif
  return info.num_attrs;
}

}  // namespace

struct Hdf5File::Handle {
  Id file;
  std::filesystem::path path;
};

Hdf5File::Hdf5File(std::unique_ptr<Handle> handle) : handle_(std::move(handle)) {}
Hdf5File::~Hdf5File() = default;
Hdf5File::Hdf5File(Hdf5File&&) noexcept = default;
Hdf5File& Hdf5File::operator=(Hdf5File&&) noexcept = default;

Hdf5File Hdf5File::create(const std::filesystem::path& path) {
  const QuietHdf5 quiet;
  const Id access(checked(H5Pcreate(H5P_FILE_ACCESS), "make", path), H5Pclose);
  // Readers may come along, and every piece of the file's own structure has a checksum. Not newer than what HDF5 1.10
  // reads, whichever HDF5 writes it.
  checked(H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110), "make", path);
  checked(H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG), "make", path);
  checked(H5Pset_driver(access.get(), hdf5_stopping_driver(), nullptr), "make", path);
  errno = 0;
  Id file(H5Fcreate(path.c_str(), H5F_ACC_EXCL, H5P_DEFAULT, access.get()), H5Fclose);
  if (file.get() < 0 && errno != 0) fail_as(ErrorKind::disk, "cannot make ", path.string(), ": ", std::strerror(errno));
  checked(file.get(), "make", path);
  return Hdf5File(std::make_unique<Handle>(Handle{std::move(file), path}));
}

Hdf5File Hdf5File::open(const std::filesystem::path& path) {
  const bool has_writer = may_have_writer(path);
  const QuietHdf5 quiet;
  const Id access(checked(H5Pcreate(H5P_FILE_ACCESS), "open", path), H5Pclose);
  checked(H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG), "open", path);
  // HDF5's own driver does not open a file where the file system has no locks.
  checked(H5Pset_driver(access.get(), hdf5_stopping_driver(), nullptr), "open", path);
  unsigned flags = H5F_ACC_RDONLY;
  if (has_writer) {
    // What looks damaged may be half written and is read again, with waits that double. HDF5's own 100 times take
    // minutes.
    constexpr unsigned kAttempts = 8;
    checked(H5Pset_metadata_read_attempts(access.get(), kAttempts), "open", path);
    flags |= H5F_ACC_SWMR_READ;
  }
  Id file(H5Fopen(path.c_str(), flags, access.get()), H5Fclose);
  checked(file.get(), "open", path);
  return Hdf5File(std::make_unique<Handle>(Handle{std::move(file), path}));
}

void Hdf5File::make_group(const std::string& name) {
  const QuietHdf5 quiet;
  const Id group(H5Gcreate2(handle_->file.get(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  checked(group.get(), "write", handle_->path);
}

void Hdf5File::write_text(const std::string& group, const std::string& name, const std::string& text) {
  const QuietHdf5 quiet;
  const Id type(checked(H5Tcopy(H5T_C_S1), "write", handle_->path), H5Tclose);
  checked(H5Tset_size(type.get(), std::max<std::size_t>(text.size(), 1)), "write", handle_->path);
  checked(H5Tset_strpad(type.get(), H5T_STR_NULLPAD), "write", handle_->path);
  checked(H5Tset_cset(type.get(), H5T_CSET_UTF8), "write", handle_->path);
  const Id space(checked(H5Screate(H5S_SCALAR), "write", handle_->path), H5Sclose);
  const Id attribute(H5Acreate_by_name(handle_->file.get(), group.c_str(), name.c_str(), type.get(), space.get(),
                                       H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Aclose);
  checked(attribute.get(), "write", handle_->path);
  checked(H5Awrite(attribute.get(), type.get(), text.empty() ? "\0" : text.data()), "write", handle_->path);
}

std::map<std::string, std::string> Hdf5File::read_texts(const std::string& group) const {
  const QuietHdf5 quiet;
  const std::filesystem::path& path = handle_->path;
  constexpr hsize_t kMaxTexts = 1000;
  constexpr std::size_t kMaxBytes = std::size_t{64} << 20;
  const Id object(H5Gopen2(handle_->file.get(), group.c_str(), H5P_DEFAULT), H5Gclose);
  checked(object.get(), "read", path);
  const hsize_t count = attribute_count(object.get(), path);
  if (count > kMaxTexts) fail("cannot read ", path.string(), ": ", count, " texts in ", group);
  std::map<std::string, std::string> texts;
  for (hsize_t n = 0; n < count; ++n) {
    const Id attribute(H5Aopen_by_idx(object.get(), ".", H5_INDEX_NAME, H5_ITER_INC, n, H5P_DEFAULT, H5P_DEFAULT),
                       H5Aclose);
    checked(attribute.get(), "read", path);
    const Id type(checked(H5Aget_type(attribute.get()), "read", path), H5Tclose);
    const Id space(checked(H5Aget_space(attribute.get()), "read", path), H5Sclose);
    const std::size_t bytes = H5Tget_size(type.get());
    if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0 || bytes > kMaxBytes ||
        H5Sget_simple_extent_npoints(space.get()) != 1) {
      fail("cannot read ", path.string(), ": expected texts of a fixed length in ", group);
    }
    const ssize_t name_bytes = checked(H5Aget_name(attribute.get(), 0, nullptr), "read", path);
    std::string name(static_cast<std::size_t>(name_bytes), '\0');
    checked(H5Aget_name(attribute.get(), name.size() + 1, name.data()), "read", path);
    std::string text(bytes, '\0');
    checked(H5Aread(attribute.get(), type.get(), text.data()), "read", path);
    while (!text.empty() && text.back() == '\0') text.pop_back();
    texts[name] = text;
  }
  return texts;
}

Hdf5Table Hdf5File::make_table(const std::string& name, Hdf5Number number, const Hdf5Row& row, std::uint64_t chunk_rows,
                               bool compresses) {
  const QuietHdf5 quiet;
  const std::filesystem::path& path = handle_->path;
  constexpr unsigned kQuickest = 1;
  const std::vector<hsize_t> size = dimensions(0, row);
  std::vector<hsize_t> max = size;
  max[0] = H5S_UNLIMITED;
  const Id space(checked(H5Screate_simple(static_cast<int>(size.size()), size.data(), max.data()), "write", path),
                 H5Sclose);
  const Id creation(checked(H5Pcreate(H5P_DATASET_CREATE), "write", path), H5Pclose);
  checked(H5Pset_chunk(creation.get(), static_cast<int>(size.size()), dimensions(chunk_rows, row).data()), "write",
          path);
  if (compresses) {
    checked(H5Pset_shuffle(creation.get()), "write", path);
    checked(H5Pset_deflate(creation.get(), kQuickest), "write", path);
  }
  checked(H5Pset_fletcher32(creation.get()), "write", path);
  Id dataset(H5Dcreate2(handle_->file.get(), name.c_str(), in_file(number), space.get(), H5P_DEFAULT, creation.get(),
                        H5P_DEFAULT),
             H5Dclose);
  checked(dataset.get(), "write", path);
  return Hdf5Table(Hdf5Table::Handle{std::move(dataset), in_memory(number), row, 0, path});
}

Hdf5Table Hdf5File::make_row(const std::string& name, Hdf5Number number, const Hdf5Row& row) {
  const QuietHdf5 quiet;
  const std::filesystem::path& path = handle_->path;
  const std::vector<hsize_t> size = dimensions(1, row);
  const Id space(checked(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), "write", path),
                 H5Sclose);
  const Id creation(checked(H5Pcreate(H5P_DATASET_CREATE), "write", path), H5Pclose);
  checked(H5Pset_alloc_time(creation.get(), H5D_ALLOC_TIME_EARLY), "write", path);
  checked(H5Pset_fill_time(creation.get(), H5D_FILL_TIME_ALLOC), "write", path);
  Id dataset(H5Dcreate2(handle_->file.get(), name.c_str(), in_file(number), space.get(), H5P_DEFAULT, creation.get(),
                        H5P_DEFAULT),
             H5Dclose);
  checked(dataset.get(), "write", path);
  return Hdf5Table(Hdf5Table::Handle{std::move(dataset), in_memory(number), row, 1, path});
}

Hdf5Table Hdf5File::open_table(const std::string& name, Hdf5Number number, const Hdf5Row& row) const {
  const QuietHdf5 quiet;
  const std::filesystem::path& path = handle_->path;
  Id dataset(H5Dopen2(handle_->file.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
  checked(dataset.get(), "read", path);
  const Id type(checked(H5Dget_type(dataset.get()), "read", path), H5Tclose);
  const Id space(checked(H5Dget_space(dataset.get()), "read", path), H5Sclose);
  const int dimension_count = checked(H5Sget_simple_extent_ndims(space.get()), "read", path);
  std::vector<hsize_t> size(static_cast<std::size_t>(dimension_count));
  if (dimension_count > 0) H5Sget_simple_extent_dims(space.get(), size.data(), nullptr);
  const std::uint64_t rows = size.empty() ? 0 : size.front();
  if (H5Tequal(type.get(), in_file(number)) <= 0 || size.empty() || size != dimensions(rows, row)) {
    fail("cannot read ", path.string(), ": expected rows of ", row.numbers(), " numbers of ",
         H5Tget_size(in_file(number)), " bytes in ", name, ", found something else");
  }
  return Hdf5Table(Hdf5Table::Handle{std::move(dataset), in_memory(number), row, rows, path});
}

bool Hdf5File::has(const std::string& name) const {
  const QuietHdf5 quiet;
  return checked(H5Lexists(handle_->file.get(), name.c_str(), H5P_DEFAULT), "read", handle_->path) > 0;
}

void Hdf5File::let_others_read() {
  const QuietHdf5 quiet;
  checked(H5Fstart_swmr_write(handle_->file.get()), "write", handle_->path);
}

void Hdf5File::flush() {
  const QuietHdf5 quiet;
  checked(H5Fflush(handle_->file.get(), H5F_SCOPE_GLOBAL), "write", handle_->path);
  check_disk(handle_->file.get(), handle_->path);
}

void Hdf5File::close() {
  const QuietHdf5 quiet;
  // Closing writes again; what goes wrong then must be known before the file is let go.
  flush();
  checked(H5Fclose(handle_->file.release()), "close", handle_->path);
}

Hdf5Table::Hdf5Table(Handle handle)
    : handle_(std::make_shared<Handle>(std::move(handle))),
      row_bytes_(H5Tget_size(handle_->number) * handle_->row.numbers()) {}

std::uint64_t Hdf5Table::rows() const { return handle_->rows; }

void Hdf5Table::write(std::uint64_t first, std::uint64_t count, const void* numbers) {
  if (count == 0) return;
  const QuietHdf5 quiet;
  Handle& own = *handle_;
  if (first + count > own.rows) {
    checked(H5Dset_extent(own.dataset.get(), dimensions(first + count, own.row).data()), "write", own.path);
    own.rows = first + count;
  }
  const Id memory = memory_of(own.row, count, own.path);
  const Id rows = selection(own.dataset.get(), own.row, first, count, own.path);
  checked(H5Dwrite(own.dataset.get(), own.number, memory.get(), rows.get(), H5P_DEFAULT, numbers), "write", own.path);
  const Id file(checked(H5Iget_file_id(own.dataset.get()), "write", own.path), H5Fclose);
  check_disk(file.get(), own.path);
}

void Hdf5Table::read(std::uint64_t first, std::uint64_t count, void* numbers) const {
  if (count == 0) return;
  const QuietHdf5 quiet;
  const Handle& own = *handle_;
  if (first > own.rows || count > own.rows - first) {
    fail("cannot read ", own.path.string(), ": expected ", first + count, " rows, found ", own.rows);
  }
  const Id memory = memory_of(own.row, count, own.path);
  const Id rows = selection(own.dataset.get(), own.row, first, count, own.path);
  checked(H5Dread(own.dataset.get(), own.number, memory.get(), rows.get(), H5P_DEFAULT, numbers), "read", own.path);
}

}  // namespace spinaltap
