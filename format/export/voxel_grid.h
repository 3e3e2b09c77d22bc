/// The voxels of one tile in a tileset: a dense grid, with a padding of one voxel on each side.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/math/box3.h"
#include "format/export/voxel_tiles/voxel_tiling.h"
#include "format/scene/xml/scene_xml.h"

namespace gigabake {

/// Returns three bytes b for an octahedral normal: the direction is (b − 128) / 127. Encoding this direction again
/// (core/math/octahedral.h) yields the shard's two bytes.
std::array<std::uint8_t, 3> normal_bytes(const std::int8_t oct[2]);

/// The number of voxels of a set, and the min and max of their bytes.
struct VoxelStatistics {
  std::uint64_t voxels = 0;
  std::array<std::uint8_t, 4> min_rgba{255, 255, 255, 255}, max_rgba{};
  std::array<std::uint8_t, 3> min_normal{255, 255, 255}, max_normal{};
  VoxelClass min_class = VoxelClass(gigabake::max_class), max_class = 0;  ///< unchanged without classes

  void add(const std::uint8_t* rgba, const std::uint8_t* normal);
  void add(VoxelClass voxel_class);
  void add(const VoxelStatistics& other);
  friend bool operator==(const VoxelStatistics&, const VoxelStatistics&) = default;
};

/// The order of voxels in memory, by the axes of the scene frame, slowest axis first. The order `y_up` is −y, z, x, as
/// in glTF 2.0's frame. The order `right_forward_up` is z, y, x.
enum class GridOrder : std::uint8_t { y_up, right_forward_up };

/// A dense grid of voxels; all bytes are zero if a voxel does not exist. The grid is reused for each next tile.
class VoxelGrid {
 public:
  VoxelGrid(std::uint32_t tile_edge, const SceneHeader& scene, GridOrder order);

  void clear(const Box3i64& padded_box);
  /// Sets the voxel at `at`, which must lie inside the padded box. Replaces an existing voxel.
  void set(const LevelIndex& at, const std::uint8_t* rgba, const std::int8_t* normal, VoxelClass voxel_class);
  std::size_t size() const { return rgba_.size() / 4; }
  std::uint32_t edge() const { return edge_; }

  const std::vector<std::uint8_t>& rgba() const { return rgba_; }
  /// Returns four bytes per voxel: normal_bytes() (128 in scenes without normals), and 255. All four are 0 if there is
  /// no voxel.
  const std::vector<std::uint8_t>& normals() const { return normals_; }
  /// Returns the class of each voxel; 0 if there is no voxel. Empty if the scene has no classes. Floats, which have
  /// classes exactly, because CesiumJS 1.145 reads voxels of UINT8 and FLOAT32 only.
  const std::vector<float>& classes() const { return classes_; }
  /// Returns the statistics of the tile's voxels, without the padding.
  VoxelStatistics statistics() const;

 private:
  std::size_t place_of(std::size_t x, std::size_t y, std::size_t z) const;

  std::uint32_t edge_;  ///< edge of the grid in voxels, including padding
  bool has_normals_;
  GridOrder order_;
  bool is_empty_ = true;
  LevelIndex lowest_{};
  std::vector<std::uint8_t> rgba_, normals_;
  std::vector<float> classes_;
};

}  // namespace gigabake
