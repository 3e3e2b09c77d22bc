#include "bench/exact/exact_clip.h"

#include <algorithm>
#include <cmath>

#include "core/base/rules.h"

namespace gigabake::reference {
namespace {

constexpr std::int64_t voxel_edge = 256;

std::int64_t floor_div(std::int64_t a, std::int64_t b) { return a / b - (a % b < 0 ? 1 : 0); }

mpz_class big(std::int64_t v) { return mpz_class(static_cast<long>(v)); }

/// Returns the part sign·(p[axis] - plane) ≥ 0 of a convex polygon. The result is exact also for points and segments.
/// Source  Sutherland and Hodgman 1974.
Polygon clip(const Polygon& in, int axis, const mpq_class& plane, int sign) {
  Polygon out;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const RationalPoint& a = in[i];
    const RationalPoint& b = in[(i + 1) % in.size()];
    const mpq_class da = sign * (a[axis] - plane), db = sign * (b[axis] - plane);
    if (da >= 0) out.push_back(a);
    if (sgn(da) * sgn(db) >= 0) continue;
    const mpq_class s = da / (da - db);
    RationalPoint cut;
    for (int r = 0; r < 3; ++r) cut[r] = r == axis ? plane : mpq_class(a[r] + s * (b[r] - a[r]));
    out.push_back(std::move(cut));
  }
  return out;
}

/// Returns the first and the last coordinate of voxels on the axis whose closed extent may intersect the polygon. Both
/// are clipped to the window.
std::array<std::int64_t, 2> slab_range(const Polygon& polygon, int axis, const Window& window) {
  auto [low, high] = std::minmax_element(polygon.begin(), polygon.end(),
                                         [axis](const auto& a, const auto& b) { return a[axis] < b[axis]; });
  const auto floor_of = [](const mpq_class& q) {
    mpz_class f;
    mpz_fdiv_q(f.get_mpz_t(), q.get_num_mpz_t(), q.get_den_mpz_t());
    return std::int64_t(f.get_si());
  };
  const std::int64_t first = floor_div(floor_of((*low)[axis]) - 1, voxel_edge);
  const std::int64_t last = floor_div(floor_of((*high)[axis]) + 1, voxel_edge);
  return {std::max(first, window.min[axis]), std::min(last, window.min[axis] + window.edge - 1)};
}

void split(const Polygon& polygon, int axis, Voxel& voxel, const Window& window, std::vector<Piece>& out) {
  if (axis == 3) {
    out.push_back({voxel, polygon});
    return;
  }
  const auto [first, last] = slab_range(polygon, axis, window);
  for (std::int64_t i = first; i <= last; ++i) {
    Polygon slab = clip(polygon, axis, mpq_class(big(i * voxel_edge)), +1);
    if (!slab.empty()) slab = clip(slab, axis, mpq_class(big((i + 1) * voxel_edge)), -1);
    if (slab.empty()) continue;
    voxel[axis] = i;
    split(slab, axis + 1, voxel, window, out);
  }
}

Polygon polygon_of(const Triangle& t) {
  Polygon p(3);
  for (int k = 0; k < 3; ++k)
    for (int r = 0; r < 3; ++r) p[k][r] = mpq_class(big(t[k][r]));
  return p;
}

/// Returns twice the signed area of (a, b, p) projected along the axis.
mpz_class edge_function(const LatticeVertex& a, const LatticeVertex& b, const LatticeVertex& p, int axis) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  return big(b[u] - a[u]) * big(p[v] - a[v]) - big(b[v] - a[v]) * big(p[u] - a[u]);
}

bool column_hits(const Triangle& t, const LatticeVertex& centre, int axis) {
  int negative = 0, positive = 0;
  for (int k = 0; k < 3; ++k) {
    const int s = sgn(edge_function(t[k], t[(k + 1) % 3], centre, axis));
    negative += s < 0;
    positive += s > 0;
  }
  return negative == 0 || positive == 0;
}

int max_axis(const std::array<mpz_class, 3>& n) {
  int w = 0;
  for (int r = 1; r < 3; ++r)
    if (abs(n[r]) > abs(n[w])) w = r;
  return w;
}

/// Returns |n| / |n[w]|, where w is the largest axis: between 1 and √3.
double secant(const std::array<mpz_class, 3>& n) {
  const int w = max_axis(n);
  double sum = 0;
  for (int r = 0; r < 3; ++r) {
    const double ratio = mpq_class(mpq_class(n[r]) / mpq_class(n[w])).get_d();
    sum += ratio * ratio;
  }
  return std::sqrt(sum);
}

}  // namespace

std::array<mpz_class, 3> normal_of(const Triangle& t) {
  std::array<mpz_class, 3> n;
  for (int axis = 0; axis < 3; ++axis) n[axis] = edge_function(t[0], t[1], t[2], axis);
  return n;
}

