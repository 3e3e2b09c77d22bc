/// Boxes of the cells of a running bake in an image, and the cell at a pixel.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/math/box3.h"
#include "format/scene/scene_watch.h"
#include "kernels/marching/cast_camera.h"
#include "viewer/pictures/picture.h"

namespace gigabake {

struct CellBox {
  Box3i64 window;  ///< lod-0 voxels
  CellState state = CellState::done;
};

/// The maximum number of boxes in an image. Failed and baking cells come first, then the nearest waiting cells.
inline constexpr std::size_t max_boxes_drawn = 4096;

/// Draws the edges of cells that are not done: grey if they wait, yellow if they are baking, red with diagonals if they
/// failed. Edges behind surfaces are faint. Changes the colours of the image and not its depth.
void draw_boxes(Picture& picture, const kernels::CastCamera& camera, std::span<const CellBox> cells);

/// Draws the edges of a box in lod-0 voxels, like the edges of cells.
void draw_edges(Picture& picture, const kernels::CastCamera& camera, const Box3i64& box,
                const std::array<std::uint8_t, 3>& rgb);

/// Returns the index of the cell at (right, down), fractions of the image's width and height from its upper left
/// corner. This is the first cell that is not done before the surface, else the cell of the surface.
std::optional<std::uint32_t> picked_cell(const Picture& picture, const kernels::CastCamera& camera,
                                         std::span<const CellBox> cells, double right, double down);

/// Returns the facts as one line, such as "c_1_2_0: waiting, 120 triangles, 3.0 % of the cost, 1 tile: a.glb".
std::string cell_text(const CellFacts& facts);

}  // namespace gigabake
