#include "worker/pipeline/bake_messages.h"

#include <algorithm>
#include <cstring>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "core/io/bytes.h"

namespace gigabake {
namespace {

constexpr std::uint32_t frame_magic = 0x454b4247;  // "GBKE"
constexpr std::int32_t no_device = -1;
constexpr std::uint64_t max_payload_bytes = std::uint64_t(1) << 30;

struct FrameHeader {
  std::uint32_t magic, kind;
  std::uint64_t bytes, xxh3;
};
static_assert(sizeof(FrameHeader) == 24);

void check(const FrameHeader& h) {
  if (h.magic != frame_magic) throw InputError("bake message", "magic", "expected a frame");
  if (h.kind < std::uint32_t(BakeMessageKind::setup) || h.kind > std::uint32_t(BakeMessageKind::device))
    throw InputError("bake message", "kind", "unknown: " + std::to_string(h.kind));
  if (h.bytes > max_payload_bytes) throw InputError("bake message", "bytes", "too long: " + std::to_string(h.bytes));
}

}  // namespace

std::vector<std::uint8_t> to_bytes(const BakeOrder& order) {
  ByteWriter w;
  w.put(order.attempt), w.put(order.returns_child), w.put(to_bytes(order.job));
  w.put(std::uint64_t(order.children.size()));
  for (const ChildBytes& child : order.children) w.put(child.file), w.put(child.bytes);
  return w.take();
}

std::vector<std::uint8_t> to_bytes(const BakeAnswer& answer) {
  ByteWriter w;
  w.put(answer.work), w.put(answer.attempt), w.put(to_bytes(answer.report)), w.put(answer.child);
  return w.take();
}

std::vector<std::uint8_t> to_bytes(const DeviceAnswer& answer) {
  ByteWriter w;
  w.put(std::int32_t(answer.choice.device.value_or(no_device)));
  w.put(answer.choice.reason);
  w.put(std::int32_t(answer.choice.sharers));
  w.put(answer.error);
  return w.take();
}

std::vector<std::uint8_t> to_bytes(const DeviceRequest& request) {
  ByteWriter w;
  w.put(request.backend);
  w.put(request.allowed);
  w.put(request.rank_on_host);
  w.put(request.ranks_on_host);
  w.put(request.only_if_needed);
  return w.take();
}

DeviceRequest device_request_from_bytes(std::span<const std::uint8_t> bytes) {
  ByteReader r(bytes, "device request");
  DeviceRequest request;
  r.get(request.backend), r.get(request.allowed), r.get(request.rank_on_host), r.get(request.ranks_on_host),
      r.get(request.only_if_needed);
  r.expect_end();
  if (request.rank_on_host < 0) throw InputError("device request", "rank_on_host", "expected 0 or more");
  if (request.ranks_on_host <= request.rank_on_host)
    throw InputError("device request", "ranks_on_host", "expected more");
  return request;
}

DeviceAnswer device_from_bytes(std::span<const std::uint8_t> bytes) {
  ByteReader r(bytes, "device answer");
  DeviceAnswer answer;
  std::int32_t device = no_device, sharers = 1;
  r.get(device), r.get(answer.choice.reason), r.get(sharers), r.get(answer.error);
  r.expect_end();
  if (device < no_device) throw InputError("device answer", "device", "expected an ordinal");
  if (sharers < 1) throw InputError("device answer", "sharers", "expected 1 or more");
  answer.choice.sharers = sharers;
  if (device != no_device) answer.choice.device = device;
  return answer;
}

std::vector<std::uint8_t> scan_request(std::uint32_t tile) {
  ByteWriter w;
  w.put(tile);
  return w.take();
}

BakeOrder order_from_bytes(std::span<const std::uint8_t> bytes) {
  ByteReader r(bytes, "bake order");
  BakeOrder order;
  std::vector<std::uint8_t> job;
  std::uint64_t children = 0;
  r.get(order.attempt), r.get(order.returns_child), r.get(job), r.get(children);
  for (; children > 0; --children) {  // terminates because get() throws at the end of the bytes
    ChildBytes& child = order.children.emplace_back();
    r.get(child.file), r.get(child.bytes);
  }
  r.expect_end();
  order.job = job_from_bytes(job);
  return order;
}

BakeAnswer answer_from_bytes(std::span<const std::uint8_t> bytes) {
  ByteReader r(bytes, "bake answer");
  BakeAnswer answer;
  std::vector<std::uint8_t> report;
  r.get(answer.work), r.get(answer.attempt), r.get(report), r.get(answer.child);
  r.expect_end();
  answer.report = report_from_bytes(report);
  return answer;
}

std::uint32_t tile_of_request(std::span<const std::uint8_t> bytes) {
  ByteReader r(bytes, "survey request");
  std::uint32_t tile = 0;
  r.get(tile);
  r.expect_end();
  return tile;
}

std::vector<std::uint8_t> frame(BakeMessageKind kind, std::span<const std::uint8_t> payload) {
  const FrameHeader h{frame_magic, std::uint32_t(kind), payload.size(), XXH3_64bits(payload.data(), payload.size())};
  check(h);
  std::vector<std::uint8_t> out(sizeof h + payload.size());
  std::memcpy(out.data(), &h, sizeof h);
  std::ranges::copy(payload, out.begin() + sizeof h);
  return out;
}

void FrameReader::add(std::span<const std::uint8_t> bytes) {
  bytes_.erase(bytes_.begin(), bytes_.begin() + std::ptrdiff_t(taken_));
  taken_ = 0;
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

std::optional<BakeMessage> FrameReader::next() {
  const std::span<const std::uint8_t> rest = std::span(bytes_).subspan(taken_);
  FrameHeader h{};
  if (rest.size() < sizeof h) return std::nullopt;
  std::memcpy(&h, rest.data(), sizeof h);
  check(h);
  if (rest.size() - sizeof h < h.bytes) return std::nullopt;
  const std::span<const std::uint8_t> payload = rest.subspan(sizeof h, h.bytes);
  if (XXH3_64bits(payload.data(), payload.size()) != h.xxh3)
    throw InputError("bake message", "xxh3", "its payload does not match its hash");
  taken_ += sizeof h + payload.size();
  return BakeMessage{BakeMessageKind(h.kind), {payload.begin(), payload.end()}};
}

}  // namespace gigabake
