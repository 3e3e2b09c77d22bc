/// Closed surfaces separate inside from outside: no flood fill of empty voxels passes through them. The rule determines
/// the neighbours that the fill may use (docs/accuracy.md has the proofs).
#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>

#include "bake_scene.h"
#include "closed_meshes.h"
#include "core/base/rules.h"
#include "print.h"

namespace gigabake::reference {
namespace {

using namespace gigabake::kernels;

constexpr int edge = 32;

/// Steps of the flood: through faces only, or also through edges and corners.
constexpr int by_faces = 1, by_corners = 3;

int max_step(SurfaceRule rule, const std::vector<Triangle>& mesh) {
  if (rule == SurfaceRule::thin) return by_faces;
  return rule == SurfaceRule::conservative || !holds_lattice_corner(mesh) ? by_corners : by_faces;
}

std::size_t index_of(const Voxel& v) { return std::size_t(v[0] + edge * (v[1] + edge * v[2])); }

/// Returns the voxels of the window [0, 32)³ that a path of empty voxels connects with the window's border.
std::vector<bool> flooded(const std::set<Voxel>& occupied, int step) {
  std::vector<bool> wet(edge * edge * edge);
  std::vector<Voxel> front;
  const auto enter = [&](const Voxel& v) {
    if (wet[index_of(v)] || occupied.count(v)) return;
    wet[index_of(v)] = true;
    front.push_back(v);
  };
  const auto for_all = [](int low, int high, auto&& body) {
    for (int z = low; z < high; ++z)
      for (int y = low; y < high; ++y)
        for (int x = low; x < high; ++x) body(Voxel{x, y, z});
  };
  for_all(0, edge, [&](const Voxel& v) {
    if (std::min({v[0], v[1], v[2]}) == 0 || std::max({v[0], v[1], v[2]}) == edge - 1) enter(v);
  });
  while (!front.empty()) {
    const Voxel at = front.back();
    front.pop_back();
    for_all(-1, 2, [&](const Voxel& d) {
      if (std::abs(d[0]) + std::abs(d[1]) + std::abs(d[2]) > step) return;
      const Voxel v{at[0] + d[0], at[1] + d[1], at[2] + d[2]};
      if (std::min({v[0], v[1], v[2]}) >= 0 && std::max({v[0], v[1], v[2]}) < edge) enter(v);
    });
  }
  return wet;
}

std::vector<ClosedMesh> meshes(Rng& rng) {
  std::vector<ClosedMesh> out;
  const auto middle = [&] {
    return LatticeVertex{4096 + uniform(rng, -256, 256), 4096 + uniform(rng, -256, 256),
                         4096 + uniform(rng, -256, 256)};
  };
  const LatticeVertex on_lattice{4096, 4096, 4096}, on_centres{4096 + 128, 4096 + 128, 4096 + 128};
  for (const LatticeVertex& c : {on_lattice, on_centres, middle(), middle()}) {
    out.push_back(sphere(c, double(uniform(rng, 500, 2500)), 8));
    out.push_back(sphere(c, 8 * 256, 6));
    out.push_back(torus(c, 1900, double(uniform(rng, 500, 900)), 10));
    const std::int64_t a = uniform(rng, 300, 2500), b = uniform(rng, 300, 2500), h = uniform(rng, 300, 2500);
    out.push_back(box({c[0] - a, c[1] - b, c[2] - h}, {c[0] + b, c[1] + h, c[2] + a}));
    out.push_back(box({c[0] - 512, c[1] - 1024, c[2] - 768}, {c[0] + 512, c[1] + 256, c[2] + 768}));
  }
  for (int i = 0; i < 12; ++i) out.push_back(star(middle(), 600, 3300, 5 + i % 3, rng));
  for (const std::int64_t radius : {1024, 1100, 1280}) {
    out.push_back(octahedron(on_lattice, radius));
    out.push_back(octahedron(middle(), radius));
  }
  for (int i = 0; i < 40; ++i) {
    const std::int64_t step = i % 4 == 0 ? 256 : i % 4 == 1 ? 128 : 1;
    out.push_back(random_hull(i % 2 ? on_lattice : middle(), 3000, step, 4 + i % 6, rng));
  }
  return out;
}

std::set<Voxel> occupied_by(const std::vector<Triangle>& mesh, SurfaceRule rule) {
  BakeScene scene;
  scene.set_window({0, 0, 0}, edge);
  scene.parameters.surface = rule;
  scene.add_mesh(mesh);
  return positions_of(voxels_at(scene.bake(), scene.parameters, 0));
}

/// Counts of empty voxels inside of the mesh: all voxels, and flooded voxels.
struct Enclosed {
  int voxels = 0, wet = 0;
};

Enclosed enclosed_by(const std::vector<Triangle>& mesh, const std::set<Voxel>& occupied, const std::vector<bool>& wet) {
  Enclosed result;
  for (int i = 0; i < edge * edge * edge; ++i) {
    const Voxel v{i % edge, i / edge % edge, i / edge / edge};
    if (occupied.count(v)) continue;
    const double winding = winding_number(mesh, {v[0] * 256 + 128, v[1] * 256 + 128, v[2] * 256 + 128});
    EXPECT_NEAR(winding, std::round(winding), 1e-6);
    if (std::round(winding) == 0) continue;
    ++result.voxels;
    result.wet += wet[std::size_t(i)];
  }
  return result;
}

class ClosedSurface : public testing::TestWithParam<SurfaceRule> {};

TEST_P(ClosedSurface, IsNeverLeakedThroughByAFloodFillOfEmptyVoxels) {
  const std::uint64_t seed = 41;
  Rng rng(seed);
  int number = 0, enclosed = 0, floods_by_corners = 0;
  for (const ClosedMesh& mesh : meshes(rng)) {
    SCOPED_TRACE(mesh.name + " " + std::to_string(number++) + ", seed " + std::to_string(seed));
    ASSERT_GT(volume(mesh.triangles), 0);
    const std::set<Voxel> occupied = occupied_by(mesh.triangles, GetParam());
    const int step = max_step(GetParam(), mesh.triangles);
    const Enclosed inside = enclosed_by(mesh.triangles, occupied, flooded(occupied, step));
    ASSERT_EQ(inside.wet, 0);
    enclosed += inside.voxels;
    floods_by_corners += step == by_corners;
  }
  EXPECT_GT(enclosed, 10000) << "the test should see many enclosed voxels";
  if (GetParam() != SurfaceRule::thin) {
    EXPECT_GE(floods_by_corners, 20);
  }
}

TEST(AreaRule, LeaksThroughEdgesAndCornersOnlyWhereTheLatticeLiesInTheSurface) {
  const auto leaks = [](const ClosedMesh& mesh) {
    const std::set<Voxel> occupied = occupied_by(mesh.triangles, SurfaceRule::area);
    return enclosed_by(mesh.triangles, occupied, flooded(occupied, by_corners)).wet > 0;
  };
  EXPECT_TRUE(leaks(octahedron({4096, 4096, 4096}, 1024))) << "its faces pass through corners of the lattice";
  EXPECT_FALSE(leaks(octahedron({4096, 4096, 4096}, 1025))) << "one sub-voxel farther out they pass none";
}

INSTANTIATE_TEST_SUITE_P(Rule, ClosedSurface,
                         testing::Values(SurfaceRule::area, SurfaceRule::conservative, SurfaceRule::thin),
                         [](const auto& row) { return std::string(name_of(row.param)); });

}  // namespace
}  // namespace gigabake::reference
