/// What a ray reads, made from what a shard holds: nodes that name their children, bricks that rank their voxels, and
/// voxels that are already lit.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/scene_xml.h"
#include "format/shard.h"
#include "kernels/cast_scene.h"
#include "kernels/cast_shade.h"
#include "kernels/policy.h"

namespace gigabake {

/// How stored voxels become light: the same for all pages of a picture.
///
/// The coverage filter stores the mean of what three views along the axes see. Ground is seen face on, but two of the
/// three look along it: where a flat opaque layer has coverage 1 on lod 0 it has 0.67 on lod 1, 0.52 on lod 2, and so
/// on. That share is put back, so that ground does not grow transparent with distance; what was translucent on lod 0
/// stays as it was.
class Shading {
 public:
  Shading(const kernels::CastLight& light, const SceneDescription& scene);
  kernels::CastVoxel operator()(int lod, const std::uint8_t rgba[4], const std::int8_t* normal) const;

 private:
  kernels::CastLight light_;
  bool has_normals_;
  std::array<std::array<std::uint16_t, 256>, kernels::max_cast_lods> extinction_;  ///< by lod and coverage
};

struct NodePage {
  std::vector<kernels::CastNode> nodes;
  std::vector<kernels::CastVoxel> constants;
  std::array<std::uint32_t, kernels::max_cast_lods> bricks{};  ///< per lod: how many the nodes name

  std::uint64_t bytes() const;
};

struct LevelPage {
  std::vector<kernels::CastBrick> bricks;
  std::vector<kernels::CastVoxel> voxels;

  std::uint64_t bytes() const;
};

/// Every index in the page is inside its array; a child's level is one below its parent's.
/// Errors  std::invalid_argument: a table that is not a tree of `lods` levels.
NodePage make_node_page(const NodeTable& table, int lods, const Shading& shading);

/// Errors  std::invalid_argument: arrays that do not fit together, or other than `bricks` bricks.
LevelPage make_level_page(const BrickLevel& level, int lod, std::size_t bricks, const Shading& shading,
                          const kernels::CpuPolicy& policy);

}  // namespace gigabake
