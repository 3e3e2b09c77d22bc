/// Where rays are cast: the pools of nodes and bricks, and a frame's rays, on the CPU or on one GPU.
///
/// Whoever owns a Caster decides what stands in which tile, slot and place of the pool of voxels; the caster only holds
/// it, casts, and tells what rays used and missed.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "kernels/cast/cast.h"
#include "kernels/cast/lighting.h"
#include "kernels/cast/pack_brick.h"
#include "kernels/cast/pixel.h"
#include "kernels/cast/shader.h"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {

/// Where a brick goes: its slot, and where in the pool of voxels its first part stands.
struct BrickPlace {
  std::uint32_t slot = 0, first = 0;
};

/// The parts of a slot go to another place in their pool.
struct VoxelMove {
  std::uint32_t slot, from, to, count;
};

/// voxels: layers take places of that pool too.
struct PoolSizes {
  std::uint32_t tiles = 0, slots = 0, voxels = 0;

  /// Of CastMarks::wanted: 16 bits a tile.
  std::size_t want_words() const { return (std::size_t(tiles) + 1) / 2; }
  /// Of the pools and their marks, on the caster's device.
  std::uint64_t bytes() const;
};

struct NodeChange {
  std::uint32_t node;
  CastNode value;
};

/// Whether work that is under way is to end early. Asked by several threads, every millisecond or so; empty: never.
using StopAsked = std::function<bool()>;

/// Errors of all members  CudaFailure, from a GPU's.
class Caster {
 public:
  virtual ~Caster() = default;

  virtual void put_bricks(const std::vector<BrickPlace>& places, const std::vector<CastBrick>& bricks) = 0;
  /// Range  ascending, none upwards, and what they leave together has no gaps: the first goes to 0 or to where what
  /// stays where it is ends, each other one to where the one before ends.
  virtual void move_voxels(const std::vector<VoxelMove>& moves) = 0;
  /// Range  each node once.
  virtual void put_nodes(const std::vector<NodeChange>& changes) = 0;

  /// Starts the rays of a rectangle of the picture; forgets those before. camera.polygons: borrowed until resolve().
  virtual void start(const CastCamera& camera, const CastTile& tile) = 0;

  /// One pass: goes on with rays [begin, end) of the tile that are not finished. Returns how many still are not:
  /// patient ones stop at what is not here, others end. Where `stop` ends the pass early, rays that it has not reached
  /// stay as they were, the result is above 0, and another pass goes on with the same bits.
  virtual std::size_t cast(std::size_t begin, std::size_t end, bool patient, const StopAsked& stop) = 0;

  /// Starts second rays of pixels that lie between two levels; the tile's rays are all finished. Pixels are then of
  /// both (kernels/cast/level_blend.h).
  virtual void start_blend() = 0;

  /// One pass of those rays, as cast(): of pixels [begin, end).
  virtual std::size_t cast_blend(std::size_t begin, std::size_t end, bool patient, const StopAsked& stop) = 0;

  /// Starts rays to the light from what the tile's rays met, which are all finished and brought back surface's own
  /// colours. Pixels are then lit by it, as the shader has it; null: as LitShader. Range  the tile begins at multiples
  /// of sky_block.
  virtual void start_light(const CastLighting& lighting, std::shared_ptr<const SurfaceShader> shader) = 0;

  /// One pass of those rays, as cast(): of pixels [begin, end). Returns for how many pixels some still are not
  /// finished.
  virtual std::size_t cast_light(std::size_t begin, std::size_t end, bool patient, const StopAsked& stop) = 0;

  /// Once all those rays are finished, and once a tile: pixels that cast none have the light of others of their block,
  /// where these tell it. The rest start rays of their own, with which cast_light() goes on.
  virtual void share_light() = 0;

  /// What rays of the last pass missed: 2·node + Want, in no order.
  virtual std::vector<std::uint32_t> wanted() = 0;

  /// Number of the last pass; stamps are compared with it.
  virtual std::uint32_t pass() const = 0;
  virtual const std::vector<std::uint32_t>& tile_stamps() = 0;
  virtual const std::vector<std::uint32_t>& slot_stamps() = 0;

  /// Pixels of the tile's rays, into the host's memory.
  virtual void resolve(const CastBackground& background, const CastPixels& out) = 0;
};

/// scene: cells and columns, which are borrowed and stay as they are; pools and marks are the caster's own. All nodes
/// are absent at first. policy: borrowed.
std::unique_ptr<Caster> make_cpu_caster(const CastScene& scene, const PoolSizes& sizes, const ThreadPool& policy);

/// The same on a GPU; arrays of `scene` are copied. device: an ordinal that cuda_devices() named. policy: copies
/// pictures; borrowed.
/// Exact   Bit-identical rays.
/// Errors  CudaFailure: out of device memory; no CUDA in this build.
std::unique_ptr<Caster> make_cuda_caster(const CastScene& scene, const PoolSizes& sizes, int device,
                                         const ThreadPool& policy);

}  // namespace gigabake::kernels
