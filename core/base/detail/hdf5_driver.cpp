#include "core/base/detail/hdf5_driver.h"

#include <fcntl.h>
#include <hdf5.h>
#include <sys/file.h>  // flock
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/file_lock.h"

namespace spinaltap {
namespace {

/// What was to be written when the disk had rejected already. HDF5 reads back some of it before it closes.
struct LatePiece {
  haddr_t address;
  std::vector<unsigned char> bytes;
};

/// An open file. HDF5 knows it by its first member.
struct StoppingFile {
  H5FD_t pub;
  int descriptor;
  int error;    ///< of the first write that failed
  haddr_t eoa;  ///< end of what HDF5 has given out
  haddr_t eof;  ///< end of the file, as HDF5 believes it to be
  dev_t device;
  ino_t inode;
  std::vector<LatePiece> late;  ///< in the order in which they came
};
static_assert(std::is_standard_layout_v<StoppingFile>);

StoppingFile& own(H5FD_t* file) { return *reinterpret_cast<StoppingFile*>(file); }
const StoppingFile& own(const H5FD_t* file) { return *reinterpret_cast<const StoppingFile*>(file); }

H5FD_t* open_file(const char* name, unsigned flags, hid_t /*access*/, haddr_t /*most*/) {
  int mode = (flags & H5F_ACC_RDWR) != 0 ? O_RDWR : O_RDONLY;
  if ((flags & H5F_ACC_CREAT) != 0) mode |= O_CREAT;
  if ((flags & H5F_ACC_TRUNC) != 0) mode |= O_TRUNC;
  if ((flags & H5F_ACC_EXCL) != 0) mode |= O_EXCL;
  const int descriptor = ::open(name, mode | O_CLOEXEC, 0666);
  struct stat status {};
  if (descriptor < 0) return nullptr;
  if (::fstat(descriptor, &status) != 0) {
    ::close(descriptor);
    return nullptr;
  }
  auto file = std::make_unique<StoppingFile>();
  file->descriptor = descriptor;
  file->eof = static_cast<haddr_t>(status.st_size);
  file->device = status.st_dev;
  file->inode = status.st_ino;
  return &file.release()->pub;
}

herr_t close_file(H5FD_t* file) {
  const std::unique_ptr<StoppingFile> last(&own(file));
  return ::close(last->descriptor) == 0 ? 0 : -1;
}

int compare(const H5FD_t* a, const H5FD_t* b) {
  const auto key = [](const H5FD_t* file) { return std::pair(own(file).device, own(file).inode); };
  return key(a) < key(b) ? -1 : key(b) < key(a) ? 1 : 0;
}

herr_t features(const H5FD_t* /*file*/, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_SUPPORTS_SWMR_IO | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  return 0;
}

haddr_t get_eoa(const H5FD_t* file, H5FD_mem_t /*type*/) { return own(file).eoa; }
haddr_t get_eof(const H5FD_t* file, H5FD_mem_t /*type*/) { return own(file).eof; }

herr_t set_eoa(H5FD_t* file, H5FD_mem_t /*type*/, haddr_t address) {
  own(file).eoa = address;
  return 0;
}

herr_t get_handle(H5FD_t* file, hid_t /*access*/, void** handle) {
  *handle = file;
  return 0;
}

herr_t read_disk(int descriptor, haddr_t address, size_t size, unsigned char* to) {
  while (size > 0) {
    const ssize_t got = ::pread(descriptor, to, size, static_cast<off_t>(address));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return -1;
    if (got == 0) {  // beyond the end: zeros, as HDF5's own driver has it
      std::memset(to, 0, size);
      break;
    }
    to += got;
    size -= static_cast<size_t>(got);
    address += static_cast<haddr_t>(got);
  }
  return 0;
}

herr_t read_bytes(H5FD_t* file, H5FD_mem_t /*type*/, hid_t /*transfer*/, haddr_t address, size_t size, void* buffer) {
  auto* to = static_cast<unsigned char*>(buffer);
  if (read_disk(own(file).descriptor, address, size, to) < 0) return -1;
  for (const LatePiece& piece : own(file).late) {
    const haddr_t first = std::max(address, piece.address);
    const haddr_t end = std::min(address + size, piece.address + piece.bytes.size());
    if (first >= end) continue;
    std::copy_n(piece.bytes.data() + (first - piece.address), end - first, to + (first - address));
  }
  return 0;
}

herr_t write_bytes(H5FD_t* file, H5FD_mem_t /*type*/, hid_t /*transfer*/, haddr_t address, size_t size,
                   const void* buffer) {
  StoppingFile& to = own(file);
  const auto* from = static_cast<const unsigned char*>(buffer);
  to.eof = std::max(to.eof, address + size);
  while (size > 0 && to.error == 0) {
    const ssize_t put = ::pwrite(to.descriptor, from, size, static_cast<off_t>(address));
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) {
      to.error = put < 0 ? errno : ENOSPC;
      break;
    }
    from += put;
    size -= static_cast<size_t>(put);
    address += static_cast<haddr_t>(put);
  }
  try {
    if (size > 0) to.late.push_back({address, {from, from + size}});
  } catch (const std::bad_alloc&) {
    return -1;
  }
  return 0;
}

herr_t cut(H5FD_t* file, hid_t /*transfer*/, hbool_t /*closing*/) {
  StoppingFile& to = own(file);
  if (to.eoa == to.eof) return 0;
  if (to.error == 0 && ::ftruncate(to.descriptor, static_cast<off_t>(to.eoa)) != 0) to.error = errno;
  to.eof = to.eoa;
  return 0;
}

/// Some file systems know no locks; they do without.
herr_t lock(H5FD_t* file, hbool_t for_writing) {
  const FileLock lock = try_lock(own(file).descriptor, for_writing);
  return lock == FileLock::held || lock == FileLock::no_locking ? 0 : -1;
}
herr_t unlock(H5FD_t* file) {
  ::flock(own(file).descriptor, LOCK_UN);  // fails only where there was nothing to unlock
  return 0;
}

H5FD_class_t stopping_driver() {
  H5FD_class_t driver{};
  detail::set_driver_version(driver);
  driver.name = "stopping";
  driver.maxaddr = (haddr_t{1} << 62) - 1;
  driver.fc_degree = H5F_CLOSE_STRONG;
  driver.open = open_file;
  driver.close = close_file;
  driver.cmp = compare;
  driver.query = features;
  driver.get_eoa = get_eoa;
  driver.set_eoa = set_eoa;
  driver.get_eof = get_eof;
  driver.get_handle = get_handle;
  driver.read = read_bytes;
  driver.write = write_bytes;
  driver.truncate = cut;
  driver.lock = lock;
  driver.unlock = unlock;
  const H5FD_mem_t kinds[] = H5FD_FLMAP_DICHOTOMY;
  std::copy(std::begin(kinds), std::end(kinds), driver.fl_map);
  return driver;
}

}  // namespace

std::int64_t hdf5_stopping_driver() {
  static const H5FD_class_t driver = stopping_driver();
  static const hid_t id = H5FDregister(&driver);
  return id;
}

int hdf5_write_error(std::int64_t file) {
  void* handle = nullptr;
  if (H5Fget_vfd_handle(file, H5P_DEFAULT, &handle) < 0 || handle == nullptr) return EIO;
  return static_cast<const StoppingFile*>(handle)->error;
}

}  // namespace spinaltap
