#pragma once

#include <cstdint>

namespace spinaltap {

/// HDF5's access to a file that is written until the disk rejects, and not at all any more from then on: what is on the
/// disk is then what a kill at that moment would have left, which can be read. (HDF5's own driver goes on; closing then
/// writes a head that counts what was never written, or crashes.) HDF5 is not told: ask hdf5_write_error().
///
/// The driver's HDF5 identifier.
std::int64_t hdf5_stopping_driver();

/// What the disk said first of an open file (its HDF5 identifier) of that driver: an errno; 0 while all is well.
int hdf5_write_error(std::int64_t file);

namespace detail {

/// From HDF5 1.14 on a driver says which layout of its table it was compiled for, and its number: one of those that are
/// left to programs.
template <class Driver>
void set_driver_version(Driver& driver) {
  constexpr int kOfPrograms = 256;
  if constexpr (requires { driver.version; }) driver.version = 1;
  if constexpr (requires { driver.value; }) driver.value = kOfPrograms;
}

}  // namespace detail
}  // namespace spinaltap
