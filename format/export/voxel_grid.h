/// The voxels of one tile in a tileset: a dense grid, with a padding of one voxel on each side.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/math/box3.h"
#include "format/export/voxel_tiles/voxel_tiling.h"

namespace gigabake {

/// Returns three bytes b for the direction (b − 128) / 127. Encoding it again (core/math/octahedral.h) yields the
/// shard's two bytes.
std::array<std::uint8_t, 3> normal_bytes(const std::int8_t oct[2]);

/// Min and max bytes of a set of voxels.
struct VoxelStatistics {
  std::uint64_t voxels = 0;
  std::array<std::uint8_t, 4> min_rgba{255, 255, 255, 255}, max_rgba{};
  std::array<std::uint8_t, 3> min_normal{255, 255, 255}, max_normal{};

  void add(const std::uint8_t* rgba, const std::uint8_t* normal);
  void add(const VoxelStatistics& other);
  friend bool operator==(const VoxelStatistics&, const VoxelStatistics&) = default;
};

/// Order of voxels, slowest axis first. y_up: −y, z, x, as in glTF 2.0's frame; right_forward_up: z, y, x.
enum class GridOrder : std::uint8_t { y_up, right_forward_up };

/// The dense grid, zero where there is no voxel. Reused from tile to tile.
class VoxelGrid {
 public:
  VoxelGrid(std::uint32_t tile_edge, bool normals, GridOrder order);

  void clear(const Box3i64& padded_box);
  /// Sets a voxel inside the box, replacing an existing one.
  void set(const LevelIndex& at, const std::uint8_t* rgba, const std::int8_t* normal);
  std::size_t size() const { return rgba_.size() / 4; }
  std::uint32_t edge() const { return edge_; }

  const std::vector<std::uint8_t>& rgba() const { return rgba_; }
  /// Returns four bytes per voxel: the direction's three (128 in scenes without normals), and 255 if there is a voxel.
  const std::vector<std::uint8_t>& normals() const { return normals_; }
  /// Returns the statistics of the tile's own voxels, without padding.
  VoxelStatistics statistics() const;

 private:
  std::size_t place_of(std::size_t x, std::size_t y, std::size_t z) const;

  std::uint32_t edge_;  ///< including padding
  bool has_normals_;
  GridOrder order_;
  bool is_empty_ = true;
  LevelIndex lowest_{};
  std::vector<std::uint8_t> rgba_, normals_;
};

}  // namespace gigabake
