/// One cell, from triangles to a pruned sparse voxel oct-tree: the numerical core's only entrance.
///
/// Exact   What a voxel holds depends on the triangles that touch it, their materials, the parameters and its lattice
///         position alone. Order of parts and triangles, threads, memory budget and window do not show in any bit
///         (where window_min is a multiple of 2^lod; else the level is relative to the window).
/// Source  docs/accuracy.md: surface rules, tie rules, weights.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kernels/body/material.h"
#include "kernels/body/texture_view.h"
#include "lattice/hash128.h"
#include "lattice/host_device.h"
#include "lattice/octree.h"
#include "lattice/parent_source.h"
#include "lattice/rules.h"
#include "lattice/snap.h"

namespace gigabake::kernels {

/// One instance of one primitive. Winding is restored here where scene_from_local mirrors.
struct PartView {
  Span<const float> position;        ///< 3 per vertex
  Span<const std::uint32_t> index;   ///< 3 per triangle, each < vertex count
  Span<const float> uv;              ///< 2 per vertex or empty
  Span<const std::uint16_t> rgba;    ///< 4 per vertex, linear, or empty
  double scene_from_local[12] = {};  ///< 3x4 row-major
  std::uint32_t material = 0;
};

struct CellInput {
  Span<const PartView> parts;
  Span<const MaterialView> materials;
  Span<const TextureView> textures;
};

struct CellParameters {
  SnapFrame frame;
  std::int64_t window_min[3] = {};     ///< lod-0 voxels, multiples of 8
  std::uint32_t window_voxels = 1024;  ///< a power of two, 8 … 8192
  SurfaceRule surface = SurfaceRule::area;
  MipFilter mip = MipFilter::coverage;
  bool normals = true;
  bool facing = true;  ///< keep what MipFilter::coverage finds along each axis; levels are made of it either way
  std::uint32_t max_error = 0;     ///< codes of 255 that a stored voxel may be off (approximate.h); ≤ 127
  std::uint64_t memory_bytes = 0;  ///< to aim for; bricks are cut into batches. 0: no bound
};

/// Facing is empty at lod 0, without MipFilter::coverage and where it was not asked for.
struct Level : BrickLevel {
  std::vector<std::uint64_t> key;  ///< Morton code of the brick in its level, ascending
};

struct CellStats {
  std::uint64_t triangles = 0;   ///< that may touch the window
  std::uint64_t non_finite = 0;  ///< dropped: a vertex is NaN/Inf or off the lattice
  std::uint64_t zero_area = 0;   ///< dropped: no area after the snap
  std::uint64_t oversized = 0;   ///< reaches farther than 2^30 sub-voxels from the window: the cell must fail
  std::uint64_t bad_uv = 0;      ///< triangles with NaN/Inf texture coordinates, baked as if (0,0)
  std::uint64_t pairs = 0;       ///< triangle × brick
  std::uint64_t fragments = 0;   ///< triangle × voxel
  std::uint64_t batches = 0;
  std::uint64_t peak_bytes = 0;  ///< of this call's own arrays
  double snap_s = 0, bin_s = 0, sort_s = 0, voxelize_s = 0, mip_s = 0, prune_s = 0;
  double hash_s = 0;  ///< on a device it goes with the download
};

struct CellVolume {
  std::vector<Level> levels;          ///< [lod]; log2(window_voxels/8)+1; empty when no voxel is occupied
  NodeTable nodes;                    ///< facing: zeros for constant nodes of levels without it
  std::vector<Hash128> content_hash;  ///< [lod]; of all voxels, those that constant nodes stand for included
  ParentSource above;                 ///< what the levels above are made of; empty when no voxel is occupied
  CellStats stats;
};

}  // namespace gigabake::kernels
