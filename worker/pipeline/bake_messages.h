/// Protocol between a supervisor and its bake process: frames over a local socket, validated on both sides.
///
/// The supervisor sends, in this order: maybe one `device` (DeviceRequest), so that the device starts before the setup
/// exists; `sources` (consecutive parts of WorkerSetup::sources); one `setup` (WorkerSetup); then requests: `scan` (the
/// tile's index, u32) and `bake` (BakeOrder). The process sends one `started` (no payload) once it accepts requests and
/// one `ready` (DeviceAnswer). If the device is chosen only if needed, this `ready` states no device, and another
/// `ready` follows when it is chosen. It answers every `scan` with `scanned` (TileScan) and every `bake` with `baked`
/// (BakeAnswer).
///
/// A frame consists of magic "GBKE" (u32), `kind` (u32), size of the payload in bytes (u64), XXH3-64 of the payload
/// (u64), and the payload. All numbers are little endian.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "format/job/cell_job.h"
#include "format/job/run_work.h"
#include "worker/device/backend.h"
#include "worker/overview/child_bytes.h"

namespace gigabake {

enum class BakeMessageKind : std::uint32_t { setup = 1, scan, bake, ready, scanned, baked, sources, started, device };

struct BakeMessage {
  BakeMessageKind kind = BakeMessageKind::setup;
  std::vector<std::uint8_t> payload;
};

/// A request to bake a cell. `attempt` counts the attempts at this cell, including this one; the answer contains the
/// same number.
struct BakeOrder {
  CellJob job;
  std::uint32_t attempt = 1;
  bool returns_child = false;             ///< the answer shall contain `child`: another worker may make the overview
  std::vector<ChildBytes> children = {};  ///< overview: children that other workers baked; others are read from shards
};

struct BakeAnswer {
  CellReport report;
  std::uint32_t attempt = 1;
  RunWork work = {};  ///< the process's work since its previous answer
  /// The serialized OverviewChild of the baked cell, if it was requested and is still in memory.
  std::vector<std::uint8_t> child = {};
};

/// The device that the process bakes on, or the reason why the requested device is not available.
struct DeviceAnswer {
  DeviceChoice choice;  ///< sent without device_bytes, which only the bake process uses
  std::string error;

  bool operator==(const DeviceAnswer&) const = default;
};

std::vector<std::uint8_t> to_bytes(const DeviceAnswer& answer);
std::vector<std::uint8_t> to_bytes(const DeviceRequest& request);
std::vector<std::uint8_t> to_bytes(const BakeOrder& order);
std::vector<std::uint8_t> to_bytes(const BakeAnswer& answer);
std::vector<std::uint8_t> scan_request(std::uint32_t tile);
DeviceAnswer device_from_bytes(std::span<const std::uint8_t> bytes);  ///< Errors  InputError if `bytes` are malformed
DeviceRequest device_request_from_bytes(std::span<const std::uint8_t> bytes);  ///< Errors  InputError if malformed
BakeOrder order_from_bytes(std::span<const std::uint8_t> bytes);     ///< Errors  InputError if `bytes` are malformed
BakeAnswer answer_from_bytes(std::span<const std::uint8_t> bytes);   ///< Errors  InputError if `bytes` are malformed
std::uint32_t tile_of_request(std::span<const std::uint8_t> bytes);  ///< Errors  InputError if `bytes` are malformed

/// Returns the frame: a header followed by the payload.
/// Errors  InputError if the payload exceeds 2^30 bytes.
std::vector<std::uint8_t> frame(BakeMessageKind kind, std::span<const std::uint8_t> payload);

/// An assembler of frames from a byte stream.
class FrameReader {
 public:
  void add(std::span<const std::uint8_t> bytes);
  /// Returns the next complete frame, if any.
  /// Cost    Memory is proportional to the bytes received, whatever length a header announces.
  /// Errors  InputError if magic or `kind` is invalid, the payload is too long, or its checksum does not match. Every
  ///         later call throws too.
  std::optional<BakeMessage> next();

 private:
  std::vector<std::uint8_t> bytes_;
  std::size_t taken_ = 0;  ///< number of bytes at the front that next() has returned
};

}  // namespace gigabake
