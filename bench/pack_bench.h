/// Times packing of the chunks that a folder's shards hold: by libdeflate's level 1, by the host, by a device.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "kernels/pack/device_pack.h"

namespace gigabake::bench {

struct PackBenchRequest {
  std::filesystem::path shards;                       ///< a folder with *.h5
  int repeats = 3;                                    ///< the fastest counts
  std::uint64_t most_bytes = std::uint64_t(1) << 30;  ///< raw bytes, of the first shards
};

/// Of a column, on every level and in every shard. Seconds of one core's time.
struct ColumnPacking {
  std::uint64_t chunks = 0, raw_bytes = 0, bytes = 0, libdeflate_bytes = 0;
  double seconds = 0, libdeflate_seconds = 0;
};

struct PackBench {
  std::map<std::string, ColumnPacking> columns;
  ColumnPacking all;
  std::string device_reason;  ///< why no device packed; empty: one did
  kernels::DevicePacked device;
  bool differ = false;  ///< the host's bytes from the device's, or what is unpacked from what was packed
  double device_seconds() const;
};

/// Errors  InputError: no shards, none with a chunk of most_bytes, or a damaged one.
PackBench bench_pack(const PackBenchRequest& request);

}  // namespace gigabake::bench
