/// Packs bytes as a gzip file.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

struct libdeflate_compressor;

namespace gigabake {

/// One thread's. Exact  The same bytes for the same bytes and the same libdeflate; no date, no name.
class GzipPacker {
 public:
  GzipPacker();
  ~GzipPacker();
  GzipPacker(const GzipPacker&) = delete;
  GzipPacker& operator=(const GzipPacker&) = delete;

  /// Valid until the next call.
  std::span<const std::uint8_t> packed(std::span<const std::uint8_t> bytes);

 private:
  libdeflate_compressor* packer_;
  std::vector<std::uint8_t> out_;  ///< kept: fresh memory costs as much as packing
};

}  // namespace gigabake
