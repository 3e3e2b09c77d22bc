#include "closed_meshes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

namespace gigabake::reference {
namespace {

constexpr double pi = std::numbers::pi;

void add_quad(std::vector<Triangle>& out, const LatticeVertex& a, const LatticeVertex& b, const LatticeVertex& c,
              const LatticeVertex& d) {
  out.push_back({a, b, c});
  out.push_back({a, c, d});
}

LatticeVertex rounded(const LatticeVertex& centre, double x, double y, double z) {
  return {centre[0] + std::llround(x), centre[1] + std::llround(y), centre[2] + std::llround(z)};
}

/// Returns a sphere's triangles, with radius(ring, sector) for each vertex; poles have sector 0.
template <class Radius>
std::vector<Triangle> globe(const LatticeVertex& centre, int rings, const Radius& radius) {
  std::vector<Triangle> out;
  const int sectors = 2 * rings;
  const auto at = [&](int ring, int sector) {
    const bool pole = ring == 0 || ring == rings;
    const int s = pole ? 0 : sector % sectors;
    const double theta = pi * ring / rings, phi = 2 * pi * s / sectors;
    const double r = radius(ring, s), across = pole ? 0 : r * std::sin(theta);
    return rounded(centre, across * std::cos(phi), across * std::sin(phi), r * std::cos(theta));
  };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < sectors; ++j) add_quad(out, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
  return out;
}

/// Returns a positive number if d lies on the side that (b-a) × (c-a) points to.
int side(const LatticeVertex& a, const LatticeVertex& b, const LatticeVertex& c, const LatticeVertex& d) {
  const auto n = normal_of({a, b, c});
  mpz_class sum;
  for (int r = 0; r < 3; ++r) sum += n[r] * mpz_class(long(d[r] - a[r]));
  return sgn(sum);
}

/// Returns true if the closed triangle contains p: p is in its plane, and on the inner side of every edge.
bool contains(const Triangle& t, const LatticeVertex& p) {
  using Wide = __int128;
  const auto cross = [](const LatticeVertex& o, const LatticeVertex& a, const LatticeVertex& b, int r) {
    const int i = (r + 1) % 3, j = (r + 2) % 3;
    return Wide(a[i] - o[i]) * (b[j] - o[j]) - Wide(a[j] - o[j]) * (b[i] - o[i]);
  };
  Wide off_plane = 0;
  for (int r = 0; r < 3; ++r) off_plane += cross(t[0], t[1], t[2], r) * (p[r] - t[0][r]);
  if (off_plane != 0) return false;
  for (int k = 0; k < 3; ++k) {
    Wide along = 0;
    for (int r = 0; r < 3; ++r) along += cross(t[0], t[1], t[2], r) * cross(t[k], t[(k + 1) % 3], p, r);
    if (along < 0) return false;
  }
  return true;
}

/// Returns all faces of the hull, or none if four points share a plane.
std::vector<Triangle> hull_faces(const std::vector<LatticeVertex>& p) {
  std::vector<Triangle> faces;
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t j = i + 1; j < p.size(); ++j)
      for (std::size_t k = j + 1; k < p.size(); ++k) {
        int above = 0, below = 0;
        for (std::size_t l = 0; l < p.size(); ++l) {
          if (l == i || l == j || l == k) continue;
          const int s = side(p[i], p[j], p[k], p[l]);
          if (s == 0) return {};
          (s > 0 ? above : below) += 1;
        }
        if (above == 0) faces.push_back({p[i], p[j], p[k]});
        if (below == 0) faces.push_back({p[i], p[k], p[j]});
      }
  return faces;
}

}  // namespace

ClosedMesh box(const LatticeVertex& low, const LatticeVertex& high) {
  ClosedMesh mesh{"box", {}};
  const auto corner = [&](int bits) {
    return LatticeVertex{bits & 1 ? high[0] : low[0], bits & 2 ? high[1] : low[1], bits & 4 ? high[2] : low[2]};
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, w = 1 << axis;
    add_quad(mesh.triangles, corner(0), corner(v), corner(u | v), corner(u));
    add_quad(mesh.triangles, corner(w), corner(w | u), corner(w | u | v), corner(w | v));
  }
  return mesh;
}

