/// The name of some bytes.
#pragma once

#include <cstdint>
#include <span>

#include "lattice/hash128.h"

namespace gigabake {

/// XXH3, 128 bits.
Hash128 hash_of_bytes(std::span<const std::uint8_t> bytes);

}  // namespace gigabake
