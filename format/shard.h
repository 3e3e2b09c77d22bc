/// A shard: one cell's sparse voxel oct-tree in one HDF5 file (layout and byte order: docs/format.md).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "format/codec.h"
#include "format/frames.h"
#include "format/parallel_loop.h"

namespace gigabake {

inline constexpr int brick_edge = 8;
inline constexpr int brick_voxels = 512;

struct Hash128 {
  std::uint64_t lo = 0, hi = 0;
  friend bool operator==(const Hash128&, const Hash128&) = default;
  /// Addition mod 2^128: combines hashes of disjoint voxel sets in any order.
  Hash128& operator+=(const Hash128& o) {
    lo += o.lo;
    hi += o.hi + (lo < o.lo ? 1 : 0);
    return *this;
  }
  std::string hex() const;  ///< 32 lower-case digits, hi first
  static std::optional<Hash128> from_hex(std::string_view text);
};

enum class NodeKind : std::uint8_t {
  brick = 0,          ///< value: index of its brick in its level
  constant = 1,       ///< all 512 voxels are present and alike; children may differ in detail below. value: rgba
  leaf_constant = 2,  ///< as constant, and so is everything below: no children are stored. value: rgba
};

/// Oct-tree nodes, level by level from the root (lod = lods-1) to lod 0, Morton order within a level.
struct NodeTable {
  std::vector<std::uint64_t> key;  ///< Morton code (x lowest bit) of the brick in its level
  std::vector<std::uint8_t> lod;
  std::vector<NodeKind> kind;
  std::vector<std::uint8_t> child_mask;  ///< bit c: child c = x | y<<1 | z<<2 is stored
  std::vector<std::uint32_t>
      first_child;                   ///< node index of the lowest stored child; the others follow. 0xffffffff: none
  std::vector<std::uint32_t> value;  ///< brick index, or rgba as bytes r,g,b,a from the lowest
  std::vector<std::array<std::int8_t, 2>> normal;  ///< of constant nodes, octahedral; zero otherwise
  std::vector<std::array<std::uint8_t, 3>>
      facing;  ///< of constant nodes of lod 1 and up; empty where the channel is off
};

/// One row of it. Its key and level follow from the way down to it.
struct NodeRow {
  std::uint32_t first_child = 0xffffffffu;  ///< row in the whole table
  std::uint32_t value = 0;                  ///< brick number in its whole level, or rgba
  std::int8_t normal[2] = {0, 0};
  std::uint8_t facing[3] = {0, 0, 0};
  NodeKind kind = NodeKind::brick;
  std::uint8_t child_mask = 0;
};

/// Packed bricks of one level, Morton order. Voxel (x,y,z) of a brick is bit x+8y of word z.
/// Voxels of a brick follow each other by rising bit number, words first.
struct BrickLevel {
  std::vector<std::uint64_t> mask;   ///< 8 per brick
  std::vector<std::uint64_t> first;  ///< bricks+1: where a brick's voxels start
  std::vector<std::uint8_t> rgba;    ///< 4 per voxel: sRGB colour, coverage
  std::vector<std::int8_t> normal;   ///< 2 per voxel: octahedral; empty where the channel is off
  /// 3 per voxel: coverage that a view along x, y, z sees. Empty at lod 0, where it is alpha, and where the channel is
  /// off.
  std::vector<std::uint8_t> facing;
};

/// Some bricks of a level: as BrickLevel, with `first` counted from the block's own voxels.
struct BrickBlock {
  std::vector<std::uint64_t> mask;   ///< 8 per brick
  std::vector<std::uint32_t> first;  ///< bricks+1
  std::vector<std::uint8_t> rgba;    ///< 4 per voxel
  std::vector<std::int8_t> normal;   ///< 2 per voxel; empty where the channel is off
  std::vector<std::uint8_t> facing;  ///< 3 per voxel; empty at lod 0 and where the channel is off
};

struct ShardHeader {
  std::string generator;                      ///< "gigabake 0.1.0"
  std::string cell;                           ///< cell name, e.g. "c_3_-2_0"
  std::array<std::int64_t, 3> lattice_min{};  ///< lod-0 voxel index of the cell's lowest corner
  std::uint32_t cell_voxels = 0;              ///< edge in lod-0 voxels, a power of two ≥ 8
  double voxel_size_m = 0;
  std::array<double, 3> lattice_origin_m{};  ///< scene position of the lattice's 0,0,0 corner
  std::optional<Geodetic> origin;
  std::uint32_t lods = 0;             ///< log2(cell_voxels/8)+1
  Hash128 fingerprint;                ///< of everything the cell was baked from
  std::vector<Hash128> content_hash;  ///< per lod; the sum over voxels, see content_hash.h
  bool has_normals = true;
  bool has_facing = false;
  std::uint64_t triangles = 0;  ///< triangles that touched the cell
};

struct Shard {
  ShardHeader header;
  NodeTable nodes;
  std::vector<BrickLevel> levels;  ///< [lod]
};

struct ShardWriteOptions {
  ParallelLoop loop = on_threads(1);  ///< shares and compresses
  Codec codec = Codec::lz4;
};

/// Writes aside, flushes, fsyncs, renames, fsyncs the folder. Returns the file's size in bytes.
/// Errors  InputError (path, what failed, errno text); nothing is left behind.
std::uint64_t write_shard(const std::filesystem::path& path, const Shard& shard, const ShardWriteOptions& options);

ShardHeader read_shard_header(const std::filesystem::path& path);
NodeTable read_shard_nodes(const std::filesystem::path& path);
BrickLevel read_shard_level(const std::filesystem::path& path, int lod);
/// Errors  InputError for anything that is not a whole, consistent shard of a version we know; every index, count and
///         checksum is checked before use.
Shard read_shard(const std::filesystem::path& path);

}  // namespace gigabake
