/// Comparison of the voxels of two scenes.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/progress.h"

namespace gigabake {

/// Differences of one level, in the overlap of two cells or in a cell that only one scene has.
struct LevelDifference {
  int lod = 0;
  std::uint64_t only_in_a = 0, only_in_b = 0, both = 0;
  std::uint64_t recoloured = 0;  ///< voxels of `both` whose r, g, b or alpha differ
  std::uint64_t turned = 0;      ///< voxels of `both` whose normals differ
  std::uint64_t refaced = 0;     ///< voxels of `both` whose directional coverage differs; 0 unless both scenes store it
  std::uint64_t reclassified = 0;  ///< voxels of `both` whose classes differ; without classes, each has class 0
  std::array<int, 4> maximum{};    ///< max |a − b| of 8-bit r, g, b, alpha
  std::array<double, 4> mean{};    ///< mean |a − b| of 8-bit r, g, b, alpha over the recoloured voxels
  bool any() const { return only_in_a + only_in_b + recoloured + turned + refaced + reclassified != 0; }
};

struct CellDifference {
  std::string cell_in_a, cell_in_b;     ///< empty if the scene has no cell at this position
  std::vector<LevelDifference> levels;  ///< only levels that differ
};

struct SceneDifference {
  std::vector<CellDifference> cells;  ///< only cells that differ
  std::vector<int> compared;          ///< lods that were compared everywhere
  /// Levels that were not compared everywhere. Either only one scene has them, or the corners of cells differ so that
  /// voxels are not the same cubes of the lattice.
  std::vector<int> not_compared;
  bool same() const { return cells.empty(); }
};

/// Checks that each shard exists with the size that scene.xml records.
/// Cost    One directory lookup per shard; opens no shard.
/// Errors  InputError names the first shard that is missing or has another size.
void expect_shards(const std::filesystem::path& scene_xml);

/// Compares two scenes. If the scenes have different cells, voxels are compared by their position on the lattice.
/// Exact   Levels whose content hashes are equal, for the whole scene or for a cell, count as equal and are not read.
///         The hashes in scene.xml are trusted; verify checks them. Call expect_shards() first: recorded hashes do not
///         prove that the files still exist.
/// Cost    Holds one level of two cells in memory.
/// Errors  InputError if scenes or shards are unreadable, or if the scenes are not comparable because lattices or
///         channels differ.
SceneDifference diff_scenes(const std::filesystem::path& a, const std::filesystem::path& b,
                            const Progress& progress = {});

}  // namespace gigabake
