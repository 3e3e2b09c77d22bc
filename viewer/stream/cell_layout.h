/// The octrees that rays traverse. They are sorted by the Morton codes of their columns, and by z in each column.
/// Either each cell has a tree, or a few trees of the size of the root overview cover the whole scene.
///
/// The reconstruction kernel of a voxel extends half a voxel below the voxel (kernels/marching/scene.h), possibly
/// outside all cells. Additional *rim cells* cover these places: a rim cell has a tree, but no voxels.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/math/box3.h"
#include "format/scene/cell_window.h"
#include "kernels/marching/scene.h"

namespace gigabake {

struct CellLayout {
  std::vector<kernels::CastCell> cells;
  std::vector<std::uint64_t> column_key;
  std::vector<std::uint32_t> column_first;
  int leaf_lod = 0;  ///< SceneHeader::leaf_lod

  /// The scene for the ray caster. It refers to the arrays above; its pools are empty.
  kernels::CastScene scene;
};

/// Returns a layout with one tree per cell. `scene_path` is used only in messages.
/// Errors  InputError: no cells, cells of different sizes, unaligned cells, cells too far apart, or overlapping cells.
CellLayout lay_out_cells(const std::vector<SceneCell>& cells, const std::filesystem::path& scene_path);

/// Returns a layout of aligned trees of the root overview's size. The root begins at a multiple of half its size, so
/// two trees along each axis contain the root and its rims. `window` contains all cells.
CellLayout lay_out_root(const SceneCell& root, const Box3i64& window);

}  // namespace gigabake
