/// Samples of one level at arbitrary distances along a ray.
///
/// Space   Coordinates and distances are lod-0 voxels of the scene's lattice.
/// Exact   IEEE double: host and device return the same bits.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "kernels/marching/locate.h"
#include "kernels/marching/ray_light.h"
#include "kernels/marching/sample.h"

namespace gigabake::kernels {

/// A sampler of one level of a ray.
struct LevelSampler {
  LevelPoints points;
  std::int32_t lod;
  CellFrame frame;
  SampleLocation place;  ///< where the last sample lies

  GB_HD LevelSampler(const CastScene& scene, const CastLine& line, int level)
      : points(level_points(scene, line, level)), lod(level) {}

  GB_HD void look(const CastScene& scene, const CastLine& line, double distance, bool blocking, CastPath& path) {
    const FixedPoint at = points.at(line, lod, (distance - point_distance(line, lod, 0)) * steps_per_voxel(lod));
    place = find_brick(scene, line, points, lod, at, blocking, frame, path);
  }
  /// Returns the properties of the brick that holds the last sample.
  GB_HD BrickTraits traits() const { return {place.lod, frame.cell, place.waits}; }
  GB_HD CastPoint point() const { return point_in_brick(place.at, place.lod); }
};

}  // namespace gigabake::kernels
