#include "apps/link/detail/peer.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <utility>

namespace spinaltap {
namespace {

constexpr std::size_t kLittleBytes = std::size_t{64} << 10U;
constexpr double kBurstBytes = 1e6;

void set_option(int socket, int level, int name, int value) {
  ::setsockopt(socket, level, name, &value, sizeof value);  // without it the connection is slower, no more
}

}  // namespace

LinkPeer::LinkPeer(FileDescriptor socket, std::uint64_t number, bool is_connecting, std::int64_t now_ns)
    : socket_(std::move(socket)),
      number_(number),
      is_connecting_(is_connecting),
      budget_bytes_(kBurstBytes),
      budget_at_ns_(now_ns) {
  constexpr int kGoneMs = 5000;
  set_option(descriptor(), IPPROTO_TCP, TCP_NODELAY, 1);
  set_option(descriptor(), SOL_SOCKET, SO_KEEPALIVE, 1);
  set_option(descriptor(), IPPROTO_TCP, TCP_USER_TIMEOUT, kGoneMs);  // of a cable that was pulled
}

bool LinkPeer::finish_connecting() noexcept {
  int error = 0;
  socklen_t size = sizeof error;
  ::getsockopt(descriptor(), SOL_SOCKET, SO_ERROR, &error, &size);
  is_connecting_ = false;
  return error == 0;
}

std::string_view LinkPeer::receive(std::span<char> room, bool& is_over) noexcept {
  const ssize_t got = ::recv(descriptor(), room.data(), room.size(), MSG_DONTWAIT);
  is_over = got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR);
  if (got <= 0) return {};
  budget_bytes_ -= static_cast<double>(got);
  return {room.data(), static_cast<std::size_t>(got)};
}

bool LinkPeer::send(const SharedBytes& bytes, Urgency urgency) {
  if (urgency == Urgency::while_new && queued_bytes_ > kLittleBytes) return false;
  if (urgency == Urgency::now) {
    queue_.insert(queue_.begin() + (sent_of_first_ > 0 ? 1 : 0), bytes);
  } else {
    queue_.push_back(bytes);
  }
  queued_bytes_ += bytes->size();
  return true;
}

bool LinkPeer::flush(std::int64_t now_ns) noexcept {
  if (is_connecting_) return true;
  // A whole bone goes out in pieces: what comes from others meanwhile is not to wait for it.
  constexpr std::size_t kPieceBytes = std::size_t{128} << 10U;
  std::size_t of_surfaces = 0;
  while (has_more_to_send()) {
    if (queue_.empty()) {
      if (of_surfaces > kPieceBytes) return true;
      const auto surface = surfaces_.begin();
      queue_.push_back(surface->second);
      queued_bytes_ += surface->second->size();
      of_surfaces += surface->second->size();
      surfaces_.erase(surface);
    }
    const std::string& first = *queue_.front();
    const ssize_t sent =
        ::send(descriptor(), first.data() + sent_of_first_, first.size() - sent_of_first_, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0 && errno == EAGAIN) {
      if (blocked_since_ns_ == 0) blocked_since_ns_ = now_ns;
      return true;
    }
    if (sent < 0) return false;
    blocked_since_ns_ = 0;
    bytes_out_ += static_cast<std::uint64_t>(sent);
    sent_of_first_ += static_cast<std::size_t>(sent);
    if (sent_of_first_ < first.size()) continue;
    queued_bytes_ -= first.size();
    sent_of_first_ = 0;
    queue_.pop_front();
  }
  return true;
}

std::uint64_t LinkPeer::take_bytes_out() noexcept { return std::exchange(bytes_out_, 0); }

bool LinkPeer::may_receive(double max_bytes_per_s, std::int64_t now_ns) noexcept {
  budget_bytes_ += 1e-9 * static_cast<double>(now_ns - budget_at_ns_) * max_bytes_per_s;
  budget_bytes_ = std::min(budget_bytes_, kBurstBytes);
  budget_at_ns_ = now_ns;
  return budget_bytes_ > 0.0;
}

void LinkPeer::note_half(std::int64_t now_ns) noexcept {
  if (!reader_.is_within()) {
    half_since_ns_ = 0;
  } else if (half_since_ns_ == 0) {
    half_since_ns_ = now_ns;
  }
}

}  // namespace spinaltap
