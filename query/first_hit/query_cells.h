/// The cells that rays of one level find in a scene, and the resident trees of these cells.
#pragma once

#include <cstdint>

#include "kernels/marching/locate.h"
#include "query/first_hit/query_walk.h"

namespace gigabake::kernels {

/// Cells that rays borrow; advance_walk() takes it as its scene.
/// Exact   find() returns the same boxes as QueryPlaces::find() (query/query_places.h), so a paused ray can be
///         resumed with either class.
struct QueryCells {
  enum class State : std::uint32_t {
    none,    ///< the cell has no shard
    absent,  ///< the tree of the cell's shard is not resident
    resident
  };
  struct Entry {
    std::uint32_t shard = 0;
    State state = State::none;
  };

  CastScene layout;             ///< the columns and cells of the scene
  Span<const Entry> entries;    ///< by cell
  Span<const ShardTree> trees;  ///< by cell
  bool has_pages = false;       ///< true: empty boxes are as in ShardMap::find(); false: as in find_cell()

  GB_HD QueryRegion find(int, const std::int64_t v[3]) const {
    QueryRegion region;
    std::uint32_t cell = 0;
    if (!(has_pages ? find_in_column(v, cell, region.box) : find_cell(layout, {v[0], v[1], v[2]}, cell, region.box)))
      return region;
    for (int a = 0; a < 3; ++a) {
      region.box.min[a] = layout.cells[cell].min[a];
      region.box.max[a] = region.box.min[a] + (std::int64_t(1) << layout.cell_bits);
    }
    const Entry entry = entries[cell];
    if (entry.state == State::none) return region;
    region.kind = entry.state == State::resident ? QueryRegion::Kind::shard : QueryRegion::Kind::paused;
    region.shard = entry.shard;
    region.tree = trees.data + cell;
    return region;
  }

  /// Sets `cell` and returns true if a cell holds the voxel. Otherwise sets `box` to an empty part of the aligned cube
  /// of a cell's size around the voxel. Along z, this part lies between the next cells.
  GB_HD bool find_in_column(const std::int64_t v[3], std::uint32_t& cell, VoxelBox& box) const {
    const std::int64_t edge = std::int64_t(1) << layout.cell_bits;
    std::int64_t column[2];
    bool is_inside = true;
    for (int a = 0; a < 3; ++a) {
      box.min[a] = v[a] >> layout.cell_bits << layout.cell_bits;
      box.max[a] = box.min[a] + edge;
      if (a == 2) continue;
      column[a] = (v[a] >> layout.cell_bits) - layout.column_min[a];
      is_inside = is_inside && column[a] >= 0 && column[a] < layout.column_count[a];
    }
    if (!is_inside) return false;
    const std::uint64_t key = morton(std::uint32_t(column[0]), std::uint32_t(column[1]));
    const std::size_t found = lower_column(layout, key);
    if (found == layout.column_key.size || layout.column_key[found] != key) return false;
    for (cell = layout.column_first[found]; cell < layout.column_first[found + 1]; ++cell) {
      if (entries[cell].state == State::none) continue;
      const std::int64_t low = layout.cells[cell].min[2];
      if (v[2] < low) {
        if (low < box.max[2]) box.max[2] = low;
        return false;
      }
      if (v[2] < low + edge) return true;
      if (low + edge > box.min[2]) box.min[2] = low + edge;
    }
    return false;
  }
};

}  // namespace gigabake::kernels
