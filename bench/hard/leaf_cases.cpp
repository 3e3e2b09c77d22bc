#include <algorithm>
#include <cmath>

#include "bench/hard/hard_case.h"
#include "core/octree/plane.h"

namespace gigabake::bench {
namespace {

using reference::Direction;
using reference::LatticeVertex;
using reference::Triangle;
using reference::Voxel;

/// A triangle whose voxels have level `lod`. Its coordinates are sub-voxels of level 0 and multiples of 2^lod.
struct LeveledTriangle {
  Triangle triangle;
  int lod = 0;
};
using LeveledTriangles = std::vector<LeveledTriangle>;

Triangle at_level(const Triangle& t, int lod) { return {t[0] >> lod, t[1] >> lod, t[2] >> lod}; }
reference::Window at_level(const reference::Window& w, int lod) { return {w.min >> lod, w.edge >> lod}; }

/// Returns the bricks of each level that are refined (docs/voxels.md, "Sources of several voxel sizes"). A triangle of
/// that level or of a finer level occupies a voxel of such a brick.
std::vector<std::set<Voxel>> refined_bricks(const LeveledTriangles& triangles, SurfaceRule rule,
                                            const reference::Window& window, int coarsest) {
  std::vector<std::set<Voxel>> refined(std::size_t(coarsest) + 1);
  for (const LeveledTriangle& t : triangles)
    for (const Voxel& v : reference::occupied(at_level(t.triangle, t.lod), rule, at_level(window, t.lod)))
      for (int lod = t.lod; lod <= coarsest; ++lod) refined[std::size_t(lod)].insert(v >> (3 + lod - t.lod));
  return refined;
}

/// Returns the voxels of level 0 and the leaves of each coarser level, by exact clipping on the lattice of each level.
std::vector<ExpectedVoxels> expected_levels(const LeveledTriangles& triangles, SurfaceRule rule,
                                            const reference::Window& window) {
  int coarsest = 0;
  for (const LeveledTriangle& t : triangles) coarsest = std::max(coarsest, t.lod);
  const std::vector<std::set<Voxel>> refined = refined_bricks(triangles, rule, window, coarsest);
  std::vector<ExpectedVoxels> out(std::size_t(coarsest) + 1);
  for (int lod = 0; lod <= coarsest; ++lod) {
    std::vector<reference::Painted> surface;
    for (const LeveledTriangle& t : triangles)
      if (t.lod >= lod) surface.push_back({at_level(t.triangle, lod), reference::white16, AlphaMode::opaque, {}});
    for (auto& [voxel, what] : reference::expected_voxels(surface, rule, at_level(window, lod)))
      if (refined[std::size_t(lod)].contains(voxel >> 3) &&
          (lod == 0 || !refined[std::size_t(lod) - 1].contains(voxel >> 2)))
        out[std::size_t(lod)].emplace(voxel, what);
  }
  return out;
}

HardCase leaf_case(std::string name, std::string what, const LeveledTriangles& triangles, std::int64_t edge,
                   SurfaceRule rule = SurfaceRule::area) {
  HardCase hard = lattice_case(std::move(name), "leaves", std::move(what));
  hard.window = {{-edge / 2, -edge / 2, -edge / 2}, edge};
  hard.parameters.surface = rule;
  std::vector<HardTile> tiles(3);
  for (const LeveledTriangle& t : triangles) {
    tiles[std::size_t(t.lod)].lod = t.lod;
    add_triangle(tiles[std::size_t(t.lod)], t.triangle, lattice_unit_m);
  }
  std::erase_if(tiles, [](const HardTile& tile) { return tile.nodes.empty(); });
  hard.scenes[0].tiles = std::move(tiles);
  hard.expected_levels = [triangles, rule, window = hard.window] { return expected_levels(triangles, rule, window); };
  return hard;
}

/// Returns the triangle in a voxel of level `lod`, off its centre.
LeveledTriangle in_voxel(const Voxel& voxel, int lod) {
  const LatticeVertex corner = voxel * 256;
  const auto at = [&](std::int64_t x, std::int64_t y, std::int64_t z) {
    return (corner + LatticeVertex{x, y, z}) * (std::int64_t(1) << lod);
  };
  return {{at(40, 60, 80), at(200, 90, 70), at(90, 210, 190)}, lod};
}

/// Returns the 26 directions from a brick to its neighbours: across faces, edges and corners.
std::vector<Voxel> directions() {
  std::vector<Voxel> out;
  for (std::int64_t i = 0; i < 27; ++i)
    if (i != 13) out.push_back({i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1});
  return out;
}

std::string text_of(const Voxel& direction) {
  std::string text;
  for (std::size_t k = 0; k < 3; ++k)
    if (direction[k] != 0) text += std::string(direction[k] < 0 ? "-" : "+") + "xyz"[k];
  return text;
}

/// Returns a vector at a right angle to a direction, with components -1, 0 and 1.
Voxel across(const Voxel& d) {
  Voxel u{};
  std::size_t first = 0;
  while (d[first] == 0) ++first;
  std::size_t second = first + 1;
  while (second < 3 && d[second] == 0) ++second;
  if (second == 3) {
    u[(first + 1) % 3] = 1;
  } else {
    u[first] = d[second];
    u[second] = -d[first];
  }
  return u;
}

/// Returns triangles on both sides of a brick's face, edge or corner in direction `d`. A fine one lies in the brick, a
/// coarse one in the neighbour, and two coarse ones pass through the middle of the face, edge or corner. The plane of
/// one of these contains `d`, so it lies in a lattice plane or meets lattice edges and corners.
LeveledTriangles on_both_sides(const Voxel& d) {
  const auto by_direction = [&](std::int64_t if_negative, std::int64_t if_zero, std::int64_t if_positive) {
    return Voxel::by_axis([&](std::size_t k) { return d[k] < 0 ? if_negative : (d[k] == 0 ? if_zero : if_positive); });
  };
  const LatticeVertex middle = by_direction(0, 1024, 0), u = across(d), aslant{60, -140, 260};
  const Triangle along{middle + d * 1000 + u * 500, middle + d * 1000 - u * 500, middle - d * 1000},
      oblique{middle + d * 1000 + u * 400 + aslant, middle + d * 1000 - u * 400 + aslant, middle - d * 1000 - aslant};
  return {in_voxel(by_direction(0, 4, -1), 0), in_voxel(by_direction(-1, 2, 0), 1), {along, 1}, {oblique, 1}};
}

std::vector<HardCase> neighbours() {
  std::vector<HardCase> out;
  for (const Voxel& d : directions())
    out.push_back(leaf_case(
        "leaf-across-" + text_of(d),
        "leaves of level 1 next to voxels of level 0 in direction " + text_of(d) + "; exact clipping on both lattices",
        on_both_sides(d), 16));
  return out;
}

/// Returns cases of three levels that meet at a corner of bricks.
std::vector<HardCase> three_levels() {
  std::vector<HardCase> out;
  const LeveledTriangle slope{{{{-3600, -3600, -2800}, {3600, -3200, 400}, {-400, 3600, 3200}}}, 2},
      corners{{{{3072, -3072, 0}, {0, 3072, -3072}, {-3072, 0, 3072}}}, 2};
  for (const Voxel& d : directions()) {
    if (d[0] * d[1] * d[2] == 0) continue;
    const LeveledTriangle between{{d * 2600 + LatticeVertex{100, -300, 200}, d * 600 + LatticeVertex{-400, 500, -300},
                                   d * 1800 + LatticeVertex{300, 200, -900}},
                                  1};
    out.push_back(leaf_case("three-levels-" + text_of(d), "levels 0, 1 and 2 around a corner; exact clipping on each",
                            {in_voxel((d - Voxel{1, 1, 1}) >> 1, 0), between, slope, corners}, 32));
  }
  return out;
}

/// Returns cases in which a fine triangle lies in the plane between two bricks. The triangle occupies, and so refines,
/// the brick above by area, and both bricks by contact.
std::vector<HardCase> ties_of_refinement() {
  std::vector<HardCase> out;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const SurfaceRule rule : {SurfaceRule::area, SurfaceRule::conservative}) {
      LeveledTriangle fine{{{{0, 100, 120}, {0, 420, 150}, {0, 200, 510}}}, 0};
      Voxel d{};
      d[axis] = 1;
      for (LatticeVertex& v : fine.triangle)
        for (std::size_t turn = 0; turn < axis; ++turn) v = {v[2], v[0], v[1]};
      LeveledTriangles triangles = on_both_sides(d);
      triangles[0] = fine;
      out.push_back(leaf_case(std::string("leaf-refined-in-plane-") + "xyz"[axis] + "." + std::string(name_of(rule)),
                              "a fine triangle in the plane between two bricks; exact clipping on both lattices",
                              triangles, 16, rule));
    }
  return out;
}

/// Returns the signed distance from a voxel's centre to its stored plane along its stored normal, in voxels.
double stored_distance(const StoredVoxel& voxel) {
  const Direction n(octahedron_point(voxel.normal.data()).c);
  return unpack_plane(voxel.plane).offset / (2.0 * max_offset) * 127 / length(n);
}

/// Measures the planes of the leaves, all of one triangle.
std::vector<HardFigure> plane_figures(const LeveledTriangle& t, const HardBake& bake) {
  const auto exact = reference::normal_of(t.triangle);
  const Direction n{exact[0].get_d(), exact[1].get_d(), exact[2].get_d()};
  double error = 0, without = 0;
  for (const auto& [at, leaf] : bake.leaves.at(std::size_t(t.lod) - 1)) {
    if (!is_fully_planar(leaf.plane)) {
      ++without;
      continue;
    }
    const Direction centre = (Direction(at) + Direction{0.5, 0.5, 0.5}) * double(256 << t.lod);
    const double distance = dot(n, Direction(t.triangle[0]) - centre) / length(n) / (256 << t.lod);
    error = std::max(error, std::abs(stored_distance(leaf) - distance));
  }
  // Half a step of the offset along the normal, the rounding of a distance, and 0.96° of the normal at a corner.
  constexpr double bound = 0.062 + 0.004 + 0.015;
  return {{"without a plane", "leaves", without, 0}, {"plane", "voxels", error, bound}};
}

std::vector<HardCase> planes() {
  struct Plane {
    const char *name, *what;
    Triangle triangle;
  };
  const Plane table[] = {
      {"corners", "x + y + z = 0 meets corners", {{{1536, -1536, 0}, {0, 1536, -1536}, {-1536, 0, 1536}}}},
      {"edges", "x + y = 0 contains edges", {{{1536, -1536, -1536}, {1536, -1536, 1536}, {-1536, 1536, 0}}}},
      {"faces",
       "z = 0 contains faces, which belong to the voxels above",
       {{{1536, 1536, 0}, {-1536, 1536, 0}, {0, -1536, 0}}}},
      {"centres", "x + y + z = 1.5 meets centres", {{{1536, -1536, 768}, {768, 1536, -1536}, {-1536, 768, 1536}}}},
      {"skew-corners", "x + 2y + 3z = 0 meets corners", {{{1500, 0, -500}, {-1200, 600, 0}, {0, -900, 600}}}},
  };
  std::vector<HardCase> out;
  for (int lod = 1; lod <= 2; ++lod)
    for (const Plane& plane : table) {
      const std::int64_t scale = std::int64_t(1) << (lod - 1);
      LeveledTriangle t{plane.triangle, lod};
      for (LatticeVertex& v : t.triangle) v = v * scale;
      const std::int64_t edge = 16 * scale, corner = edge / 2 - 1;
      HardCase hard = leaf_case("leaf-plane-" + std::string(plane.name) + "." + std::to_string(lod),
                                std::string("the plane ") + plane.what + ", in voxels of level " + std::to_string(lod),
                                {t, in_voxel({corner, corner, corner}, 0)}, edge);
      hard.group = "planes of leaves";
      hard.more = [t](const HardBake& bake) { return plane_figures(t, bake); };
      out.push_back(std::move(hard));
    }
  return out;
}

}  // namespace

std::vector<HardCase> leaf_cases() {
  std::vector<HardCase> out = neighbours();
  for (auto& group : {three_levels(), ties_of_refinement(), planes()})
    out.insert(out.end(), group.begin(), group.end());
  return out;
}

}  // namespace gigabake::bench
