#include "voxel_scene.h"

#include <algorithm>
#include <bit>
#include <string>

#include "core/octree/parameters.h"
#include "format/shard/levels/brick_walk.h"
#include "kernels/cpu/mip/levels.h"
#include "kernels/cpu/prune/prune.h"
#include "viewer/pictures/render.h"

namespace gigabake {
namespace {

const ThreadPool& one_thread() {
  static const ThreadPool pool(1);
  return pool;
}

void paint_brick(const Painter& paint, const Vec3i64& corner, std::uint64_t key, kernels::Level& level) {
  std::uint64_t mask[8] = {};
  for (int i = 0; i < brick_voxels; ++i) {
    const auto voxel = paint(corner[0] + (i & 7), corner[1] + (i >> 3 & 7), corner[2] + (i >> 6));
    if (!voxel) continue;
    mask[i >> 6] |= std::uint64_t(1) << (i & 63);
    level.rgba.insert(level.rgba.end(), voxel->rgba.begin(), voxel->rgba.end());
    level.normal.insert(level.normal.end(), voxel->normal.begin(), voxel->normal.end());
  }
  if (level.rgba.size() / 4 == level.first.back()) return;
  level.key.push_back(key);
  level.mask.insert(level.mask.end(), mask, mask + 8);
  level.first.push_back(level.rgba.size() / 4);
}

std::vector<kernels::Level> paint_levels(const Painter& paint, const Vec3i64& min, std::uint32_t edge) {
  std::vector<kernels::Level> levels(1);
  levels[0].first.push_back(0);
  const std::uint64_t bricks = std::uint64_t(edge / 8) * (edge / 8) * (edge / 8);
  for (std::uint64_t key = 0; key < bricks; ++key) {
    const BrickCoordinate at = demorton(key);
    paint_brick(paint, {min[0] + at.x * 8, min[1] + at.y * 8, min[2] + at.z * 8}, key, levels[0]);
  }
  kernels::LevelSurface rasters;
  kernels::add_coarser_levels(levels, rasters, std::bit_width(edge / 8), MipFilter::coverage, true, one_thread());
  return levels;
}

/// Returns the tree with a brick in every node.
NodeTable nodes_of_bricks(const std::vector<kernels::Level>& levels) {
  NodeTable nodes;
  for (std::size_t lod = levels.size(); lod-- > 0;)
    for (std::size_t b = 0; b < levels[lod].key.size(); ++b) {
      const std::uint64_t key = levels[lod].key[b];
      nodes.key.push_back(key);
      nodes.lod.push_back(std::uint8_t(lod));
      nodes.kind.push_back(NodeKind::brick);
      nodes.child_mask.push_back(0);
      nodes.first_child.push_back(0xffffffff);
      nodes.value.push_back(std::uint32_t(b));
      nodes.normal.push_back({0, 0});
      nodes.directional_coverage.push_back({});
      for (std::size_t p = 0; p + 1 < nodes.key.size(); ++p) {
        if (nodes.lod[p] != lod + 1 || nodes.key[p] != key >> 3) continue;
        if (nodes.child_mask[p] == 0) nodes.first_child[p] = std::uint32_t(nodes.key.size() - 1);
        nodes.child_mask[p] |= std::uint8_t(1u << (key & 7));
      }
    }
  return nodes;
}

std::vector<NodeRow> rows_of(const NodeTable& table, std::uint32_t block) {
  std::vector<NodeRow> rows;
  const std::size_t begin = std::size_t(block) * nodes_per_block;
  for (std::size_t n = begin; n < std::min(begin + nodes_per_block, table.key.size()); ++n) {
    NodeRow row{table.first_child[n], table.value[n],     {table.normal[n][0], table.normal[n][1]}, {},
                table.kind[n],        table.child_mask[n]};
    std::copy(table.directional_coverage[n].begin(), table.directional_coverage[n].end(), row.directional_coverage);
    rows.push_back(row);
  }
  return rows;
}

BrickBlock bricks_of(const BrickLevel& level, std::uint32_t block) {
  BrickBlock out;
  const std::size_t begin = std::size_t(block) * bricks_per_block;
  const std::size_t end = std::min(begin + bricks_per_block, level.first.size() - 1);
  for (std::size_t b = begin; b <= end; ++b) out.first.push_back(std::uint32_t(level.first[b] - level.first[begin]));
  out.mask.assign(level.mask.begin() + std::ptrdiff_t(8 * begin), level.mask.begin() + std::ptrdiff_t(8 * end));
  out.rgba.assign(level.rgba.begin() + std::ptrdiff_t(4 * level.first[begin]),
                  level.rgba.begin() + std::ptrdiff_t(4 * level.first[end]));
  if (!level.normal.empty())
    out.normal.assign(level.normal.begin() + std::ptrdiff_t(2 * level.first[begin]),
                      level.normal.begin() + std::ptrdiff_t(2 * level.first[end]));
  if (!level.directional_coverage.empty())
    out.directional_coverage.assign(
        level.directional_coverage.begin() + std::ptrdiff_t(directional_coverage_bytes * level.first[begin]),
        level.directional_coverage.begin() + std::ptrdiff_t(directional_coverage_bytes * level.first[end]));
  return out;
}

}  // namespace

void VoxelScene::add_cell(const Painter& paint, const Vec3i64& lattice_min, Nodes nodes) {
  std::vector<kernels::Level> levels = paint_levels(paint, lattice_min, cell_voxels_);
  if (levels[0].key.empty()) return;
  NodeTable table = nodes == Nodes::pruned ? kernels::prune(levels, one_thread()) : nodes_of_bricks(levels);
  for (const std::uint64_t key : levels[0].key) {
    const BrickCoordinate at = demorton(key);
    const Vec3i64 corner = lattice_min + Vec3i64{at.x * 8, at.y * 8, at.z * 8};
    description_.bounds = hull(description_.bounds, Box3i64::cube(corner, brick_edge));
  }
  SceneCell cell;
  cell.lattice_min = lattice_min;
  cell.cell_voxels = cell_voxels_;
  add_shard(levels, std::move(table), std::move(cell), description_.cells);
}

void VoxelScene::add_shard(const std::vector<kernels::Level>& levels, NodeTable nodes, SceneCell cell,
                           std::vector<SceneCell>& to) {
  Shard shard;
  shard.nodes = std::move(nodes);
  for (const kernels::Level& level : levels) shard.levels.push_back(level);
  shards_.push_back(std::move(shard));
  cell.name = (cell.first_lod == 0 ? "c_" : "p_") + std::to_string(shards_.size());
  cell.file = cell.name + ".h5";
  cell.lods = std::uint32_t(levels.size());
  description_.voxel_size_m = 1;
  description_.has_directional_coverage = true;
  description_.parameters = to_json(BakeParameters{.voxel_size_m = 1});
  to.push_back(std::move(cell));
}

void VoxelScene::add_overview(const Painter& paint, const Vec3i64& min, std::uint32_t edge, int first_lod, int copied) {
  std::vector<kernels::Level> levels = paint_levels(paint, min, edge);
  levels.erase(levels.begin(), levels.begin() + first_lod);
  if (levels[0].key.empty()) return;
  SceneCell overview;
  overview.lattice_min = min;
  overview.cell_voxels = edge;
  overview.first_lod = std::uint32_t(first_lod);
  overview.copied_lods = std::uint32_t(copied);
  add_shard(levels, nodes_of_bricks(levels), std::move(overview), description_.overviews);
}

void VoxelScene::add_cells(const Painter& paint, const Vec3i64& min, std::int64_t edge) {
  for (std::int64_t z = 0; z < edge; z += cell_voxels_)
    for (std::int64_t y = 0; y < edge; y += cell_voxels_)
      for (std::int64_t x = 0; x < edge; x += cell_voxels_) add_cell(paint, {min[0] + x, min[1] + y, min[2] + z});
}

PageSource VoxelScene::pages() const {
  return [this](const PageKey& key) {
    const Shard& shard = shards_.at(key.shard);
    Page page;
    if (key.part < 0)
      page.rows = rows_of(shard.nodes, key.block);
    else
      page.bricks = bricks_of(shard.levels.at(std::size_t(key.part)), key.block);
    return page;
  };
}

PictureOptions view(const std::array<double, 3>& eye_m, const std::array<double, 3>& target_m, int edge) {
  PictureOptions options;
  options.camera.eye_m = Point<Scene>{eye_m[0], eye_m[1], eye_m[2]};
  options.camera.target_m = Point<Scene>{target_m[0], target_m[1], target_m[2]};
  options.camera.width = options.camera.height = edge;
  return options;
}

Picture take(const VoxelScene& scene, const PictureOptions& options) {
  const ThreadPool pool(options.threads);
  SceneStream::Options wishes;
  wishes.light = options.light;
  wishes.memory_bytes = options.memory_bytes;
  SceneStream stream(scene.paged(), scene.pages(), wishes, pool);
  return render(stream, make_camera(options.camera, scene.paged()), options.background);
}

}  // namespace gigabake
