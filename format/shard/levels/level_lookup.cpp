#include "format/shard/levels/level_lookup.h"

#include <algorithm>

#include "core/octree/morton.h"

namespace gigabake {
namespace {

constexpr std::int8_t no_normal[2] = {0, 0};

/// Returns the number of the brick's voxels before bit `bit` of word `word`.
std::size_t rank(const std::uint64_t* mask, std::uint32_t word, std::uint32_t bit) {
  auto count = std::size_t(std::popcount(mask[word] & ((std::uint64_t(1) << bit) - 1)));
  for (std::uint32_t w = 0; w < word; ++w) count += std::size_t(std::popcount(mask[w]));
  return count;
}

}  // namespace

LevelLookup::LevelLookup(const NodeTable& nodes, const BrickLevel& level, std::uint32_t lods, int lod)
    : nodes_(nodes), level_(level), of_level_(level_nodes(nodes, lods)), lod_(lod) {}

/// Returns the node of the brick with Morton code `key`, or the leaf-constant ancestor that represents the brick.
/// Returns no_node if neither exists.
std::size_t LevelLookup::find_node(std::uint64_t key) const {
  for (std::size_t lod = std::size_t(lod_); lod < of_level_.size(); ++lod, key >>= 3) {
    const auto begin = nodes_.key.begin() + std::ptrdiff_t(of_level_[lod].begin);
    const auto end = nodes_.key.begin() + std::ptrdiff_t(of_level_[lod].end);
    const auto at = std::lower_bound(begin, end, key);
    if (at == end || *at != key) continue;
    const auto node = std::size_t(at - nodes_.key.begin());
    return lod == std::size_t(lod_) || nodes_.kind[node] == NodeKind::leaf_constant ? node : no_node;
  }
  return no_node;
}

bool LevelLookup::find(std::uint32_t x, std::uint32_t y, std::uint32_t z, VoxelValue& value) {
  const std::uint64_t key = morton(x / 8, y / 8, z / 8);
  if (key != key_) {
    key_ = key;
    node_ = find_node(key);
    if (node_ != no_node)
      for (int c = 0; c < 4; ++c) constant_[c] = std::uint8_t(nodes_.value[node_] >> (8 * c));
  }
  if (node_ == no_node) return false;
  if (nodes_.kind[node_] != NodeKind::brick) {
    value = {constant_, nodes_.normal[node_].data(),
             directional_coverage_of_constant(nodes_, node_, lod_ == 0, finest_), class_of_constant(nodes_, node_)};
    return true;
  }
  const std::size_t brick = nodes_.value[node_];
  const std::uint32_t bit = (x & 7) | (y & 7) << 3;
  if ((level_.mask[8 * brick + (z & 7)] >> bit & 1) == 0) return false;
  const std::size_t i = level_.first[brick] + rank(&level_.mask[8 * brick], z & 7, bit);
  value = {&level_.rgba[4 * i], level_.normal.empty() ? no_normal : &level_.normal[2 * i],
           level_.directional_coverage.empty() ? nullptr : &level_.directional_coverage[directional_coverage_bytes * i],
           level_.voxel_class.empty() ? no_class : level_.voxel_class[i]};
  return true;
}

}  // namespace gigabake
