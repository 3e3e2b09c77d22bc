#include "worker/pipeline/clipped_cell.h"

#include <algorithm>
#include <bit>

#include "core/octree/morton.h"
#include "kernels/cpu/bake_cell.h"

namespace gigabake {
namespace {

constexpr std::size_t words_per_brick = 8;
constexpr std::uint64_t bricks_per_step = 8;

/// A brick of lod 0, or one with leaves, and the node that stores it. `mask` has the voxels inside the area.
struct KeptBrick {
  std::uint64_t key = 0;
  std::size_t node = 0;
  BrickMask mask{};
};

/// Lists the bricks of lod 0 in Morton order, including bricks that a constant node represents.
std::vector<KeptBrick> bricks_of(const NodeTable& nodes) {
  std::vector<KeptBrick> bricks;
  for (std::size_t n = 0; n < nodes.key.size(); ++n) {
    if (nodes.lod[n] != 0 && nodes.kind[n] != NodeKind::leaf_constant) continue;
    std::uint64_t count = 1;
    for (int level = nodes.lod[n]; level > 0; --level) count *= bricks_per_step;
    for (std::uint64_t b = 0; b < count; ++b) bricks.push_back({nodes.key[n] * count + b, n, {}});
  }
  std::sort(bricks.begin(), bricks.end(), [](const KeptBrick& a, const KeptBrick& b) { return a.key < b.key; });
  return bricks;
}

/// Lists the bricks of level `lod` that have leaves, in Morton order.
std::vector<KeptBrick> bricks_with_leaves(const NodeTable& nodes, int lod) {
  std::vector<KeptBrick> bricks;
  for (std::size_t n = 0; n < nodes.leaf_mask.size(); ++n)
    if (nodes.lod[n] == lod && nodes.leaf_mask[n] != 0) bricks.push_back({nodes.key[n], n, {}});
  return bricks;
}

/// Returns the coarsest level with leaves; 0 if there are none.
int leaf_lod_of(const NodeTable& nodes) {
  int lod = 0;
  for (std::size_t n = 0; n < nodes.leaf_mask.size(); ++n)
    if (nodes.leaf_mask[n] != 0) lod = std::max(lod, int(nodes.lod[n]));
  return lod;
}

/// Appends the voxels of a brick that are inside the area, in the order of the shard.
class LevelWriter {
 public:
  LevelWriter(const NodeTable& nodes, const BrickLevel& stored, bool has_normals)
      : nodes_(nodes), stored_(stored), has_normals_(has_normals) {}

  void add(const KeptBrick& brick) {
    const std::uint64_t first = voxels_;
    const bool is_constant = nodes_.kind[brick.node] != NodeKind::brick;
    std::uint64_t from = is_constant ? 0 : stored_.first.at(nodes_.value[brick.node]);
    BrickMask mask{};
    for (std::size_t w = 0; w < words_per_brick; ++w) {
      const std::uint64_t before =
          is_constant ? ~std::uint64_t(0) : stored_.mask.at(words_per_brick * nodes_.value[brick.node] + w);
      mask[w] = before & brick.mask[w];
      for (std::uint64_t left = before; left != 0; left &= left - 1, ++from)
        if ((mask[w] >> std::countr_zero(left) & 1) != 0) add_voxel(brick.node, is_constant, from);
    }
    if (voxels_ == first) return;
    out_.key.push_back(brick.key);
    out_.first.push_back(first);
    out_.mask.insert(out_.mask.end(), mask.begin(), mask.end());
  }

  kernels::Level take() {
    if (!out_.key.empty()) out_.first.push_back(voxels_);
    return std::move(out_);
  }

 private:
  void add_voxel(std::size_t node, bool is_constant, std::uint64_t from) {
    ++voxels_;
    for (std::size_t c = 0; c < 4; ++c)
      out_.rgba.push_back(is_constant ? std::uint8_t(nodes_.value[node] >> (8 * c)) : stored_.rgba.at(4 * from + c));
    for (std::size_t c = 0; has_normals_ && c < 2; ++c)
      out_.normal.push_back(is_constant ? nodes_.normal[node][c] : stored_.normal.at(2 * from + c));
    if (!nodes_.voxel_class.empty())
      out_.voxel_class.push_back(is_constant ? nodes_.voxel_class[node] : stored_.voxel_class.at(from));
    if (!nodes_.has_finest_planes) return;
    const DirectionalCoverage plane =
        finest_directional_coverage(is_constant ? nodes_.directional_coverage[node].data()
                                                : &stored_.directional_coverage.at(directional_coverage_bytes * from));
    out_.directional_coverage.insert(out_.directional_coverage.end(), plane.begin(), plane.end());
  }

  const NodeTable& nodes_;
  const BrickLevel& stored_;
  bool has_normals_;
  std::uint64_t voxels_ = 0;
  kernels::Level out_;
};

}  // namespace

kernels::CellVolume clipped_volume(const ShardReader& shard, const kernels::CellParameters& parameters,
                                   const AreaInScene& area, const ThreadPool& pool) {
  const NodeTable nodes = shard.nodes();
  std::vector<kernels::Level> voxelized;
  for (int lod = 0; lod <= leaf_lod_of(nodes); ++lod) {
    std::vector<KeptBrick> bricks = lod == 0 ? bricks_of(nodes) : bricks_with_leaves(nodes, lod);
    const Vec3i64 min = parameters.window_min >> lod;
    pool.parallel_for(bricks.size(), 16, [&](std::size_t begin, std::size_t end, int) {
      for (std::size_t b = begin; b < end; ++b) {
        const Vec3i64 brick = static_cast<Vec3i64>(demorton(bricks[b].key));
        bricks[b].mask = area.inside(parameters.frame, min + brick * std::int64_t(brick_edge), lod);
        for (unsigned z = 0; lod != 0 && z < bricks[b].mask.size(); ++z)
          bricks[b].mask[z] &= octant_word(nodes.leaf_mask[bricks[b].node], z);
      }
    });
    const BrickLevel stored = shard.level(lod);
    LevelWriter level(nodes, stored, parameters.normals);
    for (const KeptBrick& brick : bricks) level.add(brick);
    voxelized.push_back(level.take());
  }
  kernels::CellVolume volume = kernels::volume_of(std::move(voxelized), parameters, pool);
  volume.stats.triangles = shard.header().triangles;
  return volume;
}

}  // namespace gigabake
