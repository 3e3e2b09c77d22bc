#include "worker/edit/cell_edits.h"

#include <algorithm>

#include "core/octree/morton.h"
#include "kernels/body/voxelize/window.h"
#include "worker/edit/edited_brick.h"
#include "worker/edit/level_bricks.h"

namespace gigabake {
namespace {

using kernels::Level;

/// Edge of the blocks that edits are listed for. Ranges of keys begin and end at blocks of this edge, or of the window.
constexpr std::int64_t block_edge = 32;

}  // namespace

CellEdits::CellEdits(const EditsInScene& edits, const kernels::CellParameters& parameters, const ThreadPool& pool,
                     std::size_t applied)
    : in_scene_(edits),
      parameters_(parameters),
      pool_(pool),
      edits_(edits.selecting(Box3i64::cube(parameters.window_min, parameters.window_voxels))) {
  edits_.erase(edits_.begin(), edits_.begin() + std::ptrdiff_t(std::min(applied, edits_.size())));
}

kernels::LevelEdits CellEdits::functions() const {
  return {[this](Level& level, std::uint64_t first, std::uint64_t end) { apply(level, first, end); },
          [this](std::uint64_t first, std::uint64_t end) { return filled_voxels(first, end); },
          [this](const std::function<void(std::uint64_t)>& visit) { for_each_selected(visit); }};
}

std::vector<std::uint64_t> CellEdits::first_bricks() const {
  const std::uint64_t edge = parameters_.window_voxels / brick_edge;
  std::vector<std::uint64_t> bricks;
  for (const Block& block : blocks_in(0, edge * edge * edge)) bricks.push_back(block.first_brick);
  return bricks;
}

Vec3i64 CellEdits::lowest_voxel(std::uint64_t brick) const {
  return parameters_.window_min + static_cast<Vec3i64>(demorton(brick)) * std::int64_t(brick_edge);
}

std::vector<CellEdits::Block> CellEdits::blocks_in(std::uint64_t first, std::uint64_t end) const {
  std::vector<Block> blocks;
  add_blocks(0, parameters_.window_voxels, first, end, edits_, blocks);
  return blocks;
}

/// Adds the blocks of a node with edge `edge`. `node` is its Morton code among the nodes of its level.
void CellEdits::add_blocks(std::uint64_t node, std::int64_t edge, std::uint64_t first, std::uint64_t end,
                           const std::vector<std::uint32_t>& candidates, std::vector<Block>& out) const {
  const std::int64_t along = edge / brick_edge;
  const std::uint64_t bricks = std::uint64_t(along) * std::uint64_t(along) * std::uint64_t(along);
  if (node * bricks >= end || (node + 1) * bricks <= first) return;
  const Box3i64 box = Box3i64::cube(lowest_voxel(node * bricks), edge);
  std::vector<std::uint32_t> near;
  for (const std::uint32_t e : candidates)
    if (in_scene_.overlap(e, box) != AreaOverlap::outside) near.push_back(e);
  if (near.empty()) return;
  if (edge <= block_edge) return out.push_back({node * bricks, std::move(near)});
  for (std::uint64_t child = 0; child < 8; ++child) add_blocks(8 * node + child, edge / 2, first, end, near, out);
}

std::uint64_t CellEdits::filled_voxels(std::uint64_t first, std::uint64_t end) const {
  std::uint64_t voxels = 0;
  const std::uint64_t edge = std::min<std::uint64_t>(block_edge, parameters_.window_voxels);
  for (const Block& block : blocks_in(first, end))
    for (const std::uint32_t e : block.edits)
      if (in_scene_.edit(e).type == EditType::fill) {
        voxels += edge * edge * edge;
        break;
      }
  return voxels;
}

void CellEdits::for_each_selected(const std::function<void(std::uint64_t)>& visit) const {
  const std::uint64_t along = parameters_.window_voxels / brick_edge;
  const std::vector<Block> blocks = blocks_in(0, along * along * along);
  const std::uint64_t edge = std::min<std::uint64_t>(block_edge, parameters_.window_voxels) / brick_edge;
  pool_.parallel_for(blocks.size(), 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::uint64_t key = blocks[i].first_brick; key < blocks[i].first_brick + edge * edge * edge; ++key)
        if (std::ranges::any_of(blocks[i].edits, [&](std::uint32_t e) {
              return in_scene_.selects_any(e, Box3i64::cube(lowest_voxel(key), brick_edge));
            }))
          visit(key);
  });
}

/// Returns the bricks of a block after its edits.
Level CellEdits::edited(const Block& block, const Level& level) const {
  const std::uint64_t edge = std::min<std::uint64_t>(block_edge, parameters_.window_voxels) / brick_edge;
  std::size_t stored = lower_brick(level, block.first_brick);
  Level out;
  for (std::uint64_t key = block.first_brick; key < block.first_brick + edge * edge * edge; ++key) {
    const bool is_stored = stored < level.key.size() && level.key[stored] == key;
    EditedBrick brick(in_scene_, lowest_voxel(key), parameters_);
    if (is_stored) brick.load(level, stored);
    const bool is_changed = brick.apply(block.edits);
    if (is_changed)
      brick.append_to(out, key);
    else if (is_stored)
      append_bricks(level, stored, stored + 1, out);
    stored += is_stored ? 1 : 0;
  }
  return out;
}

void CellEdits::apply(Level& level, std::uint64_t first, std::uint64_t end) const {
  const std::vector<Block> blocks = blocks_in(first, end);
  std::vector<Level> results(blocks.size());
  pool_.parallel_for(blocks.size(), 1, [&](std::size_t begin, std::size_t stop, int) {
    for (std::size_t i = begin; i < stop; ++i) results[i] = edited(blocks[i], level);
  });
  const std::uint64_t edge = std::min<std::uint64_t>(block_edge, parameters_.window_voxels) / brick_edge;
  Level out;
  std::size_t taken = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    append_bricks(level, taken, lower_brick(level, blocks[i].first_brick), out);
    append_bricks(results[i], 0, results[i].key.size(), out);
    results[i] = Level();
    taken = lower_brick(level, blocks[i].first_brick + edge * edge * edge);
  }
  append_bricks(level, taken, level.key.size(), out);
  level = std::move(out);
}

}  // namespace gigabake
