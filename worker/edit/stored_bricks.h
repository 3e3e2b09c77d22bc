/// The voxels and nodes of a stored cell by Morton codes of bricks. Constant nodes count as the bricks that they
/// represent.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "format/shard/splice/base_shard.h"
#include "kernels/body/cell.h"
#include "kernels/body/prune/node.h"

namespace gigabake {

/// A node of a cell, without its place in the table.
struct StoredNode {
  NodeKind kind = NodeKind::brick;
  kernels::CommonVoxel value;  ///< of a constant node
};

class StoredBricks {
 public:
  explicit StoredBricks(const BaseShard& base);

  /// Returns the node of a brick. Below a leaf-constant node, returns a leaf-constant node. nullopt: no voxels.
  std::optional<StoredNode> node(int lod, std::uint64_t key) const;
  /// Returns the bricks of lod 0 with voxels and keys in [first, end), ascending.
  std::vector<std::uint64_t> finest_keys(std::uint64_t first, std::uint64_t end) const;
  /// Returns the bricks with these keys, without those that have no voxels.
  /// Range   `keys` is ascending.
  /// Errors  InputError: the shard is damaged.
  kernels::Level read(int lod, std::span<const std::uint64_t> keys) const;

 private:
  /// Brick `number` of its level, or a constant node in row `number`.
  struct Place {
    bool is_constant;
    std::uint64_t number;
  };
  std::optional<Place> find(int lod, std::uint64_t key) const;
  std::optional<std::size_t> constant_row(int lod, std::uint64_t key) const;
  void append_constant(int lod, std::uint64_t key, std::size_t row, kernels::Level& out) const;
  void append_block(int lod, std::span<const std::uint64_t> keys, std::span<const std::uint64_t> numbers,
                    kernels::Level& out) const;

  const BaseShard& base_;
  std::vector<std::vector<std::size_t>> constants_;  ///< per lod: the rows of constant nodes, by rising key
};

}  // namespace gigabake