bool has_area(const Triangle& t) {
  const auto n = normal_of(t);
  return n[0] != 0 || n[1] != 0 || n[2] != 0;
}

std::vector<Piece> pieces_in(const Triangle& t, const Window& window) {
  std::vector<Piece> out;
  Voxel voxel{};
  split(polygon_of(t), 0, voxel, window, out);
  return out;
}

RationalPoint area_vector(const Polygon& polygon) {
  RationalPoint sum;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    for (int r = 0; r < 3; ++r) {
      const int u = (r + 1) % 3, v = (r + 2) % 3;
      const auto &o = polygon[0], &a = polygon[i], &b = polygon[i + 1];
      sum[r] += (a[u] - o[u]) * (b[v] - o[v]) - (a[v] - o[v]) * (b[u] - o[u]);
    }
  return sum;
}

bool has_area_in_voxel(const Piece& piece) {
  const RationalPoint area = area_vector(piece.polygon);
  if (area[0] == 0 && area[1] == 0 && area[2] == 0) return false;
  for (int r = 0; r < 3; ++r) {
    const mpq_class upper(big((piece.voxel[r] + 1) * voxel_edge));
    if (std::all_of(piece.polygon.begin(), piece.polygon.end(), [&](const auto& p) { return p[r] == upper; }))
      return false;
  }
  return true;
}

bool crosses_centre_segment(const Triangle& t, const Voxel& voxel) {
  const auto n = normal_of(t);
  const LatticeVertex centre = voxel * voxel_edge + LatticeVertex::all(voxel_edge / 2);
  for (int axis = 0; axis < 3; ++axis) {
    if (n[axis] == 0 || !column_hits(t, centre, axis)) continue;
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    // Solve n·(p - v0) = 0 for p[axis], where v0 = t[0], and compare the exact result with the segment's ends.
    mpq_class crossing(n[u] * big(t[0][u] - centre[u]) + n[v] * big(t[0][v] - centre[v]), n[axis]);
    crossing.canonicalize();
    crossing += mpq_class(big(t[0][axis]));
    const mpq_class low(big(voxel[axis] * voxel_edge)), high(big((voxel[axis] + 1) * voxel_edge));
    if (crossing >= low && crossing < high) return true;
  }
  return false;
}

std::set<Voxel> occupied(const Triangle& t, SurfaceRule rule, const Window& window) {
  return occupied(t, pieces_in(t, window), rule);
}

std::set<Voxel> occupied(const Triangle& t, const std::vector<Piece>& pieces, SurfaceRule rule) {
  std::set<Voxel> out;
  if (!has_area(t)) return out;
  for (const Piece& piece : pieces) {
    const bool hit = rule == SurfaceRule::conservative || (rule == SurfaceRule::area && has_area_in_voxel(piece)) ||
                     (rule == SurfaceRule::thin && crosses_centre_segment(t, piece.voxel));
    if (hit) out.insert(piece.voxel);
  }
  return out;
}

double area_voxel2(const Triangle& t) {
  const auto n = normal_of(t);
  return std::abs(n[max_axis(n)].get_d()) * secant(n) / 2 / (voxel_edge * voxel_edge);
}

double area_voxel2(const Piece& piece, const Triangle& t) {
  const auto n = normal_of(t);
  return std::abs(area_vector(piece.polygon)[max_axis(n)].get_d()) * secant(n) / 2 / (voxel_edge * voxel_edge);
}

std::array<mpq_class, 3> centroid_barycentric(const Piece& piece, const Triangle& t) {
  const auto n = normal_of(t);
  const int w = max_axis(n), u = (w + 1) % 3, v = (w + 2) % 3;
  const Polygon& p = piece.polygon;
  mpq_class area, cu, cv;
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    const mpq_class twice =
        (p[i][u] - p[0][u]) * (p[i + 1][v] - p[0][v]) - (p[i][v] - p[0][v]) * (p[i + 1][u] - p[0][u]);
    area += twice;
    cu += twice * (p[0][u] + p[i][u] + p[i + 1][u]) / 3;
    cv += twice * (p[0][v] + p[i][v] + p[i + 1][v]) / 3;
  }
  cu /= area;
  cv /= area;
  std::array<mpq_class, 3> weights;
  for (int k = 0; k < 3; ++k) {
    const LatticeVertex &a = t[(k + 1) % 3], &b = t[(k + 2) % 3];
    weights[k] = ((cv - mpq_class(big(a[v]))) * mpq_class(big(b[u] - a[u])) -
                  (cu - mpq_class(big(a[u]))) * mpq_class(big(b[v] - a[v]))) /
                 mpq_class(n[w]);
  }
  return weights;
}

}  // namespace gigabake::reference
