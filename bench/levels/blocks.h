/// Blocks of 16³ finest voxels: the reference for a voxel of lod 4, to which candidates for its content are fitted.
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

/// The voxels of a block, and the values that candidates would store for it.
struct Block {
  BlockVoxels voxels;
  Vector3 normal_sum{}, place_sum{};  ///< of its voxels: unit normals, centres from the block's lowest corner

  Vector3 facing{};         ///< fraction of the columns along x, y, z that have a voxel
  Vector3 normal{};         ///< unit normal of the mean; zero if normals cancel
  double offset = 0;        ///< distance of the voxels' mean from the block's centre, along the normal
  double share = 0;         ///< fraction of the plane, clipped to the block, that is surface
  double coherence = 0;     ///< 1: all voxels lie on the plane; 0: none
  std::uint64_t parts = 0;  ///< mask of the 4×4×4 parts that have a voxel: bit x + 4 y + 16 z
  Vector3 spread{};         ///< root of the mean square of the normals' components: SGGX without its rotation
  double area = 0;          ///< of the surface, in faces of the block, computed from `facing` and `spread`
};

using Blocks = std::unordered_map<BlockIndex, Block, BlockHash>;

/// Returns the blocks of a baked scene's finest level. Leaves out voxels with a coverage below one half.
/// Errors  InputError: no such scene.
Blocks read_blocks(const std::filesystem::path& scene_xml);

}  // namespace gigabake::bench
