#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "apps/link/link_message.h"
#include "apps/link/link_thread.h"

namespace spinaltap {

using SharedBytes = std::shared_ptr<const std::string>;

/// One connection, whose socket never waits. What is to be sent lies in a queue of bounded size.
class LinkPeer {
 public:
  LinkPeer(FileDescriptor socket, std::uint64_t number, bool is_connecting, std::int64_t now_ns);

  int descriptor() const { return socket_.number(); }
  std::uint64_t number() const { return number_; }
  bool is_connecting() const { return is_connecting_; }
  /// The connection stands, or could not be made: false.
  bool finish_connecting() noexcept;

  /// What came, at most one chunk of `room`: empty where there is nothing. `is_over`: the peer has gone.
  std::string_view receive(std::span<char> room, bool& is_over) noexcept;
  LinkReader& reader() { return reader_; }

  enum class Urgency : std::uint8_t {
    now,       ///< before all else, and whatever the queue's size
    must,      ///< in order, whatever the queue's size
    while_new  ///< not where more than a little waits already
  };
  /// False where it was dropped.
  bool send(const SharedBytes& bytes, Urgency urgency);
  /// In place of what waits under this name.
  void send_surface(const std::string& name, const SharedBytes& message) { surfaces_[name] = message; }
  /// Hands the socket what it takes. False: the peer has gone.
  bool flush(std::int64_t now_ns) noexcept;
  bool has_more_to_send() const { return !queue_.empty() || !surfaces_.empty(); }
  std::size_t waiting_bytes() const { return queued_bytes_; }
  std::uint64_t take_bytes_out() noexcept;

  /// What the peer may still send, of `max_bytes_per_s`.
  bool may_receive(double max_bytes_per_s, std::int64_t now_ns) noexcept;

  /// Since when something waits and nothing was taken; 0: nothing waits.
  std::int64_t blocked_since_ns() const { return blocked_since_ns_; }
  /// Since when the reader is within a message; 0: it is not.
  std::int64_t half_since_ns() const { return half_since_ns_; }
  void note_half(std::int64_t now_ns) noexcept;

  int header_version = 1;  ///< that the peer speaks
  int bad_in_a_row = 0;
  bool is_server = false;  ///< that we connected to

 private:
  FileDescriptor socket_;
  std::uint64_t number_;
  bool is_connecting_;
  LinkReader reader_;
  std::deque<SharedBytes> queue_;
  std::size_t queued_bytes_ = 0;
  std::size_t sent_of_first_ = 0;
  std::map<std::string, SharedBytes> surfaces_;
  std::uint64_t bytes_out_ = 0;
  double budget_bytes_;
  std::int64_t budget_at_ns_;
  std::int64_t blocked_since_ns_ = 0;
  std::int64_t half_since_ns_ = 0;
};

}  // namespace spinaltap
