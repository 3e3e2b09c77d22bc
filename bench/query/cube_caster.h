/// Voxels as cubes of quads, and rays that find them, by Embree.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace gigabake::bench {

/// Any number of threads may cast.
class CubeCaster {
 public:
  using Voxel = std::array<std::int64_t, 3>;

  /// voxels: their places in their level, each once. Errors  UsageError: built without Embree.
  CubeCaster(const std::vector<Voxel>& voxels, int threads);
  ~CubeCaster();
  CubeCaster(const CubeCaster&) = delete;
  CubeCaster& operator=(const CubeCaster&) = delete;

  struct Hit {
    Voxel voxel;
    double distance;
  };
  /// Space  Voxels of the level. direction: unit.
  std::optional<Hit> first_hit(const std::array<double, 3>& origin, const std::array<double, 3>& direction) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gigabake::bench
