#include "format/scene/scene_level.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <fmt/format.h>
#include <map>

#include "core/base/error.h"
#include "format/scene/expanded_leaves.h"
#include "format/scene/shard_of_scene.h"
#include "format/shard/levels/brick_walk.h"
#include "format/shard/levels/coarse_levels.h"
#include "format/shard/levels/content_hash.h"

namespace gigabake {
namespace {

/// Visits the 8^down bricks that a constant node represents `down` levels below its own.
void visit_constant(const NodeTable& nodes, std::size_t node, int down, const LevelIndex& cell,
                    const VisitBrick& visit) {
  const std::uint32_t v = nodes.value[node];
  const std::uint8_t rgba[4] = {std::uint8_t(v), std::uint8_t(v >> 8), std::uint8_t(v >> 16), std::uint8_t(v >> 24)};
  DenseBrick brick;
  for (std::size_t voxel = 0; voxel < brick_voxels; ++voxel)
    brick.set(voxel, rgba, nodes.normal[node].data(), class_of_constant(nodes, node));
  const std::int64_t edge = std::int64_t(1) << down;
  const LevelIndex at = cell + LevelIndex(demorton(nodes.key[node])) * (brick_edge * edge);
  for (std::int64_t z = 0; z < edge; ++z)
    for (std::int64_t y = 0; y < edge; ++y)
      for (std::int64_t x = 0; x < edge; ++x) visit(at + LevelIndex{x, y, z} * brick_edge, brick);
}

std::uint64_t voxels_in(const DenseBrick& brick) {
  std::uint64_t voxels = 0;
  for (const std::uint64_t word : brick.mask) voxels += std::uint64_t(std::popcount(word));
  return voxels;
}

/// Distributes the voxels of a brick that is not aligned with the blocks to one part per block.
void visit_parts(const LevelIndex& lowest, const DenseBrick& brick, const VisitBrick& visit) {
  std::map<LevelIndex, DenseBrick> parts;
  for (std::size_t voxel = 0; voxel < brick_voxels; ++voxel) {
    if (!brick.has(voxel)) continue;
    const LevelIndex at{lowest[0] + std::int64_t(voxel & 7), lowest[1] + std::int64_t(voxel >> 3 & 7),
                        lowest[2] + std::int64_t(voxel >> 6)};
    const std::size_t in_block = std::size_t((at[0] & 7) + 8 * (at[1] & 7) + 64 * (at[2] & 7));
    parts[{at[0] & ~7, at[1] & ~7, at[2] & ~7}].set(in_block, brick.rgba[voxel].data(), brick.normal[voxel].data(),
                                                    brick.voxel_class[voxel]);
  }
  for (const auto& [block, part] : parts) visit(block, part);
}

/// Returns the number of voxels of a level that the leaves of a shard represent.
std::uint64_t voxels_of_leaves(const PagedScene& scene, const SceneCell& shard, int lod) {
  const ShardReader reader = open_shard_of_scene(scene.file(), scene.header(), shard);
  if (reader.header().leaf_lod <= std::uint32_t(lod)) return 0;
  const int shard_lod = lod - int(shard.first_lod);
  const CoarseLevels above = reader.coarse_levels(shard_lod + 1);
  return voxels_of_leaves(above.nodes, above.levels, shard_lod, leaf_shape_of(scene.header()));
}

}  // namespace

void DenseBrick::set(std::size_t voxel, const std::uint8_t* colour, const std::int8_t* oct, VoxelClass of_voxel) {
  mask[voxel >> 6] |= std::uint64_t(1) << (voxel & 63);
  std::memcpy(rgba[voxel].data(), colour, 4);
  std::memcpy(normal[voxel].data(), oct, 2);
  voxel_class[voxel] = of_voxel;
}

void for_each_dense_brick(const ShardHeader& header, const NodeTable& nodes, const BrickLevel& level, int lod,
                          const VisitBrick& visit) {
  const int shard_lod = lod - int(header.first_lod);
  const LevelIndex cell = header.lattice_min >> lod;
  for (std::size_t n = 0; n < nodes.key.size() && nodes.lod[n] >= shard_lod; ++n) {
    const int down = nodes.lod[n] - shard_lod;
    if (nodes.kind[n] != NodeKind::brick) {
      if (down == 0 || nodes.kind[n] == NodeKind::leaf_constant) visit_constant(nodes, n, down, cell, visit);
      continue;
    }
    if (down != 0) continue;
    DenseBrick brick;
    for_each_voxel(
        level, nodes.value[n], {},
        [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t* rgba, const std::int8_t* normal,
            const std::uint8_t*, VoxelClass voxel_class) { brick.set(x + 8 * y + 64 * z, rgba, normal, voxel_class); });
    visit(cell + LevelIndex(demorton(nodes.key[n])) * brick_edge, brick);
  }
}

ReadLevel read_level(const PagedScene& scene, const SceneCell& shard, int lod) {
  const ShardReader reader = open_shard_of_scene(scene.file(), scene.header(), shard);
  const int shard_lod = lod - int(shard.first_lod);
  const bool has_leaves = reader.header().leaf_lod > std::uint32_t(lod);
  const CoarseLevels coarse = has_leaves ? reader.coarse_levels(shard_lod) : CoarseLevels();
  ReadLevel read{reader.header(), reader.nodes(), has_leaves ? coarse.levels.front() : reader.level(shard_lod)};
  if (content_hash(read.header, read.nodes, read.level, shard_lod) != shard.content_hash.at(std::size_t(shard_lod)))
    throw InputError(scene.folder() / shard.file, fmt::format("/lod_{}", shard_lod),
                     "the voxels do not match the content hash in scene.xml; bake again");
  if (has_leaves) expand_leaves(coarse.levels, shard_lod, leaf_shape_of(scene.header()), read.nodes, read.level);
  return read;
}

void for_each_shard_of_level(const PagedScene& scene, int lod, const PagedScene::VisitCell& visit) {
  const auto visit_if_own = [&](const SceneCell& shard) {
    if (lod >= int(shard.own_lod()) && lod < int(shard.first_lod + shard.lods)) visit(shard);
  };
  scene.for_each_cell(visit_if_own);
  scene.for_each_overview(visit_if_own);
}

std::uint64_t voxels_of_level(const PagedScene& scene, int lod) {
  const SceneTotals& totals = scene.totals();
  if (totals.cells == 0) return 0;
  std::size_t levels = totals.voxels.size();
  // Without overviews, the highest levels of a scene with several cell sizes exist only in some cells.
  if (totals.overviews == 0 && totals.cell_voxels == 0)
    scene.for_each_cell([&](const SceneCell& c) { levels = std::min(levels, std::size_t(c.lods)); });
  if (lod < 0 || std::size_t(lod) >= levels)
    throw InputError(scene.file(), "`lod`", fmt::format("there is no lod {}; expected 0 to {}", lod, levels - 1));
  return totals.voxels.at(std::size_t(lod));
}

std::uint64_t described_voxels(const PagedScene& scene, int lod) {
  std::uint64_t voxels = voxels_of_level(scene, lod);
  if (scene.header().leaf_lod > std::uint32_t(lod))
    for_each_shard_of_level(scene, lod, [&](const SceneCell& shard) { voxels += voxels_of_leaves(scene, shard, lod); });
  return voxels;
}

SceneLevel open_scene_level(const std::filesystem::path& scene_xml, int lod) {
  PagedScene scene(scene_xml);
  const std::uint64_t voxels = described_voxels(scene, lod);
  return {std::move(scene), voxels};
}

void for_each_dense_brick(const PagedScene& scene, int lod, const VisitBrick& visit, const Progress& progress) {
  voxels_of_level(scene, lod);
  for_each_shard_of_level(scene, lod, [&](const SceneCell& shard) {
    const ReadLevel read = read_level(scene, shard, lod);
    for_each_dense_brick(read.header, read.nodes, read.level, lod,
                         [&](const LevelIndex& lowest, const DenseBrick& brick) {
                           progress.advance(voxels_in(brick));
                           visit(lowest, brick);
                         });
  });
}

void for_each_block_part(const PagedScene& scene, int lod, const VisitBrick& visit, const Progress& progress) {
  const auto visit_blocks = [&](const LevelIndex& lowest, const DenseBrick& brick) {
    if (((lowest[0] | lowest[1] | lowest[2]) & 7) == 0)
      visit(lowest, brick);
    else
      visit_parts(lowest, brick, visit);
  };
  for_each_dense_brick(scene, lod, visit_blocks, progress);
}

}  // namespace gigabake
