/// HDF5's shuffle: the first bytes of all elements of a chunk, then their second ones, and so on.
///
/// Source  HDF5 file format, filter 2.
#pragma once

#include <cstdint>

#include "lattice/host_device.h"

namespace gigabake {

/// Which byte of a chunk stands at `at` once it is shuffled. Range  element_bytes divides chunk_bytes; 1: stays.
GB_HD std::uint32_t shuffled_from(std::uint32_t at, std::uint32_t chunk_bytes, std::uint32_t element_bytes) {
  if (element_bytes <= 1) return at;
  const std::uint32_t elements = chunk_bytes / element_bytes;
  return at % elements * element_bytes + at / elements;
}

}  // namespace gigabake
