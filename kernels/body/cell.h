/// Input, parameters and result of one cell: from triangles to a pruned sparse voxel octree. This is the only entry
/// point of the numerical core.
///
/// Exact   A voxel depends only on the triangles that overlap it, their materials, the parameters and its lattice
///         position. The order of parts and triangles, threads, memory budget and window do not change any bit. This
///         requires that window_min is a multiple of 2^lod. Otherwise the voxels of level lod are aligned to the window
///         and not to the lattice.
/// Source  docs/accuracy.md: surface rules, tie rules, weights.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/base/host_device.h"
#include "core/base/rules.h"
#include "core/io/hash128.h"
#include "core/math/octahedral.h"
#include "core/math/snap.h"
#include "core/math/vec3.h"
#include "core/octree/downsample_state.h"
#include "core/octree/octree.h"
#include "kernels/body/texture/material.h"
#include "kernels/body/texture/texture_view.h"

namespace gigabake::kernels {

struct IdTextureView;  // kernels/body/texture/id_texture_view.h

/// One instance of one primitive. If scene_from_local mirrors, the winding is restored when the part is read.
struct PartView {
  Span<const float> position;        ///< 3 per vertex
  Span<const std::uint32_t> index;   ///< 3 per triangle, each < vertex count
  Span<const float> uv;              ///< 2 per vertex or empty
  Span<const std::uint16_t> rgba;    ///< 4 per vertex, linear, or empty
  Span<const VertexNormal> normal;   ///< 1 per vertex, or empty
  double scene_from_local[12] = {};  ///< 3x4 row-major
  std::uint32_t material = 0;
  NormalMapView normal_map = {};           ///< used only if `normal_uv` is not empty
  Span<const float> normal_uv = {};        ///< coordinates of the normal map, 2 per vertex or empty; may be `uv`
  Span<const VertexTangent> tangent = {};  ///< 1 per vertex, or empty: computed from `normal_uv`
  /// Level at which its triangles are voxelized, except where finer parts or edits occupy the same brick. Only the CPU
  /// backend accepts other levels than 0.
  int lod = 0;
  VoxelClass voxel_class = no_class;          ///< class of its triangles, if CellParameters::classes
  const IdTextureView* id_texture = nullptr;  ///< replaces `voxel_class` where its coordinates are usable; host memory
  Span<const float> id_uv = {};               ///< coordinates of `id_texture`, 2 per vertex; empty without it
};

struct CellInput {
  Span<const PartView> parts;
  Span<const MaterialView> materials;
  Span<const TextureView> textures;
};

/// The voxels of a brick: bit x + 8y of word z, as in core/octree/octree.h.
using VoxelMask = std::array<std::uint64_t, 8>;

/// A function that returns the voxels of a brick of level `lod` that a cell keeps. `min` is the brick's lowest voxel,
/// in voxels of that level from the lattice's origin. Threads call it concurrently.
using KeptVoxels = std::function<VoxelMask(const Vec3i64& min, int lod)>;

struct Level;

/// The edits of a cell, as functions of its bricks. Keys are Morton codes of bricks in the window.
struct LevelEdits {
  /// Applies the edits to the voxels of lod 0, of which `level` has the bricks with keys in [first, end). May remove
  /// bricks, and add bricks in this range.
  std::function<void(Level& level, std::uint64_t first, std::uint64_t end)> apply;
  /// Returns an upper bound of the number of voxels that the edits fill in the bricks with keys in [first, end).
  std::function<std::uint64_t(std::uint64_t first, std::uint64_t end)> filled_voxels;
  /// Calls visit(key) for each brick of the window in which an edit selects a voxel. Threads call `visit` concurrently.
  std::function<void(const std::function<void(std::uint64_t key)>& visit)> for_each_selected = nullptr;
};

struct CellParameters {
  SnapFrame frame;
  Vec3i64 window_min{};                ///< lod-0 voxels, multiples of 8
  std::uint32_t window_voxels = 1024;  ///< a power of two, 8 … 8192
  SurfaceRule surface = SurfaceRule::area;
  MipFilter mip = MipFilter::coverage;
  bool normals = true;
  bool directional_coverage =
      true;  ///< store the directional coverage of MipFilter::coverage; the filter uses it in either case
  /// Store a class per voxel (kernels/body/voxel_class.h). Only the CPU backend accepts it.
  bool classes = false;
  std::uint32_t max_error = 0;  ///< max error of stored values in units of 1/255 (quantize_groups.h); at most 127
  /// Max error of a voxel that ends a branch (kernels/body/mip/branch_error.h); at most 127. Only the CPU backend
  /// accepts other values than 0.
  std::uint32_t depth_error = 0;
  std::uint64_t memory_bytes = 0;     ///< target; bricks are processed in batches to meet it. 0: no bound
  const LevelEdits* edits = nullptr;  ///< applied to lod 0 before other voxels are computed; none if null
  KeptVoxels kept = nullptr;          ///< voxels that are kept after the edits; all if null. Only the CPU backend
                                      ///< accepts it
};

/// Returns true if lod-0 voxels have planes.
GB_HD bool has_finest_planes(const CellParameters& p) {
  return p.normals && p.directional_coverage && p.mip == MipFilter::coverage;
}

/// One level of a cell. `directional_coverage` is empty without MipFilter::coverage and without
/// CellParameters::directional_coverage. At lod 0 it is empty without normals too, and its coverages are 0.
struct Level : BrickLevel {
  std::vector<std::uint64_t> key;  ///< Morton code of the brick in its level, ascending
};

struct CellStats {
  std::uint64_t triangles = 0;   ///< triangles that may touch the window
  std::uint64_t non_finite = 0;  ///< dropped: a vertex is NaN/Inf or off the lattice
  std::uint64_t zero_area = 0;   ///< dropped: no area after the snap
  std::uint64_t oversized = 0;   ///< extend farther than 2^30 sub-voxels from the window; the cell must fail
  std::uint64_t bad_uv = 0;      ///< triangles with NaN/Inf or too large texture coordinates, baked without them
  std::uint64_t pairs = 0;       ///< pairs of a triangle and a brick that it may touch
  std::uint64_t fragments = 0;   ///< pairs of a triangle and a voxel that it occupies
  std::uint64_t batches = 0;
  std::uint64_t peak_bytes = 0;  ///< max memory of the arrays of this call
  double snap_s = 0, bin_s = 0, sort_s = 0, voxelize_s = 0, mip_s = 0, prune_s = 0;
  double hash_s = 0;  ///< on a device, hashing is part of the download
};

struct CellVolume {
  std::vector<Level> levels;          ///< [lod]; log2(window_voxels/8)+1 levels; empty if no voxel is occupied
  NodeTable nodes;                    ///< its `directional_coverage` is 0 for constant nodes of levels without this
                                      ///< channel
  std::vector<Hash128> content_hash;  ///< [lod]; over all voxels, including those that constant nodes represent
  DownsampleState above;              ///< downsample state for the levels above; empty if no voxel is occupied
  CellStats stats;
};

}  // namespace gigabake::kernels
