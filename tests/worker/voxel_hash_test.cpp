// The kernels' own hash of a voxel equals the xxHash library's hash of its record.
#include "core/octree/voxel_hash.h"

#include <gtest/gtest.h>
#include <random>

#include "format/shard/levels/content_hash.h"

namespace gigabake {
namespace {

TEST(HashVoxel, IsTheLibrarysHashOfTheRecordForRandomVoxels) {
  constexpr unsigned seed = 20261;
  std::mt19937_64 random(seed);
  for (int i = 0; i < 100000; ++i) {
    const std::int32_t lod = std::int32_t(random() % 11);
    Vec3i64 corner;
    for (std::int64_t& c : corner) c = std::int64_t(random()) >> (random() % 64);
    const std::uint64_t value = random();
    std::uint8_t rgba[4];
    std::int8_t normal[2];
    for (int c = 0; c < 4; ++c) rgba[c] = std::uint8_t(value >> 8 * c);
    for (int c = 0; c < 2; ++c) normal[c] = std::int8_t(std::uint8_t(value >> (32 + 8 * c)));
    const Hash128 library = voxel_hash(lod, corner, rgba, normal);
    const Hash128 ours =
        hash_voxel(lod, corner[0], corner[1], corner[2], std::uint32_t(value), std::uint16_t(value >> 32));
    ASSERT_EQ((Hash128{ours.lo, ours.hi}), library) << "seed " << seed << " item " << i;
    const std::uint64_t more = random();
    std::uint8_t directional_coverage[directional_coverage_bytes];
    for (std::size_t b = 0; b < directional_coverage_bytes; ++b) directional_coverage[b] = std::uint8_t(more >> 8 * b);
    const Hash128 library_too = voxel_hash(lod, corner, rgba, normal, directional_coverage);
    const Hash128 ours_too = hash_voxel(lod, corner[0], corner[1], corner[2], std::uint32_t(value),
                                        std::uint16_t(value >> 32), std::uint32_t(more));
    ASSERT_EQ((Hash128{ours_too.lo, ours_too.hi}), library_too) << "facing, seed " << seed << " item " << i;
  }
}

}  // namespace
}  // namespace gigabake
