#include "core/base/file_lock.h"

#include <sys/file.h>

#include <cerrno>

namespace spinaltap {

FileLock try_lock(int descriptor, bool for_writing) {
  int status = 0;
  do {
    status = ::flock(descriptor, (for_writing ? LOCK_EX : LOCK_SH) | LOCK_NB);
  } while (status != 0 && errno == EINTR);
  if (status == 0) return FileLock::held;
  switch (errno) {
    case EWOULDBLOCK:
      return FileLock::taken;
    // What network and user-space file systems without locks say.
    case ENOSYS:
    case EOPNOTSUPP:
    case EINVAL:
    case ENOLCK:
    case EPROTONOSUPPORT:
      return FileLock::no_locking;
    default:
      return FileLock::failed;
  }
}

}  // namespace spinaltap
