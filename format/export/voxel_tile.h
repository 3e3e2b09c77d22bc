/// One tile of voxel 3D Tiles: 8³ voxels as a binary glTF with EXT_primitive_voxels.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>

#include "format/scene/scene_level.h"

namespace gigabake {

/// Voxel x + 8y + 64z, z up. A voxel exists where its coverage is not 0.
struct VoxelTile {
  std::array<std::array<std::uint8_t, 4>, brick_voxels> rgba{};
  std::array<std::array<float, 3>, brick_voxels> normal{};  ///< unit vectors; zero where there is no voxel
};

void add_voxels(VoxelTile& tile, const DenseBrick& part, bool normals);

/// The tile one level up, from eight (null: no voxel). Child x + 2y + 4z.
/// Coverage as in the bake's `coverage` levels, colour and normal weighted by it, colour in linear light.
VoxelTile coarser_tile(const std::array<const VoxelTile*, 8>& children);

/// Where a tile lies in the tileset's frame.
struct TileBox {
  std::array<double, 3> centre_m{};
  double edge_m = 0;
};

/// Writes and reads the tiles of one tileset.
class VoxelTileFiles {
 public:
  /// `target` is what messages name; tiles go below `folder`.
  VoxelTileFiles(std::filesystem::path target, std::filesystem::path folder, bool normals);

  /// Errors  InputError: the system's reason.
  void write(const std::filesystem::path& name, const VoxelTile& tile, const TileBox& box) const;
  /// Of a tile that was written. False: there is none of that name.
  bool read(const std::filesystem::path& name, VoxelTile& tile) const;

 private:
  std::size_t voxel_bytes() const { return std::size_t(brick_voxels) * (normals_ ? 16 : 4); }

  std::filesystem::path target_, folder_;
  bool normals_;
};

}  // namespace gigabake
