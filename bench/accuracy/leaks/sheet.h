/// Flat pieces of a surface, and whether a ray crosses them: what is seen of a scene of sheets is known in closed form.
///
/// Space   Lod-0 voxels of the lattice, z up.
#pragma once

#include <array>
#include <vector>

namespace gigabake::bench {

using Vector = std::array<double, 3>;

enum class SheetShape { parallelogram, triangle };

/// The points corner + a·u + b·v with a and b from 0 to 1; in a triangle a + b is at most 1.
struct Sheet {
  Vector corner{}, u{}, v{};
  SheetShape shape = SheetShape::parallelogram;
};

/// direction: of any length. The border belongs to the sheet, so that a ray finds no gap between two that share it.
/// Exact   double; a sheet that is seen on edge is not crossed.
bool is_crossed(const Sheet& sheet, const Vector& origin, const Vector& direction);

/// What sheets of one alpha, one behind the other, leave no light through: 1 - (1 - alpha)^crossed.
double alpha_through(const std::vector<Sheet>& sheets, double sheet_alpha, const Vector& origin,
                     const Vector& direction);

/// At that distance from `from`.
inline Vector along(const Vector& from, const Vector& direction, double distance) {
  return {from[0] + distance * direction[0], from[1] + distance * direction[1], from[2] + distance * direction[2]};
}

}  // namespace gigabake::bench
