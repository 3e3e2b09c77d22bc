/// A hash that identifies bytes.
#pragma once

#include <cstdint>
#include <span>

#include "core/io/hash128.h"

namespace gigabake {

/// Returns the 128-bit XXH3 hash of the bytes.
Hash128 hash_of_bytes(std::span<const std::uint8_t> bytes);

}  // namespace gigabake
