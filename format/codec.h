/// How a shard's chunks are compressed. Both give back the same bytes.
#pragma once

#include <cstdint>

namespace gigabake {

enum class Codec : std::uint8_t {
  lz4,      ///< HDF5 filter 32004: three times as fast either way
  deflate,  ///< HDF5's own filter 1, which every HDF5 has: a quarter smaller
};

}  // namespace gigabake
