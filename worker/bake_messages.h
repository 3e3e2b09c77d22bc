/// How a supervisor and its bake process talk: frames over a local socket that both sides check.
///
///   supervisor → process   sources (the next part of WorkerSetup::sources, first), setup (WorkerSetup, once, after all
///                          of them), survey (tile, u32), bake (BakeOrder)
///   process → supervisor   started (empty, once, first: it can take requests), ready (DeviceAnswer, once), surveyed
///   (TileSurvey), baked (BakeAnswer)
///
/// A frame is magic "GBKE" u32, kind u32, payload bytes u64, XXH3-64 of the payload u64, then the payload; little
/// endian.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "format/job/cell_job.h"
#include "worker/backend.h"

namespace gigabake {

enum class BakeMessageKind : std::uint32_t { setup = 1, survey, bake, ready, surveyed, baked, sources, started };

struct BakeMessage {
  BakeMessageKind kind = BakeMessageKind::setup;
  std::vector<std::uint8_t> payload;
};

/// attempt: how often the cell was tried, this time included; the answer repeats it.
struct BakeOrder {
  CellJob job;
  std::uint32_t attempt = 1;
};

struct BakeAnswer {
  CellReport report;
  std::uint32_t attempt = 1;
};

/// The device that the process bakes on, or why it cannot have what was wished for.
struct DeviceAnswer {
  DeviceChoice choice;
  std::string error;
};

std::vector<std::uint8_t> to_bytes(const DeviceAnswer& answer);
std::vector<std::uint8_t> to_bytes(const BakeOrder& order);
std::vector<std::uint8_t> to_bytes(const BakeAnswer& answer);
std::vector<std::uint8_t> survey_request(std::uint32_t tile);
DeviceAnswer device_from_bytes(std::span<const std::uint8_t> bytes);  ///< Errors InputError when malformed
BakeOrder order_from_bytes(std::span<const std::uint8_t> bytes);      ///< Errors InputError when malformed
BakeAnswer answer_from_bytes(std::span<const std::uint8_t> bytes);    ///< Errors InputError when malformed
std::uint32_t tile_of_request(std::span<const std::uint8_t> bytes);   ///< Errors InputError when malformed

/// Errors  InputError: a payload of more than 2^30 bytes.
std::vector<std::uint8_t> frame(BakeMessageKind kind, std::span<const std::uint8_t> payload);

/// Puts frames together from bytes as they arrive.
class FrameReader {
 public:
  void add(std::span<const std::uint8_t> bytes);
  /// The next whole frame. Cost  memory follows what arrived, not what a header announces.
  /// Errors  InputError: not such a frame, too long, or a payload that is not what was sent. No later call succeeds.
  std::optional<BakeMessage> next();

 private:
  std::vector<std::uint8_t> bytes_;
  std::size_t taken_ = 0;  ///< bytes at the front that were handed out
};

}  // namespace gigabake
