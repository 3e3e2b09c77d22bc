/// Protocol between a supervisor and its bake process: frames over a local socket, validated on both sides.
///
///   supervisor → process   sources (the next part of WorkerSetup::sources, first), setup (WorkerSetup, once, after all
///                          sources), `scan` (tile, u32), bake (BakeOrder)
///   process → supervisor   started (empty, once, first: requests are accepted), ready (DeviceAnswer, once),
///                          `scanned` (TileScan), baked (BakeAnswer)
///
/// A frame is magic "GBKE" u32, `kind` u32, payload bytes u64, XXH3-64 of the payload u64, then the payload; little
/// endian.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "format/job/cell_job.h"
#include "worker/pipeline/backend.h"

namespace gigabake {

enum class BakeMessageKind : std::uint32_t { setup = 1, scan, bake, ready, scanned, baked, sources, started };

struct BakeMessage {
  BakeMessageKind kind = BakeMessageKind::setup;
  std::vector<std::uint8_t> payload;
};

/// A request to bake a cell. attempt: number of attempts including this one; the answer repeats it.
struct BakeOrder {
  CellJob job;
  std::uint32_t attempt = 1;
};

struct BakeAnswer {
  CellReport report;
  std::uint32_t attempt = 1;
};

/// The device that the process bakes on, or the reason why the requested device is not available.
struct DeviceAnswer {
  DeviceChoice choice;
  std::string error;
};

std::vector<std::uint8_t> to_bytes(const DeviceAnswer& answer);
std::vector<std::uint8_t> to_bytes(const BakeOrder& order);
std::vector<std::uint8_t> to_bytes(const BakeAnswer& answer);
std::vector<std::uint8_t> scan_request(std::uint32_t tile);
DeviceAnswer device_from_bytes(std::span<const std::uint8_t> bytes);  ///< Errors  InputError when malformed
BakeOrder order_from_bytes(std::span<const std::uint8_t> bytes);      ///< Errors  InputError when malformed
BakeAnswer answer_from_bytes(std::span<const std::uint8_t> bytes);    ///< Errors  InputError when malformed
std::uint32_t tile_of_request(std::span<const std::uint8_t> bytes);   ///< Errors  InputError when malformed

/// Returns header and payload.
/// Errors  InputError: a payload of more than 2^30 bytes.
std::vector<std::uint8_t> frame(BakeMessageKind kind, std::span<const std::uint8_t> payload);

/// Assembles frames from a byte stream.
class FrameReader {
 public:
  void add(std::span<const std::uint8_t> bytes);
  /// Returns the next complete frame, if any.
  /// Cost    Memory is proportional to the bytes received, whatever length a header announces.
  /// Errors  InputError: invalid magic or `kind`, payload too long, or checksum mismatch. Every later call throws too.
  std::optional<BakeMessage> next();

 private:
  std::vector<std::uint8_t> bytes_;
  std::size_t taken_ = 0;  ///< bytes at the front that have been returned
};

}  // namespace gigabake
