// Preloaded into the program: counts its writes into files, its syncs and its renames, and lets one of them fail.
//   SPINALTAP_FAULT=write:7    the 7th write and all after it find a full disk
//   SPINALTAP_FAULT=sync:2     the disk rejects the 2nd sync and all after it
//   SPINALTAP_FAULT=rename:1   the 1st rename fails
//   SPINALTAP_FAULT=kill:9     the process is killed at the 9th of all of these, before it is done
//   SPINALTAP_FAULT=locks:0    the file system has no locks
//   SPINALTAP_FAULT_COUNTS=FILE  gets "writes syncs renames" at the end
// What the C library writes by its own FILE is not seen; the program has none of that.

#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>

namespace {

enum Call { kWrite, kSync, kRename, kKill, kLocks };

std::atomic<long> counts[3];

struct Fault {
  int call = -1;
  long at = 0;
};

Fault wanted() {
  const char* const text = ::getenv("SPINALTAP_FAULT");
  if (text == nullptr) return {};
  constexpr const char* kNames[] = {"write:", "sync:", "rename:", "kill:", "locks:"};
  for (int call = 0; call < 5; ++call) {
    const std::size_t length = std::strlen(kNames[call]);
    if (std::strncmp(text, kNames[call], length) == 0) return {call, std::atol(text + length)};
  }
  return {};
}

/// Counts a call, and says whether it fails.
bool fails(Call call) {
  static const Fault fault = wanted();
  static std::atomic<long> all{0};
  const long n = ++counts[call];
  if (fault.call == kKill && ++all == fault.at) ::kill(::getpid(), SIGKILL);
  if (fault.call != call) return false;
  return call == kRename ? n == fault.at : n >= fault.at;
}

bool is_file(int file) {
  struct stat status {};
  return ::fstat(file, &status) == 0 && S_ISREG(status.st_mode);
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

ssize_t full() {
  errno = ENOSPC;
  return -1;
}

int rejected() {
  errno = EIO;
  return -1;
}

__attribute__((destructor)) void tell() {
  const char* const name = ::getenv("SPINALTAP_FAULT_COUNTS");
  if (name == nullptr) return;
  char text[96];
  const int length =
      ::snprintf(text, sizeof text, "%ld %ld %ld\n", counts[0].load(), counts[1].load(), counts[2].load());
  const int file = ::open(name, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (file < 0) return;
  ::syscall(SYS_write, file, text, static_cast<std::size_t>(length));
  ::close(file);
}

}  // namespace

extern "C" {

ssize_t write(int file, const void* data, size_t bytes) {
  static const auto real = next<ssize_t (*)(int, const void*, size_t)>("write");
  return is_file(file) && fails(kWrite) ? full() : real(file, data, bytes);
}
ssize_t writev(int file, const iovec* parts, int count) {
  static const auto real = next<ssize_t (*)(int, const iovec*, int)>("writev");
  return is_file(file) && fails(kWrite) ? full() : real(file, parts, count);
}
ssize_t pwrite(int file, const void* data, size_t bytes, off_t at) {
  static const auto real = next<ssize_t (*)(int, const void*, size_t, off_t)>("pwrite");
  return is_file(file) && fails(kWrite) ? full() : real(file, data, bytes, at);
}
ssize_t pwrite64(int file, const void* data, size_t bytes, off64_t at) {
  static const auto real = next<ssize_t (*)(int, const void*, size_t, off64_t)>("pwrite64");
  return is_file(file) && fails(kWrite) ? full() : real(file, data, bytes, at);
}
int fsync(int file) {
  static const auto real = next<int (*)(int)>("fsync");
  return fails(kSync) ? rejected() : real(file);
}
int fdatasync(int file) {
  static const auto real = next<int (*)(int)>("fdatasync");
  return fails(kSync) ? rejected() : real(file);
}
int flock(int file, int operation) noexcept {
  static const auto real = next<int (*)(int, int)>("flock");
  static const bool has_locks = wanted().call != kLocks;
  if (has_locks) return real(file, operation);
  errno = EOPNOTSUPP;
  return -1;
}
int rename(const char* from, const char* to) noexcept {
  static const auto real = next<int (*)(const char*, const char*)>("rename");
  return fails(kRename) ? rejected() : real(from, to);
}
int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) noexcept {
  static const auto real = next<int (*)(int, const char*, int, const char*, unsigned)>("renameat2");
  return fails(kRename) ? rejected() : real(from_folder, from, to_folder, to, flags);
}

}  // extern "C"
