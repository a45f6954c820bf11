#pragma once

namespace spinaltap {

enum class FileLock {
  held,        ///< by this process, until the descriptor is closed
  taken,       ///< by another process
  no_locking,  ///< the file system has no locks: nobody holds one
  failed       ///< errno says why
};

/// Asks for a lock of an open file, as flock() has them, and does not wait for it.
FileLock try_lock(int descriptor, bool for_writing);

}  // namespace spinaltap
