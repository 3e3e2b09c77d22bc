/// Levels of a cell in which some bricks, and whole branches, have a single value.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "kernels/body/cell.h"

namespace gigabake::kernels::test {

/// A tree in which random branches end in constant nodes at any level, finest level first. A key contains the octants
/// from the root down.
class MadeTree {
 public:
  MadeTree(std::mt19937_64& rng, std::size_t lods, bool normals, bool directional_coverage)
      : rng_(rng), normals_(normals), directional_coverage_(directional_coverage), levels_(lods) {
    for (Level& level : levels_) level.first.push_back(0);
    add(0, lods - 1, std::nullopt);
  }
  std::vector<Level> levels() const { return levels_; }

 private:
  using Value = std::uint64_t;  ///< colour, normal, plane

  /// Adds a subtree. `alike` is the value of all nodes below if they are equal.
  void add(std::uint64_t key, std::size_t lod, std::optional<Value> alike) {
    const unsigned chance = unsigned(rng_() % 8);
    if (!alike && chance == 0) alike = rng_() % 3;  // few values, so that neighbours are often equal
    const bool is_full = alike || chance < 3;
    const std::optional<Value> own = alike || chance != 1 ? alike : std::optional<Value>(rng_() % 3);
    add_brick(key, lod, is_full, own);
    if (lod == 0) return;
    for (std::uint64_t octant = 0; octant < 8; ++octant)
      if (alike ? rng_() % 40 != 0 : octant == key % 8 || rng_() % 4 == 0) add(8 * key + octant, lod - 1, alike);
  }

  void add_brick(std::uint64_t key, std::size_t lod, bool is_full, std::optional<Value> value) {
    Level& level = levels_[lod];
    level.key.push_back(key);
    std::uint64_t voxels = 0;
    for (int z = 0; z < 8; ++z) {
      level.mask.push_back(is_full ? ~std::uint64_t(0) : (rng_() & rng_()) | 1);
      voxels += std::uint64_t(std::popcount(level.mask.back()));
    }
    level.first.push_back(level.first.back() + voxels);
    for (std::uint64_t v = 0; v < voxels; ++v) add_voxel(level, lod, value ? *value : rng_());
  }

  void add_voxel(Level& level, std::size_t lod, Value value) const {
    const std::uint8_t alpha = std::uint8_t(200 + value % 3);
    level.rgba.insert(level.rgba.end(), {std::uint8_t(value), std::uint8_t(value >> 8), 7, alpha});
    if (normals_) level.normal.insert(level.normal.end(), {std::int8_t(value % 100), 3});
    if (!directional_coverage_ || (lod == 0 && !normals_)) return;
    const std::uint8_t coverage = lod == 0 ? 0 : alpha;
    level.directional_coverage.insert(level.directional_coverage.end(),
                                      {coverage, coverage, coverage, std::uint8_t(value % 7 == 6)});
  }

  std::mt19937_64& rng_;
  bool normals_, directional_coverage_;
  std::vector<Level> levels_;
};

}  // namespace gigabake::kernels::test
