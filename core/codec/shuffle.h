/// HDF5's shuffle filter: the first bytes of all elements of a chunk, then all second bytes, and so on.
///
/// Source  HDF5 file format, filter 2.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"

namespace gigabake {

/// Returns the index of the unshuffled byte that the shuffle moves to `at`.
/// Range   element_bytes divides chunk_bytes; 1 means no shuffle.
GB_HD std::uint32_t shuffled_from(std::uint32_t at, std::uint32_t chunk_bytes, std::uint32_t element_bytes) {
  if (element_bytes <= 1) return at;
  const std::uint32_t elements = chunk_bytes / element_bytes;
  return at % elements * element_bytes + at / elements;
}

}  // namespace gigabake
