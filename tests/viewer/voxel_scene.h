/// Scenes that are painted voxel by voxel and kept in memory: the data that a bake would write, without a bake.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/math/vec3.h"
#include "format/scene/xml/scene_xml.h"
#include "format/shard/shard.h"
#include "kernels/cpu/mip/levels.h"
#include "viewer/pictures/camera.h"
#include "viewer/pictures/render.h"
#include "viewer/stream/page.h"

namespace gigabake {

struct Paint {
  std::array<std::uint8_t, 4> rgba{255, 255, 255, 255};
  std::array<std::int8_t, 2> normal{0, 0};  ///< octahedral; 0,0 is up
};

/// A function that returns the content of the lod-0 voxel x, y, z of the lattice, or nullopt if the voxel is empty.
using Painter = std::function<std::optional<Paint>(std::int64_t x, std::int64_t y, std::int64_t z)>;

/// A scene in memory. A voxel is a metre wide, and the lattice's corner is the scene's origin.
class VoxelScene {
 public:
  enum class Nodes { pruned, all_bricks };

  explicit VoxelScene(std::uint32_t cell_voxels) : cell_voxels_(cell_voxels) {}

  /// Adds the cell whose lowest corner is given; adds nothing if the painter leaves it empty.
  void add_cell(const Painter& paint, const Vec3i64& lattice_min, Nodes nodes = Nodes::pruned);
  /// Adds the cells of the cube [min, min + edge).
  void add_cells(const Painter& paint, const Vec3i64& min, std::int64_t edge);

  /// Adds an overview of the cube [min, min + edge) with the levels from first_lod up, computed from the cells. Call
  /// this after adding all cells. The first `copied` levels are duplicated levels.
  void add_overview(const Painter& paint, const Vec3i64& min, std::uint32_t edge, int first_lod, int copied = 0);

  const SceneDescription& description() const { return description_; }
  PagedScene paged() const { return PagedScene::of_cells("scene.xml", description_); }
  std::vector<Shard>& shards() { return shards_; }
  /// Returns a source of pages that borrows this scene.
  PageSource pages() const;

 private:
  void add_shard(const std::vector<kernels::Level>& levels, NodeTable nodes, SceneCell cell,
                 std::vector<SceneCell>& to);

  std::uint32_t cell_voxels_;
  SceneDescription description_;
  std::vector<Shard> shards_;
};

struct PictureOptions {
  CameraOptions camera;
  Background background{false, {0, 0, 0, 0}};
  kernels::CastLight light = kernels::unlit();
  std::uint64_t memory_bytes = std::uint64_t(1) << 30;
  int threads = 2;
};

/// Returns options for a small square image from eye_m towards target_m with a transparent background (alpha 0).
PictureOptions view(const std::array<double, 3>& eye_m, const std::array<double, 3>& target_m, int edge = 96);

Picture take(const VoxelScene& scene, const PictureOptions& options);

}  // namespace gigabake
