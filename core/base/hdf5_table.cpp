#include <hdf5.h>

#include "core/base/detail/hdf5_parts.h"
#include "core/base/hdf5_file.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using detail::check_disk;
using detail::checked;
using detail::dimensions;
using detail::Id;
using detail::QuietHdf5;

/// Of rows, within the file's table.
Id selection(hid_t dataset, std::uint64_t width, std::uint64_t first, std::uint64_t count, const fs::path& path) {
  Id space(checked(H5Dget_space(dataset), "find rows in", path), H5Sclose);
  std::vector<hsize_t> start(dimensions(0, width).size(), 0);
  start[0] = first;
  checked(
      H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, dimensions(count, width).data(), nullptr),
      "find rows in", path);
  return space;
}

/// Of as many rows in memory.
Id memory_of(std::uint64_t width, std::uint64_t count, const fs::path& path) {
  const std::vector<hsize_t> size = dimensions(count, width);
  return {checked(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), "find rows in", path),
          H5Sclose};
}

}  // namespace

Hdf5Table::Hdf5Table(Handle handle)
    : handle_(std::make_shared<Handle>(std::move(handle))), row_bytes_(H5Tget_size(handle_->number) * handle_->width) {}

std::uint64_t Hdf5Table::rows() const { return handle_->rows; }

void Hdf5Table::write(std::uint64_t first, std::uint64_t count, const void* numbers) {
  if (count == 0) return;
  const QuietHdf5 quiet;
  Handle& own = *handle_;
  if (first + count > own.rows) {
    checked(H5Dset_extent(own.dataset.get(), dimensions(first + count, own.width).data()), "write", own.path);
    own.rows = first + count;
  }
  const Id memory = memory_of(own.width, count, own.path);
  const Id rows = selection(own.dataset.get(), own.width, first, count, own.path);
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
  const Id memory = memory_of(own.width, count, own.path);
  const Id rows = selection(own.dataset.get(), own.width, first, count, own.path);
  checked(H5Dread(own.dataset.get(), own.number, memory.get(), rows.get(), H5P_DEFAULT, numbers), "read", own.path);
}

}  // namespace spinaltap
