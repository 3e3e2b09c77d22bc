/// Blocks of 16³ finest voxels: what a voxel of lod 4 stands for, and what candidates for its content are fitted to.
///
/// Space   Finest voxels of the scene's lattice.
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <filesystem>
#include <unordered_map>

namespace gigabake::bench {

inline constexpr int block_edge = 16;

using Vector3 = std::array<double, 3>;
using BlockIndex = std::array<std::int64_t, 3>;

struct BlockHash {
  std::size_t operator()(const BlockIndex& b) const {
    return std::size_t(b[0] * 73856093) ^ std::size_t(b[1] * 19349663) ^ std::size_t(b[2] * 83492791);
  }
};

/// Voxel (x, y, z) is bit x + 16 y + 256 z.
using BlockVoxels = std::bitset<block_edge * block_edge * block_edge>;

/// What is known of a block, and what candidates would store of it.
struct Block {
  BlockVoxels voxels;
  Vector3 normal_sum{}, place_sum{};  ///< of its voxels: unit normals, centres from the block's lowest corner

  Vector3 facing{};         ///< share of the columns along x, y, z that hold a voxel
  Vector3 normal{};         ///< unit, of the mean; zero where normals cancel
  double offset = 0;        ///< of the voxels' mean from the block's centre, along the normal
  double share = 0;         ///< of the plane, as far as it lies in the block, that is surface
  double coherence = 0;     ///< 1: its voxels lie on one sheet, 0: on none
  std::uint64_t parts = 0;  ///< which of its 4×4×4 parts hold a voxel: bit x + 4 y + 16 z
  Vector3 spread{};         ///< root of the mean square of the normals' components: SGGX without its rotation
  double area = 0;          ///< of the surface, in faces of the block, by `facing` and `spread`
};

using Blocks = std::unordered_map<BlockIndex, Block, BlockHash>;

/// Of a baked scene's finest level; voxels of less than half coverage are left out.
/// Errors  InputError: no such scene.
Blocks read_blocks(const std::filesystem::path& scene_xml);

}  // namespace gigabake::bench
