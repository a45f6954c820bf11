#include "core/session/real_time/thread_rights.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <fstream>

#include "core/base/text_writer.h"

namespace spinaltap {
namespace {

std::string limit_text(rlim_t limit, rlim_t unit) {
  return limit == RLIM_INFINITY ? "unlimited" : std::to_string(limit / unit);
}

std::string warning_of(const std::string& what, int error, const std::string& limit, const std::string& name) {
  return joined(what, " not allowed for this user (", limit, "; ", std::strerror(error),
                "): run as root, or give the user \"", name, "\" in /etc/security/limits.conf");
}

/// Of this program, as the kernel counts it; 0 where it does not say.
long locked_kb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmLck:", 0) == 0) return std::stol(line.substr(6));
  }
  return 0;
}

}  // namespace

std::string ask_for_priority(int priority) {
  const sched_param parameter{.sched_priority = priority};
  const int error = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameter);
  if (error == 0) return {};
  rlimit limit{};
  ::getrlimit(RLIMIT_RTPRIO, &limit);
  return warning_of("real-time priority", error, "ulimit -r is " + limit_text(limit.rlim_cur, 1), "rtprio 60");
}

void ask_for_exact_sleeps() noexcept { ::prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL); }

void touch_stack() noexcept {
  constexpr std::size_t kPage = 4096;
  std::array<volatile unsigned char, 64 * kPage> stack;  // a step takes a few kB
  for (std::size_t at = 0; at < stack.size(); at += kPage) stack[at] = 0;
}

LockedMemory::LockedMemory() : was_locked_(locked_kb() > 0) {
  // On fault: what was never touched need not be brought in now.
  if (::mlockall(MCL_CURRENT | MCL_ONFAULT) == 0) {
    is_locked_ = true;
    return;
  }
  const int error = errno;
  rlimit limit{};
  ::getrlimit(RLIMIT_MEMLOCK, &limit);
  warning_ =
      warning_of("locked memory", error, "ulimit -l is " + limit_text(limit.rlim_cur, 1024), "memlock unlimited");
}

LockedMemory::~LockedMemory() {
  if (is_locked_ && !was_locked_) ::munlockall();
}

}  // namespace spinaltap
