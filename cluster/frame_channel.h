/// Bake messages over a socket that never blocks: what does not fit now goes later.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "worker/bake_messages.h"

namespace gigabake {

class FrameChannel {
 public:
  /// Borrows a non-blocking stream socket.
  explicit FrameChannel(int socket) : socket_(socket) {}

  /// Queues the message and sends what the socket takes.
  void send(BakeMessageKind kind, std::span<const std::uint8_t> payload);
  void flush();
  bool has_unsent() const { return !outbox_.empty(); }
  /// The next whole message among those that have arrived. Errors  InputError: the other side talks nonsense.
  std::optional<BakeMessage> receive();
  /// The other side is gone and all that it sent was received.
  bool hung_up() const { return hung_up_; }
  /// Both ways, so far.
  std::uint64_t bytes_moved() const { return bytes_moved_; }

 private:
  bool read_some();

  int socket_;
  std::deque<std::vector<std::uint8_t>> outbox_;
  std::size_t sent_of_first_ = 0;
  FrameReader inbox_;
  bool hung_up_ = false;
  std::uint64_t bytes_moved_ = 0;
};

}  // namespace gigabake
