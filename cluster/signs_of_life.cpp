#include "cluster/signs_of_life.h"

#include "cluster/collective.h"
#include "lattice/bytes.h"

namespace gigabake {
namespace {

constexpr std::chrono::seconds between_signs{2};

}  // namespace

SignOfLife sign_from_bytes(const std::vector<std::uint8_t>& bytes) {
  SignOfLife sign;
  ByteReader reader(bytes, "sign of life");
  reader.get(sign.peak_bytes), reader.get(sign.host);
  reader.expect_end();
  return sign;
}

void SignsOfLife::show() {
  const auto now = std::chrono::steady_clock::now();
  if (shown_.time_since_epoch().count() != 0 && now - shown_ < between_signs) return;
  shown_ = now;
  ByteWriter writer;
  writer.put(process_.peak_bytes());
  writer.put(host_name());
  mpi_.send(0, tag_alive, writer.take());
}

}  // namespace gigabake
