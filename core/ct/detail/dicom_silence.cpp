#include "core/ct/detail/dicom_silence.h"

#include <fcntl.h>
#include <gdcmTrace.h>
#include <unistd.h>

#include <mutex>

namespace spinaltap {
namespace {

struct Shared {
  std::mutex mutex;
  int living = 0;
  int kept = -1;  ///< the real standard error, meanwhile
};

Shared& shared() {
  static Shared instance;
  return instance;
}

}  // namespace

void silence_gdcm() {
  static const bool silent = [] {
    gdcm::Trace::DebugOff();
    gdcm::Trace::WarningOff();
    gdcm::Trace::ErrorOff();
    return true;
  }();
  static_cast<void>(silent);
}

QuietStderr::QuietStderr() {
  Shared& state = shared();
  const std::lock_guard lock(state.mutex);
  if (state.living++ > 0) return;
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  state.kept = nowhere >= 0 ? ::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 0) : -1;
  if (state.kept >= 0) ::dup2(nowhere, STDERR_FILENO);
  if (nowhere >= 0) ::close(nowhere);
}

QuietStderr::~QuietStderr() {
  Shared& state = shared();
  const std::lock_guard lock(state.mutex);
  if (--state.living > 0 || state.kept < 0) return;
  ::dup2(state.kept, STDERR_FILENO);
  ::close(state.kept);
  state.kept = -1;
}

}  // namespace spinaltap
