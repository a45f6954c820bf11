#pragma once

#include <cstdint>
#include <optional>

namespace spinaltap {

/// A file descriptor that is closed at the end.
class FileDescriptor {
 public:
  FileDescriptor() = default;
  explicit FileDescriptor(int number) : number_(number) {}
  ~FileDescriptor();
  FileDescriptor(FileDescriptor&& other) noexcept;
  FileDescriptor& operator=(FileDescriptor&& other) noexcept;
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;

  int number() const { return number_; }
  bool is_open() const { return number_ >= 0; }
  void close() noexcept;

 private:
  int number_ = -1;
};

/// Wakes a thread that waits, without waiting itself.
class WakeEvent {
 public:
  /// Throws Error where the host has no descriptors left.
  WakeEvent();

  void ring() const noexcept;
  /// Until it has been rung, or until the host's monotonic clock comes to `until_ns`.
  void wait(std::int64_t until_ns) const noexcept;
  /// Forgets that it was rung.
  void silence() const noexcept;
  int descriptor() const { return descriptor_.number(); }

 private:
  FileDescriptor descriptor_;
};

}  // namespace spinaltap
