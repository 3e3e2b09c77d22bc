#include "format/shard/levels/content_hash.h"

#define XXH_INLINE_ALL
#include <algorithm>
#include <bit>
#include <cstring>
#include <mutex>
#include <xxhash.h>

#include "core/base/thread_pool.h"
#include "format/shard/levels/brick_walk.h"

namespace gigabake {
namespace {

static_assert(std::endian::native == std::endian::little, "hashes are defined over little-endian integers");

constexpr std::size_t nodes_per_range = 4096;
constexpr std::size_t record_bytes = 34, long_record_bytes = 40;
constexpr std::uint8_t no_directional_coverage[directional_coverage_bytes] = {};

void put_record(unsigned char* to, std::int32_t lod, const Vec3i64& corner_lattice, const std::uint8_t* rgba,
                const std::int8_t* normal, const std::uint8_t* directional_coverage, VoxelClass voxel_class) {
  std::memcpy(to, &lod, 4);
  std::memcpy(to + 4, corner_lattice.v, 24);
  std::memcpy(to + 28, rgba, 4);
  std::memcpy(to + 32, normal, 2);
  if (directional_coverage == nullptr) return;
  std::memcpy(to + 34, directional_coverage, directional_coverage_bytes);
  std::memcpy(to + 38, &voxel_class, sizeof voxel_class);
}

Hash128 hash_record(const unsigned char* record, bool is_long) {
  const XXH128_hash_t h = XXH3_128bits(record, is_long ? long_record_bytes : record_bytes);
  return {h.low64, h.high64};
}

/// The sum of the hashes of a level's voxels. Records are hashed in batches, after their bytes have reached the cache.
/// A hash directly after the stores of its record would stall on every voxel.
class LevelSum {
 public:
  LevelSum(int lod, const Vec3i64& lattice_min, bool has_classes)
      : lod_(lod), min_(lattice_min), has_classes_(has_classes) {}

  /// `directional_coverage` must be null for all voxels of the level, or for none.
  void add(std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t* rgba, const std::int8_t* normal,
           const std::uint8_t* directional_coverage, VoxelClass voxel_class) {
    if (has_classes_ && directional_coverage == nullptr) directional_coverage = no_directional_coverage;
    put_record(&records_[long_record_bytes * count_], lod_, min_ + (Vec3i64{x, y, z} << lod_), rgba, normal,
               directional_coverage, voxel_class);
    is_long_ = directional_coverage != nullptr;
    if (++count_ == batch) flush();
  }
  Hash128 value() {
    flush();
    return sum_;
  }

 private:
  static constexpr std::size_t batch = 256;
  void flush() {
    for (std::size_t i = 0; i < count_; ++i) sum_ += hash_record(&records_[long_record_bytes * i], is_long_);
    count_ = 0;
  }

  std::int32_t lod_;
  Vec3i64 min_;
  Hash128 sum_;
  std::size_t count_ = 0;
  bool has_classes_, is_long_ = false;
  std::array<unsigned char, batch * long_record_bytes> records_;
};

/// Adds the voxels of node `n` to the sum of the node's level. Adds a leaf-constant node to the sums of all finer
/// levels too.
void add_node(const Shard& s, std::size_t n, std::vector<LevelSum>& sums) {
  const auto add_to = [&sums](int lod) {
    return [&sum = sums[std::size_t(lod)]](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t* rgba,
                                           const std::int8_t* normal, const std::uint8_t* directional_coverage,
                                           VoxelClass voxel_class) {
      sum.add(x, y, z, rgba, normal, directional_coverage, voxel_class);
    };
  };
  const int lod = s.nodes.lod[n];
  if (s.nodes.kind[n] == NodeKind::brick)
    return for_each_voxel(s.levels[std::size_t(lod)], s.nodes.value[n], demorton(s.nodes.key[n]), add_to(lod));
  const int lowest = s.nodes.kind[n] == NodeKind::leaf_constant ? 0 : lod;
  for (int l = lod; l >= lowest; --l) for_each_constant_voxel(s.nodes, n, lod - l, add_to(l));
}

}  // namespace

Hash128 voxel_hash(int lod, Vec3i64 corner_lattice, const std::uint8_t rgba[4], const std::int8_t normal[2],
                   const std::uint8_t* directional_coverage, bool has_classes, VoxelClass voxel_class) {
  unsigned char record[long_record_bytes];
  if (has_classes && directional_coverage == nullptr) directional_coverage = no_directional_coverage;
  put_record(record, lod, corner_lattice, rgba, normal, directional_coverage, voxel_class);
  return hash_record(record, directional_coverage != nullptr);
}

std::vector<Hash128> content_hash(const Shard& shard, int threads) {
  std::vector<Hash128> total(shard.header.lods);
  std::mutex mutex;
  ThreadPool(threads).parallel_for(
      shard.nodes.key.size(), nodes_per_range, [&](std::size_t begin, std::size_t end, int) {
        std::vector<LevelSum> sums;
        for (std::uint32_t lod = 0; lod < shard.header.lods; ++lod)
          sums.emplace_back(int(shard.header.first_lod + lod), shard.header.lattice_min, shard.header.has_classes);
        for (std::size_t n = begin; n < end; ++n) add_node(shard, n, sums);
        const std::scoped_lock lock(mutex);
        for (std::size_t lod = 0; lod < sums.size(); ++lod) total[lod] += sums[lod].value();
      });
  return total;
}

Hash128 content_hash(const ShardHeader& header, const NodeTable& nodes, const BrickLevel& level, int lod) {
  LevelSum sum(int(header.first_lod) + lod, header.lattice_min, header.has_classes);
  const auto add = [&sum](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t* rgba,
                          const std::int8_t* normal, const std::uint8_t* directional_coverage, VoxelClass voxel_class) {
    sum.add(x, y, z, rgba, normal, directional_coverage, voxel_class);
  };
  for_each_voxel_of_level(nodes, level, lod, add);
  return sum.value();
}

}  // namespace gigabake
