#include "worker/copied_levels.h"

#include <algorithm>
#include <functional>
#include <tuple>

#include "format/shard/brick_walk.h"
#include "lattice/error.h"
#include "lattice/morton.h"

namespace gigabake {
namespace {

/// A child's voxel at its place in the parent's window.
struct CopiedVoxel {
  std::uint64_t brick;  ///< Morton code
  std::uint16_t bit;    ///< x + 8y + 64z in it
  std::array<std::uint8_t, 4> rgba;
  std::array<std::int8_t, 2> normal;
  Facing facing;

  auto place() const { return std::tie(brick, bit); }
};

/// Appends what the child has of level `lod` in the window.
void add_voxels(const ChildLevels& child, const CopyWindow& window, std::uint32_t lod,
                std::vector<CopiedVoxel>& voxels) {
  std::int64_t corner[3];
  for (std::size_t a = 0; a < 3; ++a) corner[a] = (child.lattice_min[a] - window.min[a]) >> lod;
  const std::int64_t edge = window.edge >> lod;
  const auto add = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t* rgba,
                       const std::int8_t* normal, const std::uint8_t* facing) {
    const std::int64_t at[3] = {corner[0] + x, corner[1] + y, corner[2] + z};
    if (std::any_of(at, at + 3, [edge](std::int64_t v) { return v < 0 || v >= edge; })) return;
    CopiedVoxel& voxel = voxels.emplace_back();
    voxel.brick = morton(std::uint32_t(at[0] >> 3), std::uint32_t(at[1] >> 3), std::uint32_t(at[2] >> 3));
    voxel.bit = std::uint16_t((at[0] & 7) + 8 * (at[1] & 7) + 64 * (at[2] & 7));
    std::copy_n(rgba, voxel.rgba.size(), voxel.rgba.begin());
    std::copy_n(normal, voxel.normal.size(), voxel.normal.begin());
    voxel.facing = {};
    if (facing != nullptr) std::copy_n(facing, facing_bytes, voxel.facing.begin());
  };
  for_each_voxel_of_level(child.nodes, child.levels[lod - window.begin], int(lod - child.first_lod), add);
}

/// voxels: sorted by their place.
kernels::Level level_of(const std::vector<CopiedVoxel>& voxels, const CopyWindow& window) {
  kernels::Level level;
  for (const CopiedVoxel& voxel : voxels) {
    if (level.key.empty() || level.key.back() != voxel.brick) {
      level.key.push_back(voxel.brick);
      level.first.push_back(level.rgba.size() / 4);
      level.mask.resize(level.mask.size() + 8);
    }
    (level.mask.end() - 8)[voxel.bit >> 6] |= std::uint64_t(1) << (voxel.bit & 63);
    level.rgba.insert(level.rgba.end(), voxel.rgba.begin(), voxel.rgba.end());
    if (window.normals) level.normal.insert(level.normal.end(), voxel.normal.begin(), voxel.normal.end());
    if (window.facing) level.facing.insert(level.facing.end(), voxel.facing.begin(), voxel.facing.end());
  }
  level.first.push_back(level.rgba.size() / 4);
  return level;
}

}  // namespace

ChildLevels read_child_levels(const ShardReader& reader, std::uint32_t begin, std::uint32_t end) {
  const ShardHeader& h = reader.header();
  ChildLevels child{h.lattice_min, h.first_lod, {}, {}};
  if (begin == end) return child;
  child.nodes = reader.nodes();
  for (std::uint32_t lod = begin; lod < end; ++lod) child.levels.push_back(reader.level(int(lod) - int(h.first_lod)));
  return child;
}

std::vector<kernels::Level> joined_levels(std::span<const ChildLevels* const> children, const CopyWindow& window,
                                          const ThreadPool& pool) {
  std::vector<kernels::Level> levels(window.end - window.begin);
  pool.parallel_for(levels.size(), 1, [&](std::size_t l, std::size_t, int) {
    std::vector<CopiedVoxel> voxels;
    std::size_t stored = 0;
    for (const ChildLevels* child : children) stored += child->levels[l].rgba.size() / 4;
    voxels.reserve(stored);
    for (const ChildLevels* child : children) add_voxels(*child, window, window.begin + std::uint32_t(l), voxels);
    const auto before = [](const CopiedVoxel& a, const CopiedVoxel& b) { return a.place() < b.place(); };
    std::sort(voxels.begin(), voxels.end(), before);
    if (std::adjacent_find(voxels.begin(), voxels.end(), std::not_fn(before)) != voxels.end())
      throw InputError("parent", "children", "two of them have a voxel of one place");
    levels[l] = level_of(voxels, window);
  });
  return levels;
}

}  // namespace gigabake
