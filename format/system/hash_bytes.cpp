#include "format/system/hash_bytes.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace gigabake {

Hash128 hash_of_bytes(std::span<const std::uint8_t> bytes) {
  const XXH128_hash_t h = XXH3_128bits(bytes.data(), bytes.size());
  return {h.low64, h.high64};
}

}  // namespace gigabake
