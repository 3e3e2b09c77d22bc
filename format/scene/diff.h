/// Do two scenes hold the same voxels, and if not, where and by how much do they differ?
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lattice/progress.h"

namespace gigabake {

/// Voxels of one level where a cell of A and a cell of B overlap, or of one cell where the other scene has none.
struct LevelDifference {
  int lod = 0;
  std::uint64_t only_in_a = 0, only_in_b = 0, both = 0;
  std::uint64_t recoloured = 0;  ///< of `both`: r, g, b or alpha differ
  std::uint64_t turned = 0;      ///< of `both`: the normal differs
  std::uint64_t refaced = 0;     ///< of `both`: the coverage along an axis differs, where both scenes have it
  std::array<int, 4> largest{};  ///< |a − b| of 8-bit r, g, b, alpha
  std::array<double, 4> mean{};  ///< of |a − b| over `recoloured`
  bool any() const { return only_in_a + only_in_b + recoloured + turned + refaced != 0; }
};

struct CellDifference {
  std::string cell_in_a, cell_in_b;     ///< empty: no cell of that scene is there
  std::vector<LevelDifference> levels;  ///< those that differ
};

struct SceneDifference {
  std::vector<CellDifference> cells;  ///< those that differ
  std::vector<int> compared;          ///< levels
  /// Levels that could not be compared everywhere: only one scene has them, or where cells are cut differently their
  /// voxels are other cubes.
  std::vector<int> not_compared;
  bool same() const { return cells.empty(); }
};

/// Cost    One look-up of each shard in its folder; none is opened.
/// Errors  InputError: shards are missing or have another size than scene.xml says; names the first.
void expect_shards(const std::filesystem::path& scene_xml);

/// Cells may be cut differently in the two scenes; voxels are then compared by their place on the lattice.
/// Exact   Levels whose content hashes agree, in whole or cell by cell, are the same and are not read: the hashes in
///         scene.xml are believed (verify checks them). Use expect_shards() first: recorded
///         hashes describe files, and say nothing of a scene whose files are gone.
/// Cost    Memory: one level of two cells at a time.
/// Errors  InputError: unreadable scenes or shards; lattices or channels
/// that differ, so that nothing can be compared.
SceneDifference diff_scenes(const std::filesystem::path& a, const std::filesystem::path& b,
                            const Progress& progress = {});

}  // namespace gigabake
