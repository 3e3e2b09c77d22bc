/// The ray caster's interface: the pools of nodes and bricks, and the rays of a frame, on the CPU or on one GPU.
///
/// The owner of a Caster allocates tiles, slots and places in the voxel pool. The caster stores the data, casts rays,
/// and reports the data that rays used and missed.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/thread_pool.h"
#include "kernels/light/lighting.h"
#include "kernels/light/shader.h"
#include "kernels/marching/cast.h"
#include "kernels/marching/pixel.h"
#include "kernels/pool/pack_brick.h"
#include "kernels/render/page_pool.h"

namespace gigabake::kernels {

/// The destination of a brick: its slot, and the place of its first part in the voxel pool.
struct BrickPlace {
  std::uint32_t slot = 0, first = 0;
};

/// A move of a slot's parts to another place in the voxel pool.
struct VoxelMove {
  std::uint32_t slot, from, to, count;
};

/// The sizes of the pools. The member `voxels` includes the places that layers occupy.
struct PoolSizes {
  std::uint32_t tiles = 0, slots = 0, voxels = 0;

  /// Returns the number of words in `UsageFeedback::requested`, which has 16 bits per tile.
  std::size_t request_words() const { return (std::size_t(tiles) + 1) / 2; }
  /// Returns the size of the pools and their marks in the memory of the caster's device.
  std::uint64_t bytes() const;
};

struct NodeChange {
  std::uint32_t node;
  CastNode value;
};

/// Casts rays through a paged scene.
/// Errors  CudaFailure from all members of a caster on a GPU.
class Caster {
 public:
  virtual ~Caster() = default;

  /// Copies pages to the page pool. One thread may call put_pages() and put_bricks() while another one casts.
  virtual void put_pages(const std::vector<PageUpload>& pages) = 0;
  /// Copies bricks to the pools, and the voxels of their runs out of the page pool.
  /// Range   The pages of the bricks' runs are in the page pool. No node refers to the slots until put_nodes().
  virtual void put_bricks(const std::vector<BrickPlace>& places, const CastBricks& bricks) = 0;
  /// Moves slots' parts towards the start of the voxel pool.
  /// Range   Moves are in ascending order and lead towards the start. The destination of the first move is free. Each
  ///         other move leads to the end of the previous move.
  virtual void move_voxels(const std::vector<VoxelMove>& moves) = 0;
  /// Replaces nodes.
  /// Range   Each node occurs at most once.
  virtual void put_nodes(const std::vector<NodeChange>& changes) = 0;

  /// Starts the rays of a rectangle of the image and discards previous rays. The arrays of camera.polygons are borrowed
  /// until resolve().
  virtual void start(const CastCamera& camera, const CastTile& tile) = 0;

  /// Casts one pass: continues the unfinished rays among rays [begin, end) of the tile. Returns the number of rays that
  /// are still unfinished. If `blocking` is true, rays wait at missing data; otherwise they use coarser data and
  /// finish. If `stop` ends the pass early, the remaining rays are unchanged and the result is above 0. Another pass
  /// then continues with the same bits.
  virtual std::size_t cast(std::size_t begin, std::size_t end, bool blocking, const StopAsked& stop) = 0;

  /// Starts second rays for pixels between two levels. All rays of the tile must be finished. Pixels then blend both
  /// rays (kernels/marching/level_blend.h).
  virtual void start_blend() = 0;

  /// Casts one pass of the second rays of pixels [begin, end), like cast().
  virtual std::size_t cast_blend(std::size_t begin, std::size_t end, bool blocking, const StopAsked& stop) = 0;

  /// Starts rays to the light from the surfaces that the tile's rays hit. All rays of the tile must be finished and
  /// must contain the surfaces' own colours. The shader then lights the pixels; null selects LitShader.
  /// Range   The tile begins at multiples of light_region.
  virtual void start_light(const CastLighting& lighting, std::shared_ptr<const SurfaceShader> shader) = 0;

  /// Casts one pass of the rays to the light of pixels [begin, end), like cast(). Returns the number of pixels that
  /// have unfinished rays.
  virtual std::size_t cast_light(std::size_t begin, std::size_t end, bool blocking, const StopAsked& stop) = 0;

  /// Reuses shadow samples among neighbouring pixels. Call it once per tile, after all rays to the light are finished.
  /// Pixels without own rays take the light of their neighbours if it is uniform. The other pixels start
  /// their own rays, which cast_light() continues.
  virtual void reuse_shadow_samples() = 0;

  /// Returns the data that rays of the last pass missed, as 2·node + Want, in no particular order.
  virtual std::vector<std::uint32_t> requested() = 0;

  /// Returns the number of the last pass. The elements of tile_timestamps() and slot_timestamps() are numbers of
  /// passes.
  virtual std::uint32_t pass() const = 0;
  virtual const std::vector<std::uint32_t>& tile_timestamps() = 0;
  virtual const std::vector<std::uint32_t>& slot_timestamps() = 0;

  /// Writes the pixels of the tile's rays to the host's memory.
  virtual void resolve(const CastBackground& background, const CastPixels& out) = 0;
};

/// Creates a caster on the CPU. The cells and columns of `scene` are borrowed and must not change; the caster owns the
/// pools and marks. All nodes are initially not resident. `policy` is borrowed.
std::unique_ptr<Caster> make_cpu_caster(const CastScene& scene, const PoolSizes& sizes, const PagePoolSize& pages,
                                        const ThreadPool& policy);

/// Creates a caster on a GPU and copies the arrays of `scene`. `device` is an ordinal that cuda_devices() returned.
/// `policy` is borrowed and used to copy images.
/// Exact   Rays are bit-identical to the CPU's.
/// Errors  CudaFailure: out of device memory; no CUDA in this build.
std::unique_ptr<Caster> make_cuda_caster(const CastScene& scene, const PoolSizes& sizes, const PagePoolSize& pages,
                                         int device, const ThreadPool& policy);

}  // namespace gigabake::kernels
