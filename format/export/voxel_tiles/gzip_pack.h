/// Packing of bytes as a gzip file.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

struct libdeflate_compressor;

namespace gigabake {

/// A gzip compressor for one thread.
/// Exact   Same bytes for the same input and libdeflate version. The gzip header has no date and no name.
class GzipPacker {
 public:
  GzipPacker();
  ~GzipPacker();
  GzipPacker(const GzipPacker&) = delete;
  GzipPacker& operator=(const GzipPacker&) = delete;

  /// Returns the gzip file, which is valid until the next call.
  std::span<const std::uint8_t> packed(std::span<const std::uint8_t> bytes);

 private:
  libdeflate_compressor* packer_;
  std::vector<std::uint8_t> out_;  ///< reused, because allocating memory costs as much as packing
};

}  // namespace gigabake
