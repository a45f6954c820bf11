#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/link/link_message.h"

namespace spinaltap::test {

/// A peer on the loopback with a plain socket.
class LinkTestPeer {
 public:
  explicit LinkTestPeer(std::uint16_t port) {
    socket_ = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    is_connected_ = ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    const int yes = 1;
    ::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  }
  explicit LinkTestPeer(int accepted, bool) : socket_(accepted), is_connected_(accepted >= 0) {}
  ~LinkTestPeer() { close(); }
  LinkTestPeer(const LinkTestPeer&) = delete;
  LinkTestPeer& operator=(const LinkTestPeer&) = delete;

  bool is_connected() const { return is_connected_; }
  void close() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
  }
  /// False where the other side has closed.
  bool send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }
  bool send_transform(const std::string& device, const LinkTransform& transform, std::uint64_t time_stamp = 0) {
    return send(pack_message("TRANSFORM", device, transform_content(transform), 1, time_stamp));
  }
  bool send_string(const std::string& device, const std::string& text) {
    return send(pack_message("STRING", device, string_content(text)));
  }

  /// The first message that is wanted, of those that came and are to come; nothing where none comes in time.
  std::optional<LinkMessage> receive(const std::function<bool(const LinkMessage&)>& is_wanted, double seconds = 5.0) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    for (std::size_t n = 0;;) {
      for (; n < messages_.size(); ++n) {
        if (!is_wanted(messages_[n])) continue;
        LinkMessage message = std::move(messages_[n]);
        messages_.erase(messages_.begin() + static_cast<std::ptrdiff_t>(n));
        return message;
      }
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
      if (left.count() <= 0 || !fetch(static_cast<int>(left.count()))) return std::nullopt;
    }
  }
  std::optional<LinkMessage> receive(const std::string& type, const std::string& device, double seconds = 5.0) {
    return receive([&](const LinkMessage& message) { return message.type == type && message.device == device; },
                   seconds);
  }
  /// The other side has closed the connection, or does so in time.
  bool is_closed(double seconds = 5.0) {
    return !receive([](const LinkMessage&) { return false; }, seconds) && is_over_;
  }

 private:
  bool fetch(int wait_ms) {
    pollfd poll{socket_, POLLIN, 0};
    if (::poll(&poll, 1, wait_ms) <= 0) return false;
    std::string room(1 << 16, '\0');
    const ssize_t got = ::recv(socket_, room.data(), room.size(), 0);
    is_over_ = got <= 0;
    if (is_over_) return false;
    // What the server sends is not all of a kind that it reads.
    bytes_.append(room, 0, static_cast<std::size_t>(got));
    constexpr std::size_t kHeader = 58;
    while (bytes_.size() >= kHeader) {
      std::uint64_t size = 0;
      for (std::size_t n = 42; n < 50; ++n) size = (size << 8U) | static_cast<unsigned char>(bytes_[n]);
      if (bytes_.size() < kHeader + size) break;
      LinkMessage message;
      message.type = bytes_.substr(2, 12).c_str();
      message.device = bytes_.substr(14, 20).c_str();
      for (std::size_t n = 34; n < 42; ++n) {
        message.time_stamp = (message.time_stamp << 8U) | static_cast<unsigned char>(bytes_[n]);
      }
      message.content = bytes_.substr(kHeader, size);
      messages_.push_back(std::move(message));
      bytes_.erase(0, kHeader + size);
    }
    return true;
  }

  int socket_ = -1;
  bool is_connected_ = false;
  bool is_over_ = false;
  std::string bytes_;
  std::deque<LinkMessage> messages_;
};

}  // namespace spinaltap::test
