/// Times the compression of chunks from a folder's shards: by libdeflate at level 1, by the host, and by a device.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "kernels/pack/device_pack.h"

namespace gigabake::bench {

struct PackBenchRequest {
  std::filesystem::path shards;                      ///< a folder with *.h5
  int repeats = 3;                                   ///< the minimum time counts
  std::uint64_t max_bytes = std::uint64_t(1) << 30;  ///< max raw bytes, from the first shards
};

/// Results for a data column of the shards, such as colours, summed over all levels and shards. Times are CPU seconds.
struct ColumnPacking {
  std::uint64_t chunks = 0, raw_bytes = 0, bytes = 0, libdeflate_bytes = 0;
  double seconds = 0, libdeflate_seconds = 0;
};

struct PackBench {
  std::map<std::string, ColumnPacking> columns;
  ColumnPacking all;
  std::string device_reason;  ///< the reason why no device was used; empty: a device was used
  kernels::DevicePacked device;
  bool differ = false;  ///< host and device bytes differ, or decompression does not restore the input
  double device_seconds() const;
};

/// Measures the chunks of a folder.
/// Errors  InputError: no shards, no chunk within max_bytes, or a damaged shard.
PackBench bench_pack(const PackBenchRequest& request);

}  // namespace gigabake::bench
