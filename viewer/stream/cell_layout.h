/// The octrees that rays traverse, in lookup order: columns by interleaved coordinates, bottom-up in each column.
/// Either each cell has a tree, or a few trees of the size of the root overview cover the whole scene.
///
/// The reconstruction kernel of a voxel extends half a voxel below it (kernels/marching/scene.h), possibly outside all
/// cells. Cells that cover those places are *rim cells*: they have a tree of fields, but no voxels.
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

  /// Refers to the arrays above; its pools are empty.
  kernels::CastScene scene;
};

/// Returns a layout with one tree per cell. scene_path: for messages.
/// Errors  InputError: no cells, cells of different sizes, unaligned cells, cells too far apart, or overlapping cells.
CellLayout lay_out_cells(const std::vector<SceneCell>& cells, const std::filesystem::path& scene_path);

/// Returns a layout of aligned trees of the root overview's size. The root begins at a multiple of half its size, so
/// two trees along each axis contain it and its rims. window: of all cells.
CellLayout lay_out_root(const SceneCell& root, const Box3i64& window);

}  // namespace gigabake
