#include "bench/accuracy/leaks/sheet.h"

#include <cmath>

namespace gigabake::bench {
namespace {

/// The tolerance at an edge: larger than the rounding error of double far from the eye.
constexpr double border = 1e-9;

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

}  // namespace

bool is_crossed(const Sheet& sheet, const Vector& origin, const Vector& direction) {
  const Vector normal = cross(sheet.u, sheet.v), to_corner = along(sheet.corner, origin, -1);
  const double towards = dot(direction, normal);
  if (towards == 0) return false;
  const double distance = dot(to_corner, normal) / towards;
  if (!(distance >= 0)) return false;
  const Vector place = along(along(origin, direction, distance), sheet.corner, -1);
  const double squared = dot(normal, normal);
  const double a = dot(cross(place, sheet.v), normal) / squared, b = dot(cross(sheet.u, place), normal) / squared;
  if (a < -border || b < -border) return false;
  if (sheet.shape == SheetShape::triangle) return a + b <= 1 + border;
  return a <= 1 + border && b <= 1 + border;
}

double alpha_through(const std::vector<Sheet>& sheets, double sheet_alpha, const Vector& origin,
                     const Vector& direction) {
  double through = 1;
  for (const Sheet& sheet : sheets)
    if (is_crossed(sheet, origin, direction)) through *= 1 - sheet_alpha;
  return 1 - through;
}

}  // namespace gigabake::bench
