#include "bench/accuracy/reference_voxels.h"

#include <algorithm>

#include "format/scene/scene_level.h"
#include "format/shard/levels/brick_walk.h"

namespace gigabake::bench {
namespace {

std::uint64_t key_of(std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr std::uint64_t maximum = (1u << 21) - 1;
  return (std::uint64_t(x) & maximum) | (std::uint64_t(y) & maximum) << 21 | (std::uint64_t(z) & maximum) << 42;
}

}  // namespace

ReferenceVoxels::ReferenceVoxels(const SceneDescription& scene, const std::filesystem::path& scene_path, int lod) {
  if (!scene.cells.empty()) origin_ = scene.cells[0].lattice_min;
  const PagedScene paged(scene_path);
  for (const SceneCell& cell : scene.cells) {
    const ReadLevel read = read_level(paged, cell, lod);
    add_cell((cell.lattice_min - origin_) >> lod, read.nodes, read.level, lod);
  }
}

void ReferenceVoxels::add_cell(const Vec3i64& corner, const NodeTable& nodes, const BrickLevel& level, int lod) {
  for (std::size_t n = 0; n < nodes.key.size(); ++n) {
    const int above = nodes.lod[n] - lod;
    if (above < 0 || (above > 0 && nodes.kind[n] != NodeKind::leaf_constant)) continue;
    const BrickCoordinate at = demorton(nodes.key[n]);
    const int bits = 3 + above;
    const std::uint64_t key =
        key_of((corner[0] >> bits) + at.x, (corner[1] >> bits) + at.y, (corner[2] >> bits) + at.z);
    if (nodes.kind[n] == NodeKind::brick)
      std::copy_n(&level.mask[8 * std::size_t(nodes.value[n])], 8, bricks_[key].begin());
    else
      constants_[above].insert(key);
  }
}

bool ReferenceVoxels::exists(const Vec3i64& v) const {
  const auto brick = bricks_.find(key_of(v[0] >> 3, v[1] >> 3, v[2] >> 3));
  if (brick != bricks_.end() && (brick->second[std::size_t(v[2] & 7)] >> ((v[0] & 7) + 8 * (v[1] & 7)) & 1) != 0)
    return true;
  return std::any_of(constants_.begin(), constants_.end(), [&](const auto& level) {
    const int bits = 3 + level.first;
    return level.second.count(key_of(v[0] >> bits, v[1] >> bits, v[2] >> bits)) != 0;
  });
}

}  // namespace gigabake::bench
