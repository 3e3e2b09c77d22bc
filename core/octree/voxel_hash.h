/// The hash of one voxel, computed in registers. Its sum over a level is the content hash, which
/// format/shard/levels/content_hash.h defines.
///
/// Exact   XXH3-128 (seed 0) of the 34-byte record: lod (int32), lowest corner in lod-0 voxels of the lattice (3 ×
///         int64), rgba, normal, little endian. On levels with `directional_coverage` or classes, the four bytes of
///         `directional_coverage` and the class (uint16) follow, each 0 if the level lacks it. Unsigned arithmetic:
///         host and device return the same bits.
/// Source  github.com/Cyan4973/xxHash, doc/xxhash_spec.md, XXH3 for inputs of 17 to 128 bytes.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/io/hash128.h"

namespace gigabake {

namespace xxh3 {

inline constexpr std::uint64_t prime_1 = 0x9e3779b185ebca87, prime_2 = 0xc2b2ae3d27d4eb4f, prime_4 = 0x85ebca77c2b2ae63;

/// Returns the XOR of the two halves of the 128-bit product.
GB_HD std::uint64_t fold_product(std::uint64_t a, std::uint64_t b) {
#if defined(__CUDA_ARCH__)
  return (a * b) ^ __umul64hi(a, b);
#else
  const auto product = static_cast<unsigned __int128>(a) * b;
  return std::uint64_t(product) ^ std::uint64_t(product >> 64);
#endif
}

GB_HD std::uint64_t avalanche(std::uint64_t h) {
  h ^= h >> 37;
  h *= 0x165667919e3779f9;
  return h ^ h >> 32;
}

/// Mixes four words of the input with four words of the secret into `acc`.
GB_HD void mix(Hash128& acc, std::uint64_t a, std::uint64_t b, std::uint64_t c, std::uint64_t d,
               const std::uint64_t (&secret)[4]) {
  acc.lo = (acc.lo + fold_product(a ^ secret[0], b ^ secret[1])) ^ (c + d);
  acc.hi = (acc.hi + fold_product(c ^ secret[2], d ^ secret[3])) ^ (a + b);
}

/// Hashes a record of `bytes` bytes. Words a…d are its first 32 bytes, v to y its last 32.
GB_HD Hash128 hash_record(std::uint64_t bytes, std::uint64_t a, std::uint64_t b, std::uint64_t c, std::uint64_t d,
                          std::uint64_t v, std::uint64_t w, std::uint64_t x, std::uint64_t y) {
  // Bytes 0 to 63 of XXH3's default secret.
  constexpr std::uint64_t early[4] = {0xbe4ba423396cfeb8, 0x1cad21f72c81017c, 0xdb979083e96dd4de, 0x1f67b3b7a4a44072};
  constexpr std::uint64_t late[4] = {0x78e5c0cc4ee679cb, 0x2172ffcc7dd05a82, 0x8e2443f7744608b8, 0x4c263a81e69035e0};
  Hash128 acc{bytes * prime_1, 0};
  mix(acc, c, d, v, w, late);
  mix(acc, a, b, x, y, early);
  const std::uint64_t low = acc.lo + acc.hi, high = acc.lo * prime_1 + acc.hi * prime_4 + bytes * prime_2;
  return {avalanche(low), std::uint64_t(0) - avalanche(high)};
}

}  // namespace xxh3

/// Hashes a voxel of a level without `directional_coverage`. (x, y, z) is the voxel's lowest corner in lod-0 voxels.
/// The lowest byte of `rgba` is red, and that of `normal` is its first byte.
GB_HD Hash128 hash_voxel(std::int32_t lod, std::int64_t x, std::int64_t y, std::int64_t z, std::uint32_t rgba,
                         std::uint16_t normal) {
  const auto ux = std::uint64_t(x), uy = std::uint64_t(y), uz = std::uint64_t(z);
  const std::uint64_t w0 = std::uint64_t(std::uint32_t(lod)) | ux << 32, w1 = ux >> 32 | uy << 32,
                      w2 = uy >> 32 | uz << 32, w3 = uz >> 32 | std::uint64_t(rgba) << 32;
  return xxh3::hash_record(34, w0, w1, w2, w3, w0 >> 16 | w1 << 48, w1 >> 16 | w2 << 48, w2 >> 16 | w3 << 48,
                           w3 >> 16 | std::uint64_t(normal) << 48);
}

/// Hashes a voxel of a level with `directional_coverage`. The lowest byte of `directional_coverage` is the coverage
/// along x. Levels with classes and without `directional_coverage` use 0 for the latter.
GB_HD Hash128 hash_voxel(std::int32_t lod, std::int64_t x, std::int64_t y, std::int64_t z, std::uint32_t rgba,
                         std::uint16_t normal, std::uint32_t directional_coverage, std::uint16_t voxel_class = 0) {
  const auto ux = std::uint64_t(x), uy = std::uint64_t(y), uz = std::uint64_t(z);
  const std::uint64_t w0 = std::uint64_t(std::uint32_t(lod)) | ux << 32, w1 = ux >> 32 | uy << 32,
                      w2 = uy >> 32 | uz << 32, w3 = uz >> 32 | std::uint64_t(rgba) << 32,
                      w4 = std::uint64_t(normal) | std::uint64_t(directional_coverage) << 16 |
                           std::uint64_t(voxel_class) << 48;
  return xxh3::hash_record(40, w0, w1, w2, w3, w1, w2, w3, w4);
}

}  // namespace gigabake
