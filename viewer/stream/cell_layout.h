/// The trees that rays go down, in the order that they are found in: columns by interleaved coordinates, upwards in
/// each. Either there is a tree to each cell, or the whole scene hangs from a few that are as large as its root parent.
///
/// A voxel's field reaches half a voxel below the voxel (kernels/cast/scene.h), so it may begin in a place that no cell
/// of the scene covers. *Rim cells* cover it: they have a tree of fields, but no voxels of their own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "format/scene/cell_window.h"
#include "kernels/cast/scene.h"

namespace gigabake {

struct CellLayout {
  std::vector<kernels::CastCell> cells;
  std::vector<std::uint64_t> column_key;
  std::vector<std::uint32_t> column_first;

  /// With spans of the arrays above; nothing is in its pools.
  kernels::CastScene scene;
};

/// scene_path: for messages.
/// Errors  InputError: no cells, cells of several sizes, off their lattice, too far apart or one inside the other.
CellLayout lay_out_cells(const std::vector<SceneCell>& cells, const std::filesystem::path& scene_path);

/// Aligned trees of the root parent's size, which begins at a multiple of half of it: two along each axis hold it and
/// its rims. window: of all cells.
CellLayout lay_out_root(const SceneCell& root, const LatticeBox& window);

}  // namespace gigabake
