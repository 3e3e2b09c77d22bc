#include "bench/hard/exact_place.h"

#include <cmath>
#include <numbers>

namespace gigabake::bench {
namespace {

template <class To, class From>
LongAffine widened(const Affine<To, From>& map) {
  LongAffine out;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 4; ++c) out.m[r][c] = map.m[r][c];
  return out;
}

/// Returns the transform whose columns are east, north, up and the position of the place in ECEF.
LongAffine axes_at(const Geodetic& g) {
  constexpr long double a = 6378137, f = 1 / 298.257223563L, e2 = f * (2 - f);
  constexpr long double degree = std::numbers::pi_v<long double> / 180;
  const long double sp = sinl(g.latitude_deg * degree), cp = cosl(g.latitude_deg * degree);
  const long double sl = sinl(g.longitude_deg * degree), cl = cosl(g.longitude_deg * degree);
  const long double n = a / sqrtl(1 - e2 * sp * sp), h = g.height_m;
  return {{{-sl, -cl * sp, cl * cp, (n + h) * cp * cl},
           {cl, -sl * sp, sl * cp, (n + h) * cp * sl},
           {0, cp, sp, ((1 - e2) * n + h) * sp}}};
}

LongPoint vertex(const HardMesh& mesh, std::size_t v) { return LongPoint::from(&mesh.position[3 * v]); }

/// Returns the triangle on the lattice; nullopt if a coordinate of a vertex is not finite or is 2^53 sub-voxels or
/// more.
std::optional<reference::Painted> painted(const HardMesh& mesh, std::size_t triangle, const LongAffine& map,
                                          const BakeParameters& parameters) {
  constexpr long double limit = 9007199254740992.0L;  // 2^53
  reference::Painted out;
  if (!mesh.rgba.empty()) out.vertex_colours.emplace();
  const bool mirrors = map.determinant() < 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t v = mesh.index[3 * triangle + k], to = mirrors && k != 0 ? 3 - k : k;
    const LongPoint q = lattice_place(parameters, map * vertex(mesh, v));
    for (const long double x : q)
      if (!(x > -limit && x < limit)) return std::nullopt;
    out.triangle[to] = snapped(q);
    for (std::size_t c = 0; c < 4 && !mesh.rgba.empty(); ++c) (*out.vertex_colours)[to][c] = mesh.rgba[4 * v + c];
  }
  return out;
}

}  // namespace

long double LongAffine::determinant() const {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

LongPoint operator*(const LongAffine& map, const LongPoint& p) {
  return LongPoint::by_axis([&](int r) { return dot(LongPoint::from(map.m[r]), p) + map.m[r][3]; });
}

LongAffine operator*(const LongAffine& a, const LongAffine& b) {
  LongAffine out;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) {
      out.m[r][c] = c == 3 ? a.m[r][3] : 0;
      for (int k = 0; k < 3; ++k) out.m[r][c] += a.m[r][k] * b.m[k][c];
    }
  return out;
}

LongAffine ecef_from_enu_at(const Geodetic& place) { return axes_at(place); }

LongAffine enu_from_ecef(const Geodetic& origin) {
  const LongAffine back = axes_at(origin);
  LongAffine out;
  for (int r = 0; r < 3; ++r) {
    out.m[r][3] = 0;
    for (int c = 0; c < 3; ++c) {
      out.m[r][c] = back.m[c][r];
      out.m[r][3] -= back.m[c][r] * back.m[c][3];
    }
  }
  return out;
}

std::vector<LongAffine> exact_placements(const HardScene& scene, const std::optional<Geodetic>& origin) {
  const LongAffine scene_from_world = scene.on_earth && origin ? enu_from_ecef(*origin) : LongAffine();
  std::vector<LongAffine> out;
  for (const HardTile& tile : scene.tiles)
    for (const HardNode& node : tile.nodes)
      out.push_back(scene_from_world * (widened(tile.transform) * widened(node.map)));
  return out;
}

LongPoint lattice_place(const BakeParameters& parameters, const LongPoint& p_scene_m) {
  return (p_scene_m - LongPoint(parameters.lattice_origin_m)) / parameters.voxel_size_m * 256;
}

reference::LatticeVertex snapped(const LongPoint& p_lattice) {
  return reference::LatticeVertex::by_axis([&](int r) { return std::int64_t(floorl(p_lattice[r] + 0.5L)); });
}

std::vector<reference::Painted> painted_triangles(const HardScene& scene, const std::optional<Geodetic>& origin,
                                                  const BakeParameters& parameters) {
  const std::vector<LongAffine> placements = exact_placements(scene, origin);
  std::vector<reference::Painted> out;
  auto placement = placements.begin();
  for (const HardTile& tile : scene.tiles)
    for (const HardNode& node : tile.nodes) {
      const HardMesh& mesh = tile.meshes[std::size_t(node.mesh)];
      const HardMaterial& material = tile.materials[std::size_t(mesh.material)];
      for (std::size_t t = 0; t < mesh.index.size() / 3; ++t)
        if (auto one = painted(mesh, t, *placement, parameters)) {
          one->colour = material.base;
          one->mode = material.mode;
          out.push_back(*one);
        }
      ++placement;
    }
  return out;
}

}  // namespace gigabake::bench
