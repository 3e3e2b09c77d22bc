/// A shard: the sparse voxel octree of one cell or overview in one HDF5 file (layout and byte order: docs/format.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/rules.h"
#include "core/base/thread_pool.h"
#include "core/io/hash128.h"
#include "core/math/frames.h"
#include "core/math/vec3.h"
#include "core/octree/downsample_state.h"
#include "core/octree/octree.h"

namespace gigabake {

/// One row of a NodeTable. The key and level are omitted, because they follow from the node's path from the root.
struct NodeRow {
  std::uint32_t first_child = 0xffffffffu;  ///< row of the lowest child in the complete table
  std::uint32_t value = 0;                  ///< brick number in the complete level, or rgba
  std::int8_t normal[2] = {0, 0};
  std::uint8_t directional_coverage[directional_coverage_bytes] = {};
  NodeKind kind = NodeKind::brick;
  std::uint8_t child_mask = 0;
  std::uint8_t leaf_mask = 0;  ///< see NodeTable
  VoxelClass voxel_class = no_class;
};

/// Consecutive bricks of a level. Same layout as BrickLevel, but `first` counts from the block's first voxel.
struct BrickBlock {
  std::vector<std::uint64_t> mask;   ///< 8 per brick
  std::vector<std::uint32_t> first;  ///< bricks + 1 entries
  std::vector<std::uint8_t> rgba;    ///< 4 per voxel
  std::vector<std::int8_t> normal;   ///< 2 per voxel; empty if the channel is off
  std::vector<std::uint8_t>
      directional_coverage;  ///< directional_coverage_bytes per voxel; empty at lod 0 and if the channel is off
  std::vector<VoxelClass> voxel_class = {};  ///< 1 per voxel; empty if the channel is off
};

struct ShardHeader {
  std::string generator;          ///< program and version: "gigabake 0.2.0"
  std::string cell;               ///< cell name, e.g. "c_3_-2_0"
  Vec3i64 lattice_min{};          ///< lod-0 voxel index of the cell's lowest corner
  std::uint32_t cell_voxels = 0;  ///< edge in lod-0 voxels, a power of two ≥ 8
  std::uint32_t first_lod = 0;    ///< lattice level of the shard's level 0; 0 for a cell, above 0 for an overview
  std::uint32_t copied_lods = 0;  ///< number of duplicated levels, which are the finest levels; 0 for a cell
  double voxel_size_m = 0;
  Vec3d lattice_origin_m{};  ///< scene position of the lattice's 0,0,0 corner
  std::optional<Geodetic> origin;
  std::uint32_t lods = 0;             ///< number of levels: log2(cell_voxels / 8) + 1 − first_lod
  Hash128 fingerprint;                ///< hash of all inputs of the bake
  std::vector<Hash128> content_hash;  ///< per lod; sum over voxels, see content_hash.h
  bool has_normals = true;
  bool has_directional_coverage = false;
  bool has_classes = false;
  std::uint64_t triangles = 0;  ///< triangles that touched the cell
  std::uint32_t leaf_lod = 0;   ///< coarsest lattice level with leaves (NodeTable::leaf_mask); 0: there are none
};

struct Shard {
  ShardHeader header;
  NodeTable nodes;
  std::vector<BrickLevel> levels;  ///< [lod], starting at header.first_lod
  DownsampleState above = {};      ///< empty in shards before version 4
};

struct ShardWriteOptions {
  const ThreadPool& pool = callers_thread();  ///< threads that deduplicate values and compress chunks
  Codec codec = Codec::lz4;
  /// Memory limit in bytes for the image of a file, in addition to the columns. HDF5 builds a packed shard in memory if
  /// its chunks are packed (packed_shard.h), which the image does not copy, or need at most this memory; also a small
  /// shard of arrays. It writes other shards directly to the file.
  std::uint64_t image_bytes = std::uint64_t(64) << 20;
};

/// Sizes of a shard on disk, in bytes.
struct StoredShard {
  std::uint64_t file = 0;             ///< size of the complete file
  std::vector<std::uint64_t> levels;  ///< per lod: size of its columns, compressed, without HDF5's metadata
  std::uint64_t nodes = 0;            ///< size of the columns of nodes, compressed, without HDF5's metadata
};

/// Writes a temporary file, flushes and fsyncs it, renames it to `path`, and fsyncs the folder.
/// Exact   Same bytes for every number of threads.
/// Cost    Reads the arrays twice: to find which voxels share a value, and to pack. Makes no complete copy of the
///         arrays.
/// Errors  InputError naming the path, the failed operation and the system's message. Leaves no file behind.
StoredShard write_shard(const std::filesystem::path& path, const Shard& shard, const ShardWriteOptions& options);

ShardHeader read_shard_header(const std::filesystem::path& path);
NodeTable read_shard_nodes(const std::filesystem::path& path);
BrickLevel read_shard_level(const std::filesystem::path& path, int lod);
/// Reads a complete shard.
/// Errors  InputError for anything other than a complete, consistent shard of a supported version. Every index, count
///         and checksum is checked before use.
Shard read_shard(const std::filesystem::path& path);

}  // namespace gigabake
