#include "viewer/web/waiting_clients.h"

#include <sys/socket.h>

namespace gigabake {

void WaitingClients::expect(int socket, Clock::time_point now) {
  heard(socket);
  const std::lock_guard lock(mutex_);
  while (in_order_.size() >= max_count_ && !in_order_.empty()) drop_oldest();
  order_of_[socket] = ++count_;
  in_order_[count_] = {socket, now};
}

void WaitingClients::heard(int socket) {
  const std::lock_guard lock(mutex_);
  const auto found = order_of_.find(socket);
  if (found == order_of_.end()) return;
  in_order_.erase(found->second);
  order_of_.erase(found);
}

void WaitingClients::drop_late(Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  while (!in_order_.empty() && now - in_order_.begin()->second.since > request_timeout_) drop_oldest();
}

void WaitingClients::drop_oldest() {
  const int socket = in_order_.begin()->second.socket;
  ::shutdown(socket, SHUT_RDWR);
  order_of_.erase(socket);
  in_order_.erase(in_order_.begin());
}

}  // namespace gigabake
