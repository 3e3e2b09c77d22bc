/// One cell on the device, from uploaded triangles to levels: at once where it fits, else part by part.
///
/// Exact   A part is a range of oct-tree nodes by Morton key. All that these nodes hold, on levels up to their own, is
///         made of their own bricks: so parts do not show in any bit.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/cpu/levels.h"
#include "kernels/cuda/baker.h"
#include "kernels/cuda/bin.cuh"
#include "kernels/cuda/clock.cuh"
#include "kernels/cuda/fill/voxelize.cuh"
#include "kernels/cuda/levels.cuh"
#include "kernels/cuda/pinned.cuh"
#include "lattice/thread_pool.h"
#include "lattice/voxel_hash.h"

namespace gigabake::kernels {

/// At most one of the two lists of levels has any.
class BakedCell : public CudaVolume {
 public:
  const CellStats& stats() const override { return cell_stats; }

  std::vector<DeviceLevel> levels;  ///< [lod], of a cell that fits the device
  DeviceNodes nodes;
  std::vector<Level> host_levels;  ///< [lod], of one that came in parts
  LevelSurface host_surface;       ///< of the last of them
  std::vector<Hash128> host_hashes;
  ParentSource above;  ///< on the host, for it is small and travels with the volume whoever packs it
  std::int64_t window_min[3] = {};
  std::uint32_t max_error = 0;  ///< that `host_levels` are still to be approximated to
  CellStats cell_stats;
};

/// Bakes cell after cell on one stream, and learns from each how much room the next one needs.
class CellBake {
 public:
  CellBake(DeviceHeap& heap, const Tables& tables);

  /// parameters.memory_bytes: what input, working arrays and result may take on the device together. Textures have a
  /// budget of their own, and one node of the oct-tree, 1/32768 of the window or less, is baked whatever it takes.
  /// Waits for the stream.
  /// Errors  CudaFailure.
  void bake(const DeviceInput& input, const CellParameters& parameters, BakedCell& out);

 private:
  struct Cell;
  struct Units;

  LevelsAbove levels_of(const Cell& cell, KeyRange range, int lods, BinCapacity& capacity, CellStats& stats);
  ParentSource source_of(const LevelsAbove& all, int lod, MipFilter filter);
  bool bake_at_once(const Cell& cell, BakedCell& out);
  void bake_in_parts(const Cell& cell, BakedCell& out);
  void bake_units(const Cell& cell, const Units& units, std::size_t first, std::size_t end, BakedCell& out);
  bool bake_part(const Cell& cell, const Units& units, std::size_t first, std::size_t end, BakedCell& out);
  void take_part(const LevelsAbove& part, BakedCell& out);
  void count_batch(CellStats& total) const;

  DeviceHeap& heap_;
  Tables tables_;
  StreamClock clock_;
  BinCapacity bin_capacity_;
  FillRatios fill_ratios_;
  double output_per_triangle_ = 50;  ///< bytes
  PinnedBuffer pinned_;
  ThreadPool host_;
};

}  // namespace gigabake::kernels
