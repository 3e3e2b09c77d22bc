/// Flat pieces of a surface, and their intersections with rays. The alpha of a scene of such pieces is known in closed
/// form.
///
/// Space   Lod-0 voxels of the lattice, z up.
#pragma once

#include <vector>

#include "core/math/vec3.h"

namespace gigabake::bench {

enum class SheetShape { parallelogram, triangle };

/// A parallelogram, the points corner + a·u + b·v with a and b from 0 to 1, or its triangle with a + b ≤ 1.
struct Sheet {
  Vec3d corner{}, u{}, v{};
  SheetShape shape = SheetShape::parallelogram;
};

/// Returns true if the ray crosses the piece. `direction` may have any length. The border belongs to the piece, so that
/// a ray finds no gap between adjacent pieces.
/// Exact   Computed in double; a piece seen edge-on is not crossed.
bool is_crossed(const Sheet& sheet, const Vec3d& origin, const Vec3d& direction);

/// Returns the alpha of all pieces that a ray crosses: 1 - (1 - sheet_alpha)^n for n pieces.
double alpha_through(const std::vector<Sheet>& sheets, double sheet_alpha, const Vec3d& origin, const Vec3d& direction);

}  // namespace gigabake::bench
