/// Do two scenes hold the same voxels, and if not, where and by how much do they differ?
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace gigabake {

/// Voxels of one level inside one cell of A, or those of a cell of B that lie in no cell of A.
struct DiffPlace {
  std::string cell;
  std::uint64_t only_in_a = 0, only_in_b = 0, both = 0, changed = 0;
  std::array<int, 4> largest{};  ///< |a − b| of 8-bit r, g, b, alpha over `both`
  std::array<double, 4> mean{};  ///< its mean over `both`
  std::uint64_t normals_changed = 0;
};

struct DiffResult {
  bool same = false;              ///< equal content on `lod`
  std::vector<DiffPlace> places;  ///< of cells that differ, in the order of the scenes
  std::uint64_t cells_compared = 0;
};

/// Cells may be laid out differently in the two; the lattices must agree.
/// Cost  Cells of equal place and hash are not read. Memory: one cell of A and what lies over it in B.
/// Errors  InputError: unreadable scenes or shards, lattices that differ (there is nothing to compare), no such lod.
DiffResult diff_scenes(const std::filesystem::path& a, const std::filesystem::path& b, int lod);

}  // namespace gigabake
