/// Rays through a scene's voxels, and their first hits.
///
/// Space   Lod-0 voxels of the scene's lattice, distances included.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "core/base/host_device.h"
#include "core/base/rules.h"
#include "kernels/marching/voxel_space.h"

namespace gigabake {

struct QueryRay {
  double origin[3] = {};
  double direction[3] = {};  ///< unit length
  double begin = 0;          ///< start of the searched interval
  double end = std::numeric_limits<double>::infinity();
};

enum class QueryOutcome : std::uint8_t {
  hit,
  nothing,  ///< the ray crossed the scene without a hit
  outside,  ///< the ray misses the scene's bounding box
  missing   ///< the ray reached a lost or unreadable cell before any hit
};
template <>
constexpr auto names_of<QueryOutcome>() {
  return std::to_array<std::string_view>({"hit", "nothing hit", "outside the scene", "cell missing"});
}

struct QueryHit {
  static constexpr std::uint32_t no_shard = 0xffffffffu;

  QueryOutcome outcome = QueryOutcome::nothing;
  std::int32_t lod = 0;  ///< level of the voxel
  /// The distance at which the ray enters the voxel. If the ray starts or changes its level inside the voxel, the
  /// distance of that point. For the outcome `missing`, the distance at which the ray enters the missing cell.
  double distance = std::numeric_limits<double>::infinity();
  std::int64_t voxel[3] = {};      ///< lowest corner
  std::uint32_t rgba = 0;          ///< sRGB colour and coverage; red in the lowest byte
  std::int8_t normal[2] = {};      ///< octahedral
  std::uint16_t voxel_class = 0;   ///< 0 also in scenes without classes
  std::uint8_t plane = 0;          ///< of the surface (core/octree/plane.h); 0: none
  std::uint32_t shard = no_shard;  ///< number of the shard that holds the voxel or is missing (SceneQuery::name_of())
};

/// The interval of distances in which a ray is in a box; empty if enter > leave.
struct RayChord {
  double enter, leave;
  GB_HD bool empty() const { return !(enter <= leave); }
};

/// Intersects the ray's interval [begin, end] with a box that is grown by `rim` on all sides.
GB_HD RayChord chord_of(const QueryRay& ray, const kernels::VoxelBox& box, double rim) {
  RayChord chord{ray.begin, ray.end};
  for (int a = 0; a < 3; ++a) {
    const double o = ray.origin[a], d = ray.direction[a], low = double(box.min[a]) - rim,
                 high = double(box.max[a]) + rim;
    if (d == 0) {
      if (o < low || o > high) return {1, 0};
      continue;
    }
    const double near = ((d > 0 ? low : high) - o) / d, far = ((d > 0 ? high : low) - o) / d;
    if (near > chord.enter) chord.enter = near;
    if (far < chord.leave) chord.leave = far;
  }
  return chord;
}

}  // namespace gigabake
