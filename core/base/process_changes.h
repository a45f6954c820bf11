#pragma once

namespace spinaltap {

/// What the library may change of the process that it runs in: nothing, until the program allows it.
struct ProcessChanges {
  /// The JPEG decoders within GDCM write to the standard error about every damaged picture, and cannot be told not to:
  /// while they work it leads nowhere, for all threads.
  bool silences_decoders = false;
  /// HDF5 closes what is open when the process ends, and prints where a file is so damaged that it cannot: it is told
  /// to leave the end alone. Counts from before the first record is opened.
  bool silences_hdf5_at_exit = false;
};

void allow_process_changes(const ProcessChanges& changes) noexcept;
ProcessChanges allowed_process_changes() noexcept;

}  // namespace spinaltap
