#include "cluster/bake/rank_baker.h"

#include <utility>
#include <variant>

#include "core/io/bytes.h"

namespace gigabake {

void RankBaker::handle(std::span<const std::uint8_t> order) {
  std::uint32_t known_deaths = 0;
  ByteReader(order, "order").get(known_deaths);
  if (known_deaths != deaths_) return;
  BakeOrder bake = order_from_bytes(order.subspan(sizeof known_deaths));
  process_.submit(std::move(bake.job), bake.attempt);
}

std::optional<Message> RankBaker::answer() {
  while (const auto event = process_.poll()) {
    if (const auto* baked = std::get_if<BakeProcess::Baked>(&*event))
      return Message{0, tag_report, to_bytes(BakeAnswer{baked->report, baked->attempt, baked->work})};
    if (const auto* died = std::get_if<BakeProcess::Died>(&*event)) {
      ++deaths_;
      return Message{0, tag_died, {died->why.begin(), died->why.end()}};
    }
  }
  return std::nullopt;
}

std::vector<std::uint8_t> order_bytes(std::uint32_t deaths, const CellJob& job, std::uint32_t attempt) {
  ByteWriter writer;
  writer.put(deaths);
  std::vector<std::uint8_t> bytes = writer.take();
  const std::vector<std::uint8_t> order = to_bytes(BakeOrder{job, attempt});
  bytes.insert(bytes.end(), order.begin(), order.end());
  return bytes;
}

}  // namespace gigabake
