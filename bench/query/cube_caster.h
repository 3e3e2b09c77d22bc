/// A ray caster on top of Embree that represents voxels as cubes of quads.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace gigabake::bench {

/// A caster for a set of voxels; first_hit() is thread-safe.
class CubeCaster {
 public:
  using Voxel = std::array<std::int64_t, 3>;

  /// Builds the caster. `voxels` holds the position of each voxel in its level, without duplicates.
  /// Errors  UsageError: built without Embree.
  CubeCaster(const std::vector<Voxel>& voxels, int threads);
  ~CubeCaster();
  CubeCaster(const CubeCaster&) = delete;
  CubeCaster& operator=(const CubeCaster&) = delete;

  struct Hit {
    Voxel voxel;
    double distance;
  };
  /// Returns the first voxel that the ray hits. `direction` is a unit vector.
  /// Space   Voxels of the level.
  std::optional<Hit> first_hit(const std::array<double, 3>& origin, const std::array<double, 3>& direction) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gigabake::bench
