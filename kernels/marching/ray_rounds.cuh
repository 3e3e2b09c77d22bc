/// A pass of rays on a device, in rounds of small kernels. Each kernel does one part of the work of the rays in a list:
/// finding bricks, samples of surfaces, samples with residuals, or surfaces that were hit. A ray that needs another
/// part goes to that part's list. The lanes of a warp therefore do the same work, and warps seldom wait for
/// instructions.
/// Source  Laine, Karras, Aila 2013, "Megakernels Considered Harmful: Wavefront Path Tracing on GPUs"; Aila, Laine
///         2009, "Understanding the Efficiency of Ray Traversal on GPUs" (lanes that take other rays);
///         docs/experiments/warps.md.
#pragma once

#include <cstdint>

#include "kernels/cuda/device/memory.cuh"
#include "kernels/cuda/device/pinned.cuh"
#include "kernels/cuda/device/stream.cuh"
#include "kernels/marching/cast.h"
#include "kernels/marching/ray_list.cuh"

namespace gigabake::kernels {

/// The brick in which a ray continues in another kernel.
struct HeldBrick {
  double until;         ///< MarchState::in_brick_until
  std::uint32_t brick;  ///< slot
  std::uint32_t cell;
  std::int16_t lod;
  bool waits;  ///< SampleLocation::waits
};

/// The arguments of a pass's kernels.
struct RayPass {
  CastScene scene;
  CastCamera camera;
  CastTile tile;
  CastRay* rays;
  bool blocking;
  bool starts;   ///< the rays are not started yet
  bool resumes;  ///< the rays were cast before in this frame; most of them are finished
  unsigned long long* unfinished;
  HeldBrick* held = nullptr;  ///< by ray: valid for rays in RayLists::pass and RayLists::residual
};

/// The lists of the rays that have each of the tasks. Each list has its own counter.
struct RayLists {
  RayList find, pass, residual, meet;
};

/// The kernels of a pass.
class RayRounds {
 public:
  /// Errors  CudaFailure.
  RayRounds(DeviceHeap& heap, cudaStream_t stream, int device);

  /// Continues rays [begin, end) until each is finished or waits. Adds the number of waiting rays to pass.unfinished.
  void cast(const RayPass& pass, std::size_t begin, std::size_t end);

 private:
  /// Few rays alternate more often between bricks and surfaces; one kernel finishes these rays. If many rays are left,
  /// further rounds are faster: rays in coarser bricks need one per level. Few rays resume after a wait, so the time of
  /// a round is mostly that of its launches.
  static constexpr std::size_t min_rounds = 7, min_resumed_rounds = 1, max_rounds = 28;
  /// Parts of the tile that are cast at the same time. The multiprocessors that the last rays of one part leave idle do
  /// work of the other part.
  static constexpr std::size_t parts = 2;

  /// The counters of a round: entries of its lists, and of these the entries that a kernel has taken.
  struct RoundCounts {
    std::uint32_t find, pass, residual, meet, found, passed, composited;
  };
  struct Part {
    Part(DeviceHeap& heap, int device) : stream(device), counts(heap, max_rounds + 1) {}

    Stream stream;
    Event done;
    DeviceArray<RoundCounts> counts;
    DeviceArray<std::uint32_t> find[2], pass, residual, meet;  ///< `find` of even and odd rounds
  };

  template <RayType ray_type>
  void cast_as(const RayPass& pass, std::size_t begin, std::size_t end);
  void make_lists(Part& part, std::size_t rays);
  RayLists lists_of(Part& part, std::size_t round) const;
  template <RayType ray_type>
  void cast_round(const RayPass& pass, unsigned blocks, std::size_t round, Part& part);
  bool has_long_list(std::size_t round);

  DeviceHeap& heap_;
  cudaStream_t stream_;
  unsigned multiprocessors_ = 1;
  Event begun_;
  DeviceArray<HeldBrick> held_;
  PinnedBuffer left_;  ///< per part the rays that are left after a round
  Part parts_[parts];
};

}  // namespace gigabake::kernels
