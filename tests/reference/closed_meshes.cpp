#include "closed_meshes.h"

#include <cmath>
#include <numbers>

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

/// > 0 where d lies on the side that (b-a) × (c-a) points to.
int side(const LatticeVertex& a, const LatticeVertex& b, const LatticeVertex& c, const LatticeVertex& d) {
  const auto n = normal_of({a, b, c});
  mpz_class sum;
  for (int r = 0; r < 3; ++r) sum += n[r] * mpz_class(long(d[r] - a[r]));
  return sgn(sum);
}

/// All faces of the hull, or none when four points share a plane.
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
  ClosedMesh mesh{"sphere", {}};
  const int sectors = 2 * rings;
  const auto at = [&](int ring, int sector) {
    const double theta = pi * ring / rings, phi = 2 * pi * (sector % sectors) / sectors;
    const double r = ring == 0 || ring == rings ? 0 : radius * std::sin(theta);
    return rounded(centre, r * std::cos(phi), r * std::sin(phi), radius * std::cos(theta));
  };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < sectors; ++j) add_quad(mesh.triangles, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
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
    double p[3][3], length[3];
    for (int k = 0; k < 3; ++k) {
      for (int r = 0; r < 3; ++r) p[k][r] = double(t[k][r] - point[r]);
      length[k] = std::sqrt(p[k][0] * p[k][0] + p[k][1] * p[k][1] + p[k][2] * p[k][2]);
    }
    const auto dot = [&](int a, int b) { return p[a][0] * p[b][0] + p[a][1] * p[b][1] + p[a][2] * p[b][2]; };
    const double triple = p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) -
                          p[0][1] * (p[1][0] * p[2][2] - p[1][2] * p[2][0]) +
                          p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
    sum += 2 * std::atan2(triple, length[0] * length[1] * length[2] + dot(0, 1) * length[2] + dot(1, 2) * length[0] +
                                      dot(2, 0) * length[1]);
  }
  return sum / (4 * pi);
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
