// Counts the voxels of a shard's level, and finds each brick by its Morton code.
#include <core/octree/morton.h>
#include <core/octree/octree.h>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <format/shard/levels/brick_walk.h>
#include <format/shard/shard_reader.h>

int main(int arguments, char** argument) {
  if (arguments != 3) return 2;
  try {
    const int lod = std::atoi(argument[2]);
    const gigabake::ShardReader shard(argument[1]);
    const gigabake::NodeTable nodes = shard.nodes();
    std::uint64_t voxels = 0;
    gigabake::for_each_voxel_of_level(nodes, shard.level(lod), lod,
                                      [&](std::uint32_t, std::uint32_t, std::uint32_t, const std::uint8_t* rgba,
                                          const std::int8_t*) { voxels += rgba[3] > 0 ? 1 : 0; });
    for (const std::uint64_t key : nodes.key) {
      const gigabake::BrickCoordinate at = gigabake::demorton(key);
      if (gigabake::morton(at.x, at.y, at.z) != key) return 1;
    }
    std::printf("%llu\n", static_cast<unsigned long long>(voxels));
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
