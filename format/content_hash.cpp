#include "format/content_hash.h"

#define XXH_INLINE_ALL
#include <algorithm>
#include <bit>
#include <cstring>
#include <mutex>
#include <xxhash.h>

#include "format/brick_walk.h"
#include "format/parallel.h"

namespace gigabake {
namespace {

static_assert(std::endian::native == std::endian::little, "hashes are defined over little-endian integers");

constexpr std::size_t nodes_per_range = 4096;

/// Adds what node `n` stands for on its own level and, for a constant branch, on those below.
void add_node(const Shard& s, std::size_t n, std::vector<Hash128>& sums) {
  const auto hash_into = [&](int lod) {
    return [&s, &sums, lod](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t* rgba,
                            const std::int8_t* normal) {
      const auto& low = s.header.lattice_min;
      sums[std::size_t(lod)] += voxel_hash(
          lod,
          {low[0] + (std::int64_t(x) << lod), low[1] + (std::int64_t(y) << lod), low[2] + (std::int64_t(z) << lod)},
          rgba, normal);
    };
  };
  const int lod = s.nodes.lod[n];
  if (s.nodes.kind[n] == NodeKind::brick)
    return for_each_voxel(s.levels[std::size_t(lod)], s.nodes.value[n], brick_position(s.nodes.key[n]), hash_into(lod));
  const int lowest = s.nodes.kind[n] == NodeKind::leaf_constant ? 0 : lod;
  for (int l = lod; l >= lowest; --l) for_each_constant_voxel(s.nodes, n, lod - l, hash_into(l));
}

}  // namespace

Hash128 voxel_hash(int lod, std::array<std::int64_t, 3> corner_lattice, const std::uint8_t rgba[4],
                   const std::int8_t normal[2]) {
  unsigned char bytes[34];
  const std::int32_t lod32 = lod;
  std::memcpy(bytes, &lod32, 4);
  std::memcpy(bytes + 4, corner_lattice.data(), 24);
  std::memcpy(bytes + 28, rgba, 4);
  std::memcpy(bytes + 32, normal, 2);
  const XXH128_hash_t h = XXH3_128bits(bytes, sizeof bytes);
  return {h.low64, h.high64};
}

std::vector<Hash128> content_hash(const Shard& shard, int threads) {
  std::vector<Hash128> total(shard.header.lods);
  std::mutex mutex;
  parallel_ranges(shard.nodes.key.size(), nodes_per_range, threads, [&](std::size_t begin, std::size_t end) {
    std::vector<Hash128> sums(shard.header.lods);
    for (std::size_t n = begin; n < end; ++n) add_node(shard, n, sums);
    const std::scoped_lock lock(mutex);
    for (std::size_t lod = 0; lod < sums.size(); ++lod) total[lod] += sums[lod];
  });
  return total;
}

}  // namespace gigabake
