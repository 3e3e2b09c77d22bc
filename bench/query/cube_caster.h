/// A ray caster on top of Embree that represents voxels as cubes of quads.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/math/vec3.h"

namespace gigabake::bench {

/// A caster for a set of voxels; first_hit() is thread-safe.
class CubeCaster {
 public:
  /// Builds the caster. `voxels` holds the position of each voxel in its level, without duplicates.
  /// Errors  UsageError: built without Embree.
  CubeCaster(const std::vector<Vec3i64>& voxels, int threads);
  ~CubeCaster();
  CubeCaster(const CubeCaster&) = delete;
  CubeCaster& operator=(const CubeCaster&) = delete;

  struct Hit {
    Vec3i64 voxel;
    double distance;
  };
  /// Returns the first voxel that the ray hits. `direction` is a unit vector.
  /// Space   Voxels of the level.
  std::optional<Hit> first_hit(const Vec3d& origin, const Vec3d& direction) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gigabake::bench
