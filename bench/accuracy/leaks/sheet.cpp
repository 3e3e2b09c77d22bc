#include "bench/accuracy/leaks/sheet.h"

#include <cmath>

namespace gigabake::bench {
namespace {

/// The tolerance at an edge: larger than the rounding error of double far from the eye.
constexpr double border = 1e-9;

}  // namespace

bool is_crossed(const Sheet& sheet, const Vec3d& origin, const Vec3d& direction) {
  const Vec3d normal = cross(sheet.u, sheet.v), to_corner = sheet.corner - origin;
  const double towards = dot(direction, normal);
  if (towards == 0) return false;
  const double distance = dot(to_corner, normal) / towards;
  if (!(distance >= 0)) return false;
  const Vec3d place = origin + direction * distance - sheet.corner;
  const double squared = dot(normal, normal);
  const double a = dot(cross(place, sheet.v), normal) / squared, b = dot(cross(sheet.u, place), normal) / squared;
  if (a < -border || b < -border) return false;
  if (sheet.shape == SheetShape::triangle) return a + b <= 1 + border;
  return a <= 1 + border && b <= 1 + border;
}

double alpha_through(const std::vector<Sheet>& sheets, double sheet_alpha, const Vec3d& origin,
                     const Vec3d& direction) {
  double through = 1;
  for (const Sheet& sheet : sheets)
    if (is_crossed(sheet, origin, direction)) through *= 1 - sheet_alpha;
  return 1 - through;
}

}  // namespace gigabake::bench
