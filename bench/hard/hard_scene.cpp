#include "bench/hard/hard_scene.h"

#include <algorithm>
#include <cstdlib>

namespace gigabake::bench {
namespace {

using reference::Triangle;

bool fits_floats(const Triangle& t) {
  constexpr std::int64_t float_exact = std::int64_t(1) << 24;
  for (int k = 1; k < 3; ++k)
    for (const std::int64_t distance : t[k] - t[0])
      if (std::abs(distance) >= float_exact) return false;
  return true;
}

HardMesh mesh_of(const std::vector<Triangle>& triangles, const reference::LatticeVertex& origin) {
  HardMesh mesh;
  for (const Triangle& t : triangles)
    for (const reference::LatticeVertex& v : t) {
      mesh.index.push_back(std::uint32_t(mesh.index.size()));
      const auto p = Vec3<float>(v - origin);
      mesh.position.insert(mesh.position.end(), p.begin(), p.end());
    }
  return mesh;
}

Affine<Local, Local> from_units(double unit_m, const reference::LatticeVertex& origin) {
  Affine<Local, Local> map = scaled(unit_m, unit_m, unit_m);
  for (std::size_t r = 0; r < 3; ++r) map.m[r][3] = double(origin[r]) * unit_m;
  return map;
}

void add(HardTile& tile, HardMesh mesh, const Affine<Local, Local>& map, int material) {
  mesh.material = material;
  tile.nodes.push_back({int(tile.meshes.size()), map});
  tile.meshes.push_back(std::move(mesh));
}

/// Adds a triangle whose vertices in the mesh are unit vectors. The node's matrix maps these vectors to the triangle's
/// corners, so the corners are stored exactly as integers in double. The origin lies behind the triangle, so that the
/// matrix does not mirror.
void add_wide(HardTile& tile, const Triangle& t, double unit_m, int material) {
  const auto n = reference::normal_of(t);
  std::size_t w = 0;
  for (std::size_t r = 1; r < 3; ++r)
    if (abs(n[r]) > abs(n[w])) w = r;
  reference::LatticeVertex origin = t[0];
  origin[w] -= sgn(n[w]) * (std::int64_t(1) << 30);
  Affine<Local, Local> map = from_units(unit_m, origin);
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t r = 0; r < 3; ++r) map.m[r][k] = double(t[k][r] - origin[r]) * unit_m;
  HardMesh mesh;
  mesh.position = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  mesh.index = {0, 1, 2};
  add(tile, std::move(mesh), map, material);
}

}  // namespace

Affine<Local, Local> scaled(double x, double y, double z) {
  Affine<Local, Local> map;
  map.m = {{{x, 0, 0, 0}, {0, y, 0, 0}, {0, 0, z, 0}}};
  return map;
}

void add_triangle(HardTile& tile, const Triangle& t, double unit_m, int material) {
  if (fits_floats(t))
    add(tile, mesh_of({t}, t[0]), from_units(unit_m, t[0]), material);
  else
    add_wide(tile, t, unit_m, material);
}

void add_mesh(HardTile& tile, const std::vector<Triangle>& mesh, double unit_m, int material) {
  add(tile, mesh_of(mesh, {}), from_units(unit_m, {}), material);
}

void add_painted(HardTile& tile, const reference::Painted& painted, double unit_m) {
  tile.materials.push_back({painted.colour, painted.mode, -1});
  add_triangle(tile, painted.triangle, unit_m, int(tile.materials.size()) - 1);
  if (painted.vertex_colours)
    for (const reference::Rgba16& colour : *painted.vertex_colours)
      tile.meshes.back().rgba.insert(tile.meshes.back().rgba.end(), colour.begin(), colour.end());
}

}  // namespace gigabake::bench
