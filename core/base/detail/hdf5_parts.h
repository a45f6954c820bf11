#pragma once

#include <hdf5.h>

#include <cstring>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/base/detail/hdf5_driver.h"
#include "core/base/error.h"
#include "core/base/hdf5_file.h"
#include "core/base/process_changes.h"

// What files and tables of HDF5 share.
namespace spinaltap::detail {

/// While it lives, HDF5 prints nothing on this thread.
class QuietHdf5 {
 public:
  QuietHdf5() {
    // All is closed here long before the process ends, but a file so damaged that HDF5 cannot let it go.
    static const bool leaves_the_end_alone = allowed_process_changes().silences_hdf5_at_exit && H5dont_atexit() >= 0;
    static_cast<void>(leaves_the_end_alone);
    H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~QuietHdf5() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }
  QuietHdf5(const QuietHdf5&) = delete;
  QuietHdf5& operator=(const QuietHdf5&) = delete;

 private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

/// What went wrong where it began, in HDF5's words.
inline std::string words_of_hdf5() {
  std::string words;
  const auto take = [](unsigned n, const H5E_error2_t* error, void* data) -> herr_t {
    if (n == 0 && error->desc != nullptr) *static_cast<std::string*>(data) = error->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take, &words);
  return words.empty() ? "no reason given" : words;
}

/// Closes what it holds.
class Id {
 public:
  Id(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Id() {
    const QuietHdf5 quiet;
    if (id_ >= 0) close_(id_);
  }
  Id(Id&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Id(const Id&) = delete;
  Id& operator=(const Id&) = delete;
  Id& operator=(Id&&) = delete;

  hid_t get() const { return id_; }
  hid_t release() { return std::exchange(id_, -1); }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Throws Error unless `status` is HDF5's for success.
template <class Status>
Status checked(Status status, const char* what, const std::filesystem::path& path) {
  if (status < 0) fail("cannot ", what, " ", path.string(), ": HDF5 says: ", words_of_hdf5());
  return status;
}

/// Throws Error where the disk has rejected something.
inline void check_disk(hid_t file, const std::filesystem::path& path) {
  const int error = hdf5_write_error(file);
  if (error != 0) fail_as(ErrorKind::disk, "cannot write ", path.string(), ": ", std::strerror(error));
}

inline hid_t in_memory(Hdf5Number number) {
  switch (number) {
    case Hdf5Number::u8:
      return H5T_NATIVE_UINT8;
    case Hdf5Number::u32:
      return H5T_NATIVE_UINT32;
    case Hdf5Number::u64:
      return H5T_NATIVE_UINT64;
    case Hdf5Number::i64:
      return H5T_NATIVE_INT64;
    case Hdf5Number::f32:
      return H5T_NATIVE_FLOAT;
    case Hdf5Number::f64:
      return H5T_NATIVE_DOUBLE;
  }
  fail_as(ErrorKind::internal, "no such kind of number");
}

inline hid_t in_file(Hdf5Number number) {
  switch (number) {
    case Hdf5Number::u8:
      return H5T_STD_U8LE;
    case Hdf5Number::u32:
      return H5T_STD_U32LE;
    case Hdf5Number::u64:
      return H5T_STD_U64LE;
    case Hdf5Number::i64:
      return H5T_STD_I64LE;
    case Hdf5Number::f32:
      return H5T_IEEE_F32LE;
    case Hdf5Number::f64:
      return H5T_IEEE_F64LE;
  }
  fail_as(ErrorKind::internal, "no such kind of number");
}

/// Of a table with so many rows: one for the rows, and those of a row.
inline std::vector<hsize_t> dimensions(std::uint64_t rows, const Hdf5Row& row) {
  std::vector<hsize_t> size{rows};
  size.insert(size.end(), row.shape().begin(), row.shape().end());
  return size;
}

}  // namespace spinaltap::detail

namespace spinaltap {

struct Hdf5Table::Handle {
  detail::Id dataset;
  hid_t number;  ///< in memory
  Hdf5Row row;
  std::uint64_t rows;
  std::filesystem::path path;
};

}  // namespace spinaltap