ClosedMesh sphere(const LatticeVertex& centre, double radius, int rings) {
  return {"sphere", globe(centre, rings, [radius](int, int) { return radius; })};
}

ClosedMesh star(const LatticeVertex& centre, std::int64_t nearest, std::int64_t max_distance, int rings, Rng& rng) {
  std::map<std::pair<int, int>, double> radii;  // one radius per vertex, so that the mesh is closed
  return {"star", globe(centre, rings, [&](int ring, int sector) {
            const auto [at, fresh] = radii.try_emplace({ring, sector}, 0);
            if (fresh) at->second = double(uniform(rng, nearest, max_distance));
            return at->second;
          })};
}

ClosedMesh octahedron(const LatticeVertex& c, std::int64_t r) {
  ClosedMesh mesh{"octahedron", {}};
  for (const std::int64_t x : {-r, r})
    for (const std::int64_t y : {-r, r})
      for (const std::int64_t z : {-r, r}) {
        Triangle t{{{c[0] + x, c[1], c[2]}, {c[0], c[1] + y, c[2]}, {c[0], c[1], c[2] + z}}};
        if ((x < 0) != ((y < 0) != (z < 0))) std::swap(t[1], t[2]);
        mesh.triangles.push_back(t);
      }
  return mesh;
}

ClosedMesh torus(const LatticeVertex& centre, double radius, double tube, int segments) {
  ClosedMesh mesh{"torus", {}};
  const auto at = [&](int i, int j) {
    const double a = 2 * pi * (i % segments) / segments, b = 2 * pi * (j % segments) / segments;
    const double r = radius + tube * std::cos(b);
    return rounded(centre, r * std::cos(a), r * std::sin(a), tube * std::sin(b));
  };
  for (int i = 0; i < segments; ++i)
    for (int j = 0; j < segments; ++j) add_quad(mesh.triangles, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
  return mesh;
}

ClosedMesh random_hull(const LatticeVertex& centre, std::int64_t reach, std::int64_t step, int points, Rng& rng) {
  for (;;) {
    std::vector<LatticeVertex> p(points, centre);
    for (auto& v : p)
      for (auto& x : v) x += step * uniform(rng, -reach / step, reach / step);
    ClosedMesh mesh{"hull", hull_faces(p)};
    if (!mesh.triangles.empty()) return mesh;
  }
}

double winding_number(const std::vector<Triangle>& mesh, const LatticeVertex& point) {
  double sum = 0;
  for (const Triangle& t : mesh) {
    const Vec3d a(t[0] - point), b(t[1] - point), c(t[2] - point);
    const double triple = dot(a, cross(b, c)), a_length = length(a), b_length = length(b), c_length = length(c);
    sum += 2 * std::atan2(triple, a_length * b_length * c_length + dot(a, b) * c_length + dot(b, c) * a_length +
                                      dot(c, a) * b_length);
  }
  return sum / (4 * pi);
}

bool holds_lattice_corner(const std::vector<Triangle>& mesh) {
  for (const Triangle& t : mesh) {
    const LatticeVertex low = (min_by_axis(min_by_axis(t[0], t[1]), t[2]) + LatticeVertex::all(255)) >> 8,
                        high = max_by_axis(max_by_axis(t[0], t[1]), t[2]) >> 8;
    for (std::int64_t z = low[2]; z <= high[2]; ++z)
      for (std::int64_t y = low[1]; y <= high[1]; ++y)
        for (std::int64_t x = low[0]; x <= high[0]; ++x)
          if (contains(t, {256 * x, 256 * y, 256 * z})) return true;
  }
  return false;
}

mpq_class volume(const std::vector<Triangle>& mesh) {
  mpz_class six;
  for (const Triangle& t : mesh) {
    const auto n = normal_of(t);
    for (int r = 0; r < 3; ++r) six += n[r] * mpz_class(long(t[0][r]));
  }
  mpq_class v(six, 6);
  v.canonicalize();
  return v;
}

}  // namespace gigabake::reference
