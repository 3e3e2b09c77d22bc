#include "bench/levels/blocks.h"

#include <algorithm>
#include <cmath>

#include "format/scene/scene_level.h"
#include "lattice/octahedral.h"

namespace gigabake::bench {
namespace {

constexpr int parts_edge = 4, part_voxels = block_edge / parts_edge;

void add_voxel(Blocks& blocks, const LevelIndex& at, const std::array<std::int8_t, 2>& octahedral) {
  BlockIndex index;
  std::array<int, 3> local;
  for (std::size_t a = 0; a < 3; ++a) {
    index[a] = at[a] >> 4;
    local[a] = int(at[a] & 15);
  }
  Block& block = blocks[index];
  block.voxels.set(std::size_t(local[0] + block_edge * (local[1] + block_edge * local[2])));
  double normal[3];
  decode_octahedral(octahedral.data(), normal);
  for (std::size_t a = 0; a < 3; ++a) {
    block.normal_sum[a] += normal[a];
    block.place_sum[a] += local[a] + 0.5;
    block.spread[a] += normal[a] * normal[a];
  }
}

/// Calls visit(x, y, z) for every voxel.
template <class Visit>
void for_each_voxel(const BlockVoxels& voxels, const Visit& visit) {
  for (int i = 0; i < int(voxels.size()); ++i)
    if (voxels[std::size_t(i)]) visit(i % block_edge, i / block_edge % block_edge, i / (block_edge * block_edge));
}

double ramp(double x, double from, double to) { return std::clamp((x - from) / (to - from), 0.0, 1.0); }

/// Returns the RMS distance of the voxels from the plane through their mean, in blocks.
double distance_from_plane(const Block& block, const Vector3& mean) {
  double squares = 0;
  for_each_voxel(block.voxels, [&](int x, int y, int z) {
    const double off = block.normal[0] * (x + 0.5 - mean[0]) + block.normal[1] * (y + 0.5 - mean[1]) +
                       block.normal[2] * (z + 0.5 - mean[2]);
    squares += off * off;
  });
  return std::sqrt(squares / double(block.voxels.count())) / block_edge;
}

void fit_columns(Block& block) {
  std::array<std::bitset<block_edge * block_edge>, 3> seen;
  for_each_voxel(block.voxels, [&](int x, int y, int z) {
    seen[0].set(std::size_t(y + block_edge * z));
    seen[1].set(std::size_t(x + block_edge * z));
    seen[2].set(std::size_t(x + block_edge * y));
    block.parts |= std::uint64_t(1) << (x / part_voxels + parts_edge * (y / part_voxels) +
                                        parts_edge * parts_edge * (z / part_voxels));
  });
  for (std::size_t a = 0; a < 3; ++a) block.facing[a] = double(seen[a].count()) / (block_edge * block_edge);
}

void fit_plane(Block& block) {
  const double count = double(block.voxels.count());
  const double length = std::hypot(block.normal_sum[0], block.normal_sum[1], block.normal_sum[2]);
  Vector3 mean;
  for (std::size_t a = 0; a < 3; ++a) {
    mean[a] = block.place_sum[a] / count;
    block.spread[a] = std::sqrt(block.spread[a] / count);
    if (length > 0) block.normal[a] = block.normal_sum[a] / length;
  }
  for (std::size_t a = 0; a < 3; ++a) block.offset += block.normal[a] * (mean[a] - block_edge / 2.0);
  block.coherence = ramp(length / count, 0.75, 0.9) * (1 - ramp(distance_from_plane(block, mean), 0.12, 0.2));
  double seen = 0, shown = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    seen += block.facing[a];
    shown += block.spread[a];
  }
  block.area = seen / shown;
}

/// Returns the fraction of a block's plane, clipped to the block, that is surface.
double share_of_plane(const Block& b) {
  std::size_t along = 0;
  for (std::size_t a = 1; a < 3; ++a)
    if (std::abs(b.normal[a]) > std::abs(b.normal[along])) along = a;
  constexpr int lines = 8;  // along an edge of the face across that axis
  int met = 0;
  const std::size_t u = (along + 1) % 3, v = (along + 2) % 3;
  for (int j = 0; j < lines; ++j)
    for (int i = 0; i < lines; ++i) {
      const double x = (i + 0.5) / lines - 0.5, y = (j + 0.5) / lines - 0.5;
      const double at = (b.offset / block_edge - b.normal[u] * x - b.normal[v] * y) / b.normal[along];
      met += std::abs(at) <= 0.5;
    }
  return met == 0 ? 1 : std::min(1.0, b.facing[along] * (lines * lines) / met);
}

}  // namespace

Blocks read_blocks(const std::filesystem::path& scene_xml) {
  Blocks blocks;
  const SceneLevel level = open_scene_level(scene_xml, 0);
  for_each_dense_brick(level.scene, 0, [&](const LevelIndex& lowest, const DenseBrick& brick) {
    for (std::size_t i = 0; i < brick_voxels; ++i)
      if (brick.has(i) && brick.rgba[i][3] >= 128)
        add_voxel(
            blocks,
            {lowest[0] + std::int64_t(i & 7), lowest[1] + std::int64_t(i >> 3 & 7), lowest[2] + std::int64_t(i >> 6)},
            brick.normal[i]);
  });
  for (auto& [index, block] : blocks) {
    fit_columns(block);
    fit_plane(block);
    block.share = share_of_plane(block);
  }
  return blocks;
}

}  // namespace gigabake::bench
