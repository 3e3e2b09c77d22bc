/// Stage 1 of a cell: the triangles that may touch the window, transformed, snapped, winding restored.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/body/brick_triangle.h"
#include "kernels/body/cell.h"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {

/// Order follows parts and indices. Counts triangles, non_finite, zero_area, oversized, bad_uv into `stats`.
std::vector<WindowTriangle> window_triangles(const CellInput& input, const CellParameters& parameters,
                                             const ThreadPool& pool, CellStats& stats);

/// Negative determinant of the linear part: the instance shows its triangles from behind.
bool is_mirrored(const double scene_from_local[12]);

/// Whether its texture is read: where there are no coordinates, the material is one without.
bool is_textured(const CellInput& input, const PartView& part);

/// Vertex indices of a triangle in the order that WindowTriangle::p has them.
inline void triangle_vertices(const PartView& part, bool mirrored, std::uint32_t triangle, std::uint32_t v[3]) {
  const std::uint32_t* i = part.index.data + 3 * std::size_t(triangle);
  v[0] = i[0];
  v[1] = mirrored ? i[2] : i[1];
  v[2] = mirrored ? i[1] : i[2];
}

}  // namespace gigabake::kernels
