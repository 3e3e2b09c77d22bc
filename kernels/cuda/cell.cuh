/// Bake of one cell on the device, from uploaded triangles to levels: at once if it fits, otherwise part by part.
///
/// Exact   A part is a range of octree nodes by Morton key. Levels up to the level of these nodes depend only on bricks
///         inside the nodes, so the division into parts changes no bit.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/math/vec3.h"
#include "core/octree/voxel_hash.h"
#include "kernels/cpu/mip/levels.h"
#include "kernels/cuda/baker.h"
#include "kernels/cuda/device/clock.cuh"
#include "kernels/cuda/device/pinned.cuh"
#include "kernels/cuda/mip/levels.cuh"
#include "kernels/cuda/voxelize/bin.cuh"
#include "kernels/cuda/voxelize/voxelize.cuh"

namespace gigabake::kernels {

/// A baked cell. At least one of `levels` and `host_levels` is empty.
class BakedCell : public CudaVolume {
 public:
  const CellStats& stats() const override { return cell_stats; }

  std::vector<DeviceLevel> levels;  ///< [lod]; for a cell baked at once
  DeviceNodes nodes;
  std::vector<Level> host_levels;  ///< [lod]; for a cell baked in parts
  LevelSurface host_surface;       ///< coverage masks and patches of the coarsest of host_levels
  std::vector<Hash128> host_hashes;
  DownsampleState above;  ///< always on the host, because it is small
  Vec3i64 window_min{};
  std::uint32_t max_error = 0;  ///< error to which `host_levels` must still be approximated; 0: none
  CellStats cell_stats;
};

/// Baker of one cell after the other on one stream. It estimates the capacities for a cell from the cells before it.
class CellBake {
 public:
  CellBake(DeviceHeap& heap, const Tables& tables);

  /// Bakes a cell and waits for the stream. `parameters.memory_bytes` is the device memory for input, working arrays
  /// and result together. Textures have a separate budget. The smallest part is an octree node with 1/32768 of the
  /// window, but at least 32³ voxels. It is baked even if it exceeds the memory. If `may_split` is false and the cell
  /// needs several parts, returns false and changes nothing.
  /// Errors  CudaFailure.
  bool bake(const DeviceInput& input, const CellParameters& parameters, bool may_split, BakedCell& out);

 private:
  struct Cell;
  struct Units;

  LevelsAbove levels_of(const Cell& cell, KeyRange range, int lods, BinCapacity& capacity, CellStats& stats);
  DownsampleState source_of(const LevelsAbove& all, int lod, MipFilter filter);
  bool bake_at_once(const Cell& cell, BakedCell& out);
  void bake_in_parts(const Cell& cell, BakedCell& out);
  Units min_units(const Cell& cell, CellStats& stats);
  bool bake_units(const Cell& cell, const Units& units, std::size_t first, std::size_t end, BakedCell& out);
  bool bake_part(const Cell& cell, const Units& units, std::size_t first, std::size_t end, BakedCell& out);
  void take_part(const LevelsAbove& part, double done, BakedCell& out);
  void count_batch(CellStats& total) const;

  DeviceHeap& heap_;
  Tables tables_;
  StreamClock clock_;
  BinCapacity bin_capacity_;
  FillRatios fill_ratios_;
  double output_per_triangle_ = 50;  ///< bytes
  double contents_per_byte_ = 0;     ///< max contents of a part that fitted, per byte of its limit; 0: none yet
  PinnedBuffer pinned_;
  ThreadPool host_;
};

}  // namespace gigabake::kernels
