#include "scene_voxels.h"

#include <cstring>

#include "format/shard/levels/brick_walk.h"
#include "format/shard/shard_reader.h"

namespace gigabake::made {

SceneVoxels voxels_of_scene(const std::filesystem::path& scene_xml, int lod) {
  SceneVoxels voxels;
  for (const SceneCell& cell : read_scene(scene_xml).cells) {
    const Shard shard = read_shard(scene_xml.parent_path() / cell.file);
    for_each_voxel_of_level(
        shard.nodes, shard.levels[std::size_t(lod)], lod,
        [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t* rgba, const std::int8_t* normal,
            const std::uint8_t*, VoxelClass voxel_class) {
          const auto& low = cell.lattice_min;
          VoxelBytes& voxel = voxels[{(low[0] >> lod) + x, (low[1] >> lod) + y, (low[2] >> lod) + z}];
          std::memcpy(voxel.rgba.data(), rgba, 4);
          std::memcpy(voxel.normal.data(), normal, 2);
          voxel.voxel_class = voxel_class;
        });
  }
  return voxels;
}

SceneDescription write_random_scene(const std::filesystem::path& scene_xml, std::mt19937_64& rng, bool normals,
                                    bool classes) {
  std::vector<Shard> shards;
  const std::int64_t bottom = 8 * (std::int64_t(rng() % 64) - 32);
  for (int cell = 0; cell < 4; ++cell) {
    Shard shard = random_shard(rng, {4, normals, 3});
    shard.header.cell = "c_" + std::to_string(cell);
    shard.header.lattice_min = {64 * (cell % 2 - 1), 64 * (cell / 2 - 1), bottom + (cell % 2) * 24};
    shard.header.lattice_origin_m = {100.5, -3, 1000};
    shard.header.origin = Geodetic{48.125, -11.5, 300};
    shards.push_back(classes ? with_classes(std::move(shard)) : with_content_hash(std::move(shard)));
  }
  // Two cells of one stack have voxels in the same bricks of the coarse levels.
  Shard top = random_shard(rng, {4, normals, 3});
  top.header = shards[3].header;
  top.header.cell = "c_top";
  top.header.lattice_min[2] += 64;
  shards.push_back(classes ? with_classes(std::move(top)) : with_content_hash(std::move(top)));
  return write_scene_of(scene_xml, shards);
}

RandomScene::RandomScene(int round, bool classes) : seed_(round) {
  std::mt19937_64 rng(seed_);
  description_ = write_random_scene(xml(), rng, round % 3 != 0, classes && round % 2 == 0);
}

}  // namespace gigabake::made
