#include "apps/link/link_thread.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <utility>

#include "core/base/error.h"
#include "core/session/real_time/timing.h"

namespace spinaltap {

FileDescriptor::~FileDescriptor() { close(); }
FileDescriptor::FileDescriptor(FileDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
FileDescriptor& FileDescriptor::operator=(FileDescriptor&& other) noexcept {
  if (this != &other) {
    close();
    number_ = std::exchange(other.number_, -1);
  }
  return *this;
}
void FileDescriptor::close() noexcept {
  if (number_ >= 0) ::close(number_);
  number_ = -1;
}

WakeEvent::WakeEvent() : descriptor_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (!descriptor_.is_open()) fail("link: expected a free file descriptor, found: ", std::strerror(errno));
}

void WakeEvent::ring() const noexcept {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(descriptor_.number(), &one, sizeof one);  // full: it rings already
}

void WakeEvent::wait(std::int64_t until_ns) const noexcept {
  const std::int64_t left_ns = std::max<std::int64_t>(0, until_ns - wall_ns());
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::timespec left{.tv_sec = left_ns / kSecond, .tv_nsec = left_ns % kSecond};
  pollfd poll{descriptor_.number(), POLLIN, 0};
  if (::ppoll(&poll, 1, &left, nullptr) > 0) silence();
}

void WakeEvent::silence() const noexcept {
  std::uint64_t count = 0;
  [[maybe_unused]] const auto got = ::read(descriptor_.number(), &count, sizeof count);
}

}  // namespace spinaltap
