/// A shard: one cell's sparse voxel oct-tree in one HDF5 file (layout and byte order: docs/format.md).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lattice/frames.h"
#include "lattice/hash128.h"
#include "lattice/octree.h"
#include "lattice/parent_source.h"
#include "lattice/rules.h"
#include "lattice/thread_pool.h"

namespace gigabake {

/// One row of a NodeTable. Its key and level follow from the way down to it.
struct NodeRow {
  std::uint32_t first_child = 0xffffffffu;  ///< row in the whole table
  std::uint32_t value = 0;                  ///< brick number in its whole level, or rgba
  std::int8_t normal[2] = {0, 0};
  std::uint8_t facing[facing_bytes] = {};
  NodeKind kind = NodeKind::brick;
  std::uint8_t child_mask = 0;
};

/// Some bricks of a level: as BrickLevel, with `first` counted from the block's own voxels.
struct BrickBlock {
  std::vector<std::uint64_t> mask;   ///< 8 per brick
  std::vector<std::uint32_t> first;  ///< bricks+1
  std::vector<std::uint8_t> rgba;    ///< 4 per voxel
  std::vector<std::int8_t> normal;   ///< 2 per voxel; empty where the channel is off
  std::vector<std::uint8_t> facing;  ///< facing_bytes per voxel; empty at lod 0 and where the channel is off
};

struct ShardHeader {
  std::string generator;                      ///< program and version: "gigabake 0.2.0"
  std::string cell;                           ///< cell name, e.g. "c_3_-2_0"
  std::array<std::int64_t, 3> lattice_min{};  ///< lod-0 voxel index of the cell's lowest corner
  std::uint32_t cell_voxels = 0;              ///< edge in lod-0 voxels, a power of two ≥ 8
  std::uint32_t first_lod = 0;                ///< of the lattice: its own level 0. 0: a cell; else a parent
  std::uint32_t copied_lods = 0;  ///< of a parent: so many levels from its own level 0 on are copies of its children's
  double voxel_size_m = 0;
  std::array<double, 3> lattice_origin_m{};  ///< scene position of the lattice's 0,0,0 corner
  std::optional<Geodetic> origin;
  std::uint32_t lods = 0;             ///< log2(cell_voxels/8)+1 less first_lod
  Hash128 fingerprint;                ///< of everything the cell was baked from
  std::vector<Hash128> content_hash;  ///< per lod; the sum over voxels, see content_hash.h
  bool has_normals = true;
  bool has_facing = false;
  std::uint64_t triangles = 0;  ///< triangles that touched the cell
};

struct Shard {
  ShardHeader header;
  NodeTable nodes;
  std::vector<BrickLevel> levels;  ///< [lod], from header.first_lod on
  ParentSource above = {};         ///< empty in shards before version 4
};

struct ShardWriteOptions {
  const ThreadPool& pool = callers_thread();  ///< shares and compresses
  Codec codec = Codec::lz4;
  /// Of memory, besides its columns: a packed shard (packed_shard.h) of no more bytes is made there first, for HDF5
  /// takes a tenth of the time then; a larger one HDF5 writes as it goes.
  std::uint64_t image_bytes = std::uint64_t(64) << 20;
};

/// What a shard takes on disk.
struct StoredShard {
  std::uint64_t file = 0;             ///< the whole file
  std::vector<std::uint64_t> levels;  ///< per lod, its columns, compressed, without HDF5's own index
  std::uint64_t nodes = 0;            ///< the nodes' columns, as those
};

/// Writes aside, flushes, fsyncs, renames, fsyncs the folder.
/// Exact   The same bytes for every number of threads.
/// Cost    The arrays are read twice, to find which voxels share a value and to pack; nothing is copied whole.
/// Errors  InputError (path, what failed, errno text); nothing is left behind.
StoredShard write_shard(const std::filesystem::path& path, const Shard& shard, const ShardWriteOptions& options);

ShardHeader read_shard_header(const std::filesystem::path& path);
NodeTable read_shard_nodes(const std::filesystem::path& path);
BrickLevel read_shard_level(const std::filesystem::path& path, int lod);
/// Errors  InputError for anything that is not a whole, consistent shard of a version we know; every index, count and
///         checksum is checked before use.
Shard read_shard(const std::filesystem::path& path);

}  // namespace gigabake
