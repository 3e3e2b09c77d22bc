#include "viewer/cast_pages.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "format/parameters.h"
#include "kernels/tables.h"

namespace gigabake {
namespace {

constexpr std::size_t bricks_per_range = 64;

void require(bool condition, const char* what) {
  if (!condition) throw std::invalid_argument(what);
}

/// The coverage a of a flat layer whose next coarser level is stored as the mean over the axes: (a + 2(a - a²/2)) / 3.
double facing_coverage_below(double mean) { return mean >= 2.0 / 3 ? 1 : (3 - std::sqrt(9 - 12 * mean)) / 2; }

std::uint16_t encoded_extinction(double coverage) {
  if (coverage >= 1) return 65535;
  return kernels::to_unorm16(float(-std::log1p(-coverage) / kernels::opaque_extinction * 65535));
}

std::uint32_t add_constant(const NodeTable& table, std::size_t n, const Shading& shading, NodePage& page) {
  std::uint8_t rgba[4];
  for (int c = 0; c < 4; ++c) rgba[c] = std::uint8_t(table.value[n] >> (8 * c));
  page.constants.push_back(shading(table.lod[n], rgba, table.normal[n].data()));
  return std::uint32_t(page.constants.size() - 1);
}

void check_children(const NodeTable& table, std::size_t n) {
  if (table.child_mask[n] == 0) return;
  const std::size_t first = table.first_child[n], count = std::size_t(std::popcount(table.child_mask[n]));
  require(table.lod[n] > 0 && first > n && first + count <= table.key.size(), "a node's children are out of range");
  for (std::size_t c = first; c < first + count; ++c)
    require(table.lod[c] + 1 == table.lod[n], "a node's children are not one level below it");
}

/// Bits 9(z-1)…: voxels in the words below word z.
std::uint64_t ranks_of_words(const std::uint64_t* mask) {
  std::uint64_t ranks = 0, before = 0;
  for (int z = 1; z < brick_edge; ++z) {
    before += std::uint64_t(std::popcount(mask[z - 1]));
    ranks |= before << (9 * (z - 1));
  }
  return ranks;
}

std::uint64_t voxels_in(const std::uint64_t* mask) {
  std::uint64_t voxels = 0;
  for (int z = 0; z < brick_edge; ++z) voxels += std::uint64_t(std::popcount(mask[z]));
  return voxels;
}

void make_brick(const BrickLevel& level, int lod, std::size_t b, const Shading& shading, LevelPage& page) {
  kernels::CastBrick& brick = page.bricks[b];
  std::copy_n(&level.mask[brick_edge * b], brick_edge, brick.mask);
  brick.before = ranks_of_words(brick.mask);
  brick.first = level.first[b];
  for (std::uint64_t v = level.first[b]; v < level.first[b + 1]; ++v)
    page.voxels[v] = shading(lod, &level.rgba[4 * v], level.normal.empty() ? nullptr : &level.normal[2 * v]);
}

}  // namespace

Shading::Shading(const kernels::CastLight& light, const SceneDescription& scene)
    : light_(light), has_normals_(scene.has_normals) {
  const bool averaged = parameters_from_json(scene.parameters).mip == MipFilter::coverage;
  for (int lod = 0; lod < kernels::max_cast_lods; ++lod)
    for (int stored = 0; stored < 256; ++stored) {
      double coverage = stored / 255.0;
      for (int l = 0; l < lod && averaged; ++l) coverage = facing_coverage_below(coverage);
      extinction_[std::size_t(lod)][std::size_t(stored)] = encoded_extinction(coverage);
    }
}

kernels::CastVoxel Shading::operator()(int lod, const std::uint8_t rgba[4], const std::int8_t* normal) const {
  return kernels::shade_voxel(rgba, has_normals_ ? normal : nullptr, light_, kernels::TableStore::host().view(),
                              extinction_[std::size_t(lod)].data());
}

std::uint64_t NodePage::bytes() const {
  return nodes.capacity() * sizeof(kernels::CastNode) + constants.capacity() * sizeof(kernels::CastVoxel);
}

std::uint64_t LevelPage::bytes() const {
  return bricks.capacity() * sizeof(kernels::CastBrick) + voxels.capacity() * sizeof(kernels::CastVoxel);
}

NodePage make_node_page(const NodeTable& table, int lods, const Shading& shading) {
  const std::size_t count = table.key.size();
  require(count > 0 && table.lod.size() == count && table.kind.size() == count && table.child_mask.size() == count &&
              table.first_child.size() == count && table.value.size() == count && table.normal.size() == count,
          "the node table's columns differ in length or are empty");
  require(table.lod[0] + 1 == lods, "the first node is not the root");
  NodePage page;
  page.nodes.resize(count);
  for (std::size_t n = 0; n < count; ++n) {
    check_children(table, n);
    require(table.lod[n] < lods && std::uint8_t(table.kind[n]) <= std::uint8_t(NodeKind::leaf_constant),
            "a node's level or kind is unknown");
    kernels::CastNode& node = page.nodes[n];
    node.first_child = table.first_child[n];
    node.child_mask = table.child_mask[n];
    node.kind = kernels::CastNodeKind(table.kind[n]);
    if (table.kind[n] == NodeKind::brick) {
      node.value = table.value[n];
      std::uint32_t& bricks = page.bricks[table.lod[n]];
      bricks = std::max(bricks, node.value + 1);
      require(bricks != 0, "a node's brick is out of range");
    } else {
      node.value = add_constant(table, n, shading, page);
    }
  }
  return page;
}

LevelPage make_level_page(const BrickLevel& level, int lod, std::size_t bricks, const Shading& shading,
                          const kernels::CpuPolicy& policy) {
  require(level.mask.size() == bricks * brick_edge && level.first.size() == bricks + 1,
          "the level's bricks are not those that the nodes name");
  require(level.first[0] == 0 && level.first[bricks] * 4 == level.rgba.size() &&
              (level.normal.empty() || level.normal.size() * 2 == level.rgba.size()),
          "the level's columns differ in length");
  for (std::size_t b = 0; b < bricks; ++b)
    require(level.first[b + 1] - level.first[b] == voxels_in(&level.mask[brick_edge * b]),
            "a brick's mask and voxels differ in number");
  LevelPage page;
  page.bricks.resize(bricks);
  page.voxels.resize(level.rgba.size() / 4);
  policy.parallel_for(bricks, bricks_per_range, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t b = begin; b < end; ++b) make_brick(level, lod, b, shading, page);
  });
  return page;
}

}  // namespace gigabake
