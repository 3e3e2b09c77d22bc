#include "worker/pipeline/bake_messages.h"

#include <gtest/gtest.h>
#include <random>

#include "core/base/error.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

std::vector<std::uint8_t> random_bytes(std::size_t size, std::mt19937_64& rng) {
  std::vector<std::uint8_t> bytes(size);
  for (std::uint8_t& b : bytes) b = std::uint8_t(rng());
  return bytes;
}

TEST(FrameReader, FindsEveryMessageHoweverTheBytesArrive) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  for (int round = 0; round < 200; ++round) {
    std::vector<BakeMessage> sent;
    std::vector<std::uint8_t> wire;
    for (int i = 0; i < 5; ++i) {
      sent.push_back({BakeMessageKind(1 + rng() % 5), random_bytes(rng() % 3 == 0 ? 0 : rng() % 5000, rng)});
      const auto bytes = frame(sent.back().kind, sent.back().payload);
      wire.insert(wire.end(), bytes.begin(), bytes.end());
    }
    FrameReader reader;
    std::vector<BakeMessage> got;
    for (std::size_t at = 0; at < wire.size();) {
      const std::size_t part = std::min<std::size_t>(1 + rng() % 3000, wire.size() - at);
      reader.add(std::span(wire).subspan(at, part));
      at += part;
      while (auto message = reader.next()) got.push_back(std::move(*message));
    }
    ASSERT_EQ(got.size(), sent.size());
    for (std::size_t i = 0; i < sent.size(); ++i) {
      EXPECT_EQ(got[i].kind, sent[i].kind);
      EXPECT_EQ(got[i].payload, sent[i].payload);
    }
  }
}

TEST(FrameReader, RefusesAFrameWithAnyByteChanged) {
  const std::vector<std::uint8_t> whole = frame(BakeMessageKind::scan, scan_request(7));
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::vector<std::uint8_t> bytes = whole;
    bytes[i] ^= 0x80;
    FrameReader reader;
    reader.add(bytes);
    try {
      const auto message = reader.next();  // with a longer length the reader waits for more bytes
      EXPECT_TRUE(!message || message->kind != BakeMessageKind::scan) << "byte " << i;
    } catch (const InputError&) {
      continue;
    }
  }
}

TEST(FrameReader, RefusesAnAnnouncedLengthThatNobodySends) {
  std::vector<std::uint8_t> bytes = frame(BakeMessageKind::bake, {});
  bytes[15] = 0x7f;  // the highest byte of the length
  FrameReader reader;
  reader.add(bytes);
  EXPECT_THROW(reader.next(), InputError);
}

TEST(BakeOrder, ComesBackFromItsBytesAndSoDoesTheAnswer) {
  BakeOrder order;
  order.job.name = "c_1_2_3";
  order.job.tiles = {4, 5};
  order.attempt = 3;
  order.returns_child = true;
  order.children = {{"shards/a.h5", {}}, {"shards/b.h5", {1, 2, 3}}};
  const BakeOrder back = order_from_bytes(to_bytes(order));
  EXPECT_EQ(back.job.name, order.job.name);
  EXPECT_EQ(back.job.tiles, order.job.tiles);
  EXPECT_EQ(back.attempt, 3u);
  EXPECT_TRUE(back.returns_child);
  ASSERT_EQ(back.children.size(), 2u);
  EXPECT_EQ(back.children[1].file, "shards/b.h5");
  EXPECT_EQ(back.children[1].bytes, order.children[1].bytes);
  BakeAnswer answer;
  answer.report.error = "no";
  answer.attempt = 4;
  answer.child = {9, 8};
  answer.work.counts.counts[std::size_t(WorkCounter::joins)] = 7;
  answer.work.cpu_s = 1.5;
  EXPECT_EQ(answer_from_bytes(to_bytes(answer)).report.error, "no");
  EXPECT_EQ(answer_from_bytes(to_bytes(answer)).attempt, 4u);
  EXPECT_EQ(answer_from_bytes(to_bytes(answer)).child, answer.child);
  EXPECT_EQ(answer_from_bytes(to_bytes(answer)).work.counts, answer.work.counts);
  EXPECT_EQ(answer_from_bytes(to_bytes(answer)).work.cpu_s, 1.5);
  EXPECT_EQ(tile_of_request(scan_request(77)), 77u);
}

TEST(DeviceRequest, ComesBackFromItsBytesAndIsRefusedWhereTheyAreWrong) {
  const DeviceRequest request{Backend::cuda, {2, 3}, 1, 4, true};
  EXPECT_EQ(device_request_from_bytes(to_bytes(request)), request);
  EXPECT_THROW(device_request_from_bytes(to_bytes(DeviceRequest{Backend::cuda, {}, 4, 4})), InputError);
  EXPECT_THROW(device_request_from_bytes(to_bytes(DeviceRequest{Backend::cuda, {}, -1, 4})), InputError);
  const std::vector<std::uint8_t> bytes = to_bytes(request);
  EXPECT_THROW(device_request_from_bytes(std::span(bytes).first(bytes.size() - 1)), InputError);
}

TEST(BakeOrder, IsRefusedWhereBytesAreMissing) {
  const std::vector<std::uint8_t> order = to_bytes(BakeOrder()), answer = to_bytes(BakeAnswer());
  for (std::size_t size = 0; size < order.size(); ++size)
    EXPECT_THROW(order_from_bytes(std::span(order).first(size)), InputError) << size;
  for (std::size_t size = 0; size < answer.size(); ++size)
    EXPECT_THROW(answer_from_bytes(std::span(answer).first(size)), InputError) << size;
}

}  // namespace
}  // namespace gigabake
