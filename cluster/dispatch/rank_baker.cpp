#include "cluster/dispatch/rank_baker.h"

#include <utility>
#include <variant>

#include "core/io/bytes.h"

namespace gigabake {

void RankBaker::handle(std::span<const std::uint8_t> order) {
  std::uint32_t known_deaths = 0;
  ByteReader(order, "order").get(known_deaths);
  if (known_deaths != deaths_) return;
  process_.submit(order_from_bytes(order.subspan(sizeof known_deaths)));
}

std::optional<Message> RankBaker::answer() {
  if (held_) return std::exchange(held_, std::nullopt);
  auto event = next_event();
  const std::optional<DeviceAnswer> now = device();
  const bool is_told = told_ && *told_ != DeviceAnswer{};  // an empty answer: no device was needed yet
  if (is_told || !now || now == told_) return event;
  told_ = now;
  held_ = std::move(event);
  return Message{0, tag_device, to_bytes(*now)};
}

/// Returns the process's device; nullopt while it is not known.
std::optional<DeviceAnswer> RankBaker::device() const {
  if (process_.device() || deaths_ < max_failed_starts) return process_.device();
  DeviceAnswer none;
  none.error = no_start_error(last_death_);
  return none;
}

std::optional<Message> RankBaker::next_event() {
  while (auto event = process_.poll()) {
    if (auto* baked = std::get_if<BakeProcess::Baked>(&*event))
      return Message{
          0, tag_report,
          to_bytes(BakeAnswer{std::move(baked->report), baked->attempt, baked->work, std::move(baked->child)})};
    if (const auto* died = std::get_if<BakeProcess::Died>(&*event)) {
      ++deaths_;
      last_death_ = died->why;
      return Message{0, tag_died, {died->why.begin(), died->why.end()}};
    }
  }
  return std::nullopt;
}

std::vector<std::uint8_t> order_bytes(std::uint32_t deaths, const BakeOrder& order) {
  ByteWriter writer;
  writer.put(deaths);
  std::vector<std::uint8_t> bytes = writer.take();
  const std::vector<std::uint8_t> rest = to_bytes(order);
  bytes.insert(bytes.end(), rest.begin(), rest.end());
  return bytes;
}

}  // namespace gigabake
