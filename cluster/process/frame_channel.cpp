#include "cluster/process/frame_channel.h"

#include <array>
#include <cerrno>
#include <sys/socket.h>
#include <system_error>

namespace gigabake {

void FrameChannel::send(BakeMessageKind kind, std::span<const std::uint8_t> payload) {
  outbox_.push_back(frame(kind, payload));
  flush();
}

void FrameChannel::flush() {
  while (!outbox_.empty()) {
    const std::vector<std::uint8_t>& first = outbox_.front();
    const ssize_t sent =
        ::send(socket_, first.data() + sent_of_first_, first.size() - sent_of_first_, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return;
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0 && (errno == EPIPE || errno == ECONNRESET)) return outbox_.clear();  // receive() detects it too
    if (sent < 0) throw std::system_error(errno, std::generic_category(), "send to the bake process");
    bytes_moved_ += std::uint64_t(sent);
    sent_of_first_ += std::size_t(sent);
    if (sent_of_first_ < first.size()) continue;
    outbox_.pop_front();
    sent_of_first_ = 0;
  }
}

std::optional<BakeMessage> FrameChannel::receive() {
  for (;;) {
    if (auto message = inbox_.next()) return message;
    if (!read_some()) return std::nullopt;
  }
}

/// Reads some bytes; returns false if none are available.
bool FrameChannel::read_some() {
  std::array<std::uint8_t, 65536> part;
  while (!hung_up_) {
    const ssize_t got = ::recv(socket_, part.data(), part.size(), MSG_DONTWAIT);
    if (got > 0) {
      bytes_moved_ += std::uint64_t(got);
      inbox_.add(std::span(part).first(std::size_t(got)));
      return true;
    }
    if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return false;
    if (got == 0 || errno == ECONNRESET)
      hung_up_ = true;
    else if (errno != EINTR)
      throw std::system_error(errno, std::generic_category(), "receive from the bake process");
  }
  return false;
}

}  // namespace gigabake
