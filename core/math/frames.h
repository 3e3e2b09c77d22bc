/// Frames of reference as types: a point of one frame cannot be mixed with a point of another.
///
/// Ecef    WGS84 earth-centred earth-fixed metres.
/// Scene   The frame of a bake in metres, z up. For georeferenced sources it is east-north-up at the scene origin
///         (GeographicLib::LocalCartesian). For other sources it is the source's frame, rotated so that z points up.
/// World   The frame of a tileset's root: Ecef or local metres. One rigid transform converts it to Scene.
/// Local   The coordinates written in a mesh's vertex buffer (glTF, y up).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "core/base/rules.h"

namespace gigabake {

/// The axis of a file that points up: y in glTF, z for the tiles of 3D Tiles.
enum class UpAxis : std::uint8_t { y, z, x };
template <>
constexpr auto names_of<UpAxis>() {
  return std::to_array<std::string_view>({"y", "z", "x"});
}

struct Ecef;
struct Scene;
struct World;
struct Local;

template <class Frame>
struct Point {
  double x = 0, y = 0, z = 0;
  friend bool operator==(const Point&, const Point&) = default;
};

/// An affine map. The first frame is the destination: `Affine<Scene, Local> scene_from_local`. Stores the rows of a 3×4
/// matrix in double; the last column is the translation in metres.
template <class To, class From>
struct Affine {
  std::array<std::array<double, 4>, 3> m{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

  Point<To> operator()(const Point<From>& p) const {
    const auto row = [&](int r) { return m[r][0] * p.x + m[r][1] * p.y + m[r][2] * p.z + m[r][3]; };
    return {row(0), row(1), row(2)};
  }

  double linear_determinant() const {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  }

  bool is_finite() const {
    for (const auto& row : m)
      for (double v : row)
        if (!std::isfinite(v)) return false;
    return true;
  }

  friend bool operator==(const Affine&, const Affine&) = default;
};

/// Returns a ∘ b: applies b first, then a.
template <class To, class Mid, class From>
Affine<To, From> operator*(const Affine<To, Mid>& a, const Affine<Mid, From>& b) {
  Affine<To, From> r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) {
      double sum = j == 3 ? a.m[i][3] : 0.0;
      for (int k = 0; k < 3; ++k) sum += a.m[i][k] * b.m[k][j];
      r.m[i][j] = sum;
    }
  return r;
}

/// A geodetic position on WGS84 in degrees, and in metres above the ellipsoid.
struct Geodetic {
  double latitude_deg = 0, longitude_deg = 0, height_m = 0;
  friend bool operator==(const Geodetic&, const Geodetic&) = default;
};

}  // namespace gigabake
