#include "worker/pipeline/shard_from_volume.h"

#include <gtest/gtest.h>

#include "format/shard/levels/brick_walk.h"
#include "format/shard/levels/content_hash.h"
#include "kernels/cpu/bake_cell.h"

namespace gigabake {
namespace {

kernels::CellVolume bake(const std::vector<float>& position, std::uint32_t window_voxels) {
  std::vector<std::uint32_t> index(position.size() / 3);
  for (std::uint32_t i = 0; i < index.size(); ++i) index[i] = i;
  kernels::PartView part;
  part.position = {position.data(), position.size()};
  part.index = {index.data(), index.size()};
  for (int i = 0; i < 3; ++i) part.scene_from_local[5 * i] = 1;
  const kernels::MaterialView white;
  kernels::CellParameters parameters;
  parameters.window_voxels = window_voxels;
  return kernels::bake_cell({{&part, 1}, {&white, 1}, {}}, parameters, ThreadPool(1));
}

void add_floor(std::vector<float>& position, float edge, float z) {
  position.insert(position.end(), {0, 0, z, 2 * edge, 0, z, 0, 2 * edge, z});
}

TEST(ShardFromVolume, KeepsEveryArrayAndHashesTheVoxels) {
  std::vector<float> position;
  add_floor(position, 9, 3.5f);
  const auto volume = bake(position, 32);
  ShardHeader header;
  header.cell_voxels = 32;
  header.has_directional_coverage = true;
  const Shard shard = shard_from_volume(volume, header);
  ASSERT_EQ(shard.levels.size(), 3u);
  EXPECT_EQ(shard.header.lods, 3u);
  EXPECT_EQ(shard.nodes.key, volume.nodes.key);
  EXPECT_EQ(shard.nodes.kind.size(), volume.nodes.kind.size());
  EXPECT_EQ(shard.nodes.value, volume.nodes.value);
  for (std::size_t l = 0; l < 3; ++l) {
    EXPECT_EQ(shard.levels[l].mask, volume.levels[l].mask);
    EXPECT_EQ(shard.levels[l].rgba, volume.levels[l].rgba);
    EXPECT_EQ(shard.levels[l].directional_coverage, volume.levels[l].directional_coverage);
    EXPECT_EQ(shard.levels[l].directional_coverage.size(),
              volume.levels[l].rgba.size() / 4 * directional_coverage_bytes);
  }
  EXPECT_EQ(shard.header.content_hash, content_hash(shard));
}

TEST(VoxelCounts, CountStoredVoxelsOfEachLod) {
  const Shard shard = shard_from_volume(bake({0, 0, 0.5f, 8, 0, 0.5f, 0, 8, 0.5f}, 16), {});
  const auto counts = count_voxels(shard);
  ASSERT_EQ(counts.size(), 2u);
  EXPECT_EQ(counts[0], 36u);  // 1 + 2 + … + 8
  EXPECT_EQ(counts[1], 10u);  // 1 + 2 + 3 + 4
}

TEST(VoxelCounts, CountTheVoxelsThatConstantNodesStandFor) {
  std::vector<float> position;
  for (int layer = 0; layer < 16; ++layer) add_floor(position, 16, float(layer) + 0.5f);
  const Shard shard = shard_from_volume(bake(position, 16), {});
  EXPECT_EQ(count_voxels(shard), (std::vector<std::uint64_t>{4096, 512}));
}

}  // namespace
}  // namespace gigabake
