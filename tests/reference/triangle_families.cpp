#include "triangle_families.h"

#include <utility>

namespace gigabake::reference {
namespace {

constexpr std::int64_t half = 128, voxel_edge = 256, million_voxels = 1'000'000 * voxel_edge;

LatticeVertex vertex_near(const LatticeVertex& c, std::int64_t reach, Rng& rng, std::int64_t step = 1) {
  return LatticeVertex::by_axis([&](int r) { return c[r] + step * uniform(rng, -reach / step, reach / step); });
}

Triangle near(const LatticeVertex& c, std::int64_t reach, Rng& rng, std::int64_t step = 1) {
  return {vertex_near(c, reach, rng, step), vertex_near(c, reach, rng, step), vertex_near(c, reach, rng, step)};
}

/// Returns a tiny triangle near a voxel corner c: around c itself, or around a random point within a voxel of c.
Triangle tiny(const LatticeVertex& c, Rng& rng) {
  const LatticeVertex middle = uniform(rng, 0, 1) ? c : vertex_near(c, voxel_edge, rng);
  return near(middle, uniform(rng, 1, 60), rng);
}

Triangle sliver(const LatticeVertex& c, Rng& rng) {
  const LatticeVertex a = vertex_near(c, 2 * voxel_edge, rng), b = vertex_near(c, 2 * voxel_edge, rng);
  return {a, b, vertex_near(uniform(rng, 0, 1) ? a : (a + b) / 2, uniform(rng, 1, 3), rng)};
}

Triangle flat(const LatticeVertex& c, Rng& rng, std::int64_t step) {
  Triangle t = near(c, 2 * voxel_edge, rng);
  const int axis = int(uniform(rng, 0, 2));
  const std::int64_t plane = c[axis] + step * uniform(rng, -2, 2);
  for (auto& v : t) v[axis] = plane;
  return t;
}

Triangle edge_through(const LatticeVertex& c, Rng& rng) {
  const LatticeVertex d = vertex_near({0, 0, 0}, 100, rng);
  const std::int64_t back = uniform(rng, 0, 3), forth = uniform(rng, 1, 3);
  return {c - d * back, c + d * forth, vertex_near(c, 2 * voxel_edge, rng)};
}

/// Returns a triangle whose vertices are moved along one axis into a plane through the corner c. If the axis is z, the
/// plane is a·x + b·y + z = const.
Triangle diagonal(const LatticeVertex& c, Rng& rng) {
  const std::int64_t a = uniform(rng, -2, 2), b = uniform(rng, -2, 2);
  Triangle t = near(c, 2 * voxel_edge, rng);
  const int turn = int(uniform(rng, 0, 2));
  for (auto& v : t) {
    const int x = turn, y = (turn + 1) % 3, z = (turn + 2) % 3;
    v[z] = c[z] - a * (v[x] - c[x]) - b * (v[y] - c[y]);
  }
  return t;
}

/// Returns a huge triangle that is shifted so that a random weighted mean of its vertices lies at c.
Triangle large(const LatticeVertex& c, Rng& rng, std::int64_t step) {
  Triangle t = near({0, 0, 0}, million_voxels / 2, rng, step);
  std::int64_t w[3] = {uniform(rng, 0, 8), uniform(rng, 0, 8), uniform(rng, 0, 8)};
  if (w[0] + w[1] + w[2] == 0) w[0] = 1;
  const LatticeVertex point = (t[0] * w[0] + t[1] * w[1] + t[2] * w[2]) / (w[0] + w[1] + w[2]);
  for (auto& v : t) v += c - point / step * step;
  return t;
}

Triangle candidate(Family family, const LatticeVertex& c, Rng& rng) {
  switch (family) {
    case Family::tiny:
      return tiny(c, rng);
    case Family::small:
      return near(c, voxel_edge, rng);
    case Family::sliver:
      return sliver(c, rng);
    case Family::lattice_vertices:
      return near(c, 2 * voxel_edge, rng, voxel_edge);
    case Family::half_voxel_ties:
      return near(c, 3 * half, rng, half);
    case Family::axis_parallel:
      return flat(c, rng, 37);
    case Family::in_lattice_plane:
      return flat(c, rng, voxel_edge);
    case Family::edge_through_corner:
      return edge_through(c, rng);
    case Family::diagonal_plane:
      return diagonal(c, rng);
    case Family::large:
      return large(c, rng, 1);
    case Family::large_lattice:
      return large(c, rng, voxel_edge);
  }
  return {};
}

}  // namespace

const char* name_of(Family family) {
  switch (family) {
    case Family::tiny:
      return "tiny";
    case Family::small:
      return "small";
    case Family::sliver:
      return "sliver";
    case Family::lattice_vertices:
      return "lattice_vertices";
    case Family::half_voxel_ties:
      return "half_voxel_ties";
    case Family::axis_parallel:
      return "axis_parallel";
    case Family::in_lattice_plane:
      return "in_lattice_plane";
    case Family::edge_through_corner:
      return "edge_through_corner";
    case Family::diagonal_plane:
      return "diagonal_plane";
    case Family::large:
      return "large";
    case Family::large_lattice:
      return "large_lattice";
  }
  return "";
}

Triangle random_triangle(Family family, const Window& window, Rng& rng) {
  const LatticeVertex corner = (window.min + Voxel::all(window.edge / 2)) * voxel_edge;
  for (;;) {
    const Triangle t = candidate(family, corner, rng);
    if (has_area(t)) return t;
  }
}

std::int64_t uniform(Rng& rng, std::int64_t low, std::int64_t high) {
  return std::uniform_int_distribution<std::int64_t>(low, high)(rng);
}

}  // namespace gigabake::reference
