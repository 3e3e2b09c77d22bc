/// A cell's columns on the device. The kernels count the rows of the columns and write them, one warp per brick, by the
/// rules of core/codec.
#pragma once

#include <cstdint>
#include <vector>

#include "core/codec/prediction.h"
#include "kernels/body/voxelize/window.h"
#include "kernels/cuda/mip/levels.cuh"
#include "kernels/pack/packer.h"

namespace gigabake::kernels {

/// The concatenated levels of a cell: brick b of a level is brick offset + b of the cell.
struct LevelsView {
  const std::uint64_t* mask[max_levels];
  const std::uint32_t *first[max_levels], *rgba[max_levels];
  const std::uint16_t* normal[max_levels];               ///< null if the level does not store normals
  const std::uint8_t* directional_coverage[max_levels];  ///< null if the level stores neither coverages nor planes
  std::uint32_t bricks[max_levels], offset[max_levels], voxels[max_levels];
  bool has_coverage[max_levels];  ///< the level has the column `facing`
  int levels;
  std::uint32_t bricks_in_all;
};

/// Returns the view of `levels`.
/// Errors  std::length_error beyond 2^32-1 bricks; std::invalid_argument if a level lacks a requested column.
LevelsView view_of(const std::vector<const DeviceLevel*>& levels, const std::vector<std::vector<LevelColumn>>& columns);

/// The results of count_rows() from which the host computes the sizes of the columns.
struct Findings {
  /// The number of rows in `children` and `facing`: before the level among all levels, and of the level. A dense level
  /// has more rows in `children`, a complete level in `facing`.
  std::uint32_t children_begin[max_levels], children[max_levels], coverage_begin[max_levels], coverage[max_levels];
  std::uint32_t is_dense[max_levels];     ///< 1: a voxel of the level has no parent voxel
  std::uint32_t is_complete[max_levels];  ///< 1: all voxels of the level have a row in `facing`
  unsigned long long alphas[max_levels][256];

  std::uint64_t rows(const LevelsView& levels, LevelColumn column, int lod) const;
};

/// Results of count_rows() per brick of the cell. The arrays of rows have one more entry.
struct BrickRows {
  DeviceArray<BrickParent> parent;
  DeviceArray<std::uint32_t> children, coverage;  ///< the number of rows before each brick
};

/// Finds the parents of all bricks and counts rows. Waits for the stream.
/// Errors  CudaFailure.
BrickRows count_rows(DeviceHeap& heap, const LevelsView& levels, const DeviceNodes& nodes, Findings& findings);

/// The destinations of a level's columns. Null: the column is not written.
struct LevelOut {
  std::uint64_t* first;
  std::uint8_t *children, *rgb, *alpha, *normal, *facing, *plane;
  std::uint32_t children_begin, coverage_begin;  ///< as in Findings
  bool is_dense, is_complete;
};

/// Writes columns of all levels. `out` has one entry per lod.
/// Errors  CudaFailure.
void make_columns(DeviceHeap& heap, const LevelsView& levels, const BrickRows& rows, const std::vector<LevelOut>& out);

/// The destinations of a node table's columns. If all nodes are bricks, the columns `kind`, `normal` and
/// `directional_coverage` are not written. They must be zero already.
struct NodesOut {
  std::uint64_t* key;
  std::uint32_t *first_child, *value;
  std::uint8_t *lod, *child_mask;
  NodeKind* kind;
  std::uint16_t* normal;
  std::uint32_t* directional_coverage;  ///< null if the channel is off
};

/// Writes the columns of a node table.
/// Errors  CudaFailure.
void make_node_columns(DeviceHeap& heap, const DeviceNodes& nodes, const NodesOut& out);

}  // namespace gigabake::kernels
