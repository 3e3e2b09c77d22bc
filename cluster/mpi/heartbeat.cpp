#include "cluster/mpi/heartbeat.h"

#include "cluster/mpi/collective.h"
#include "core/io/bytes.h"

namespace gigabake {
namespace {

constexpr std::chrono::seconds heartbeat_interval{2};

}  // namespace

Heartbeat heartbeat_from_bytes(const std::vector<std::uint8_t>& bytes) {
  Heartbeat sign;
  ByteReader reader(bytes, "heartbeat");
  reader.get(sign.peak_bytes), reader.get(sign.host);
  reader.expect_end();
  return sign;
}

void HeartbeatSender::show() {
  const auto now = std::chrono::steady_clock::now();
  if (shown_.time_since_epoch().count() != 0 && now - shown_ < heartbeat_interval) return;
  shown_ = now;
  ByteWriter writer;
  writer.put(process_.peak_bytes());
  writer.put(host_name());
  mpi_.send(0, tag_alive, writer.take());
}

}  // namespace gigabake
