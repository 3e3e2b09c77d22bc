/// Bake messages over a non-blocking socket; unsent bytes are queued.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "worker/pipeline/bake_messages.h"

namespace gigabake {

class FrameChannel {
 public:
  /// Borrows a non-blocking stream socket.
  explicit FrameChannel(int socket) : socket_(socket) {}

  /// Queues the message and sends as much as the socket accepts.
  void send(BakeMessageKind kind, std::span<const std::uint8_t> payload);
  void flush();
  bool has_unsent() const { return !outbox_.empty(); }
  /// Returns the next complete message that has arrived, if any.
  /// Errors  InputError: the peer sent invalid data.
  std::optional<BakeMessage> receive();
  /// Returns true once the peer has closed the socket and everything that it sent was received.
  bool hung_up() const { return hung_up_; }
  /// Returns the bytes sent and received so far.
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
