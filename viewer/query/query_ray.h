/// What is asked of a scene's voxels, and what they answer: the first voxel that a ray meets.
///
/// Space   Lod-0 voxels of the scene's lattice; distances in them too.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "kernels/cast/locate.h"
#include "lattice/rules.h"

namespace gigabake {

struct QueryRay {
  double origin[3] = {};
  double direction[3] = {};  ///< unit
  double begin = 0;          ///< what is nearer than this is not looked at
  double end = std::numeric_limits<double>::infinity();
};

enum class QueryOutcome : std::uint8_t {
  hit,
  nothing,  ///< the ray went through the scene and met nothing
  outside,  ///< the ray is nowhere in the scene's box
  missing   ///< before anything was met the ray came to a cell that is lost or cannot be read
};
template <>
constexpr auto names_of<QueryOutcome>() {
  return std::to_array<std::string_view>({"hit", "nothing hit", "outside the scene", "cell missing"});
}

struct QueryHit {
  static constexpr std::uint32_t no_shard = 0xffffffffu;

  QueryOutcome outcome = QueryOutcome::nothing;
  std::int32_t lod = 0;  ///< of the voxel
  /// From the origin to where the ray enters the voxel, or, if it starts in it or changes to its level there, is in it;
  /// missing: to where the ray enters that cell.
  double distance = std::numeric_limits<double>::infinity();
  std::int64_t voxel[3] = {};      ///< its lowest corner
  std::uint32_t rgba = 0;          ///< sRGB colour and coverage, bytes from the lowest
  std::int8_t normal[2] = {};      ///< octahedral
  std::uint32_t shard = no_shard;  ///< that holds it, or is missing (SceneQuery::name_of())
};

/// Distances between which a ray is in a box; none where enter > leave.
struct RayChord {
  double enter, leave;
  bool empty() const { return !(enter <= leave); }
};

/// The box [min, max], grown by `rim` on all sides; within the ray's begin and end.
inline RayChord chord_of(const QueryRay& ray, const kernels::VoxelBox& box, double rim) {
  RayChord chord{ray.begin, ray.end};
  for (int a = 0; a < 3; ++a) {
    const double o = ray.origin[a], d = ray.direction[a], low = double(box.min[a]) - rim,
                 high = double(box.max[a]) + rim;
    if (d == 0) {
      if (o < low || o > high) return {1, 0};
      continue;
    }
    chord.enter = std::fmax(chord.enter, ((d > 0 ? low : high) - o) / d);
    chord.leave = std::fmin(chord.leave, ((d > 0 ? high : low) - o) / d);
  }
  return chord;
}

}  // namespace gigabake
