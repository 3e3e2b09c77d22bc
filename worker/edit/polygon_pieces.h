/// Cuts a triangle along the border of a polygon.
///
/// Exact   IEEE double in the polygon's plane, relative to the triangle's first corner. Positions that are not on the
///         border keep their side exactly as AreaPolygon::contains() if no coordinate is rounded.
#pragma once

#include <array>
#include <vector>

#include "format/area/polygon.h"

namespace gigabake {

/// A corner of a piece: its position in the polygon's plane, and its weights of the triangle's corners.
struct PieceCorner {
  double x = 0, y = 0;
  std::array<double, 3> weight{};
};

/// A convex piece of a triangle, in the triangle's orientation.
struct TrianglePiece {
  std::vector<PieceCorner> corners;
  bool is_inside = false;  ///< inside the polygon
};

/// Returns pieces that together are the triangle, each inside or outside the polygon.
/// Cost    Time is linear in the polygon's corners at the heights (y) of the triangle, times the edges there.
std::vector<TrianglePiece> pieces_of(const std::array<std::array<double, 2>, 3>& triangle, const AreaPolygon& polygon);

}  // namespace gigabake
