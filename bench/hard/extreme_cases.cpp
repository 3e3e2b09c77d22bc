#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "bench/hard/hard_case.h"
#include "format/job/tile_scan.h"
#include "kernels/body/voxelize/brick_triangle.h"

namespace gigabake::bench {
namespace {

using reference::LatticeVertex;
using reference::Painted;
using reference::Rgba16;
using reference::Triangle;

using Rng = std::mt19937_64;

/// A fixed seed, so that the suite is equal on every machine. std::uniform_int_distribution is not used because it
/// differs between libraries.
constexpr std::uint64_t seed = 20260511;
std::int64_t below(Rng& rng, std::int64_t end) { return std::int64_t(rng() % std::uint64_t(end)); }

Rgba16 any_colour(Rng& rng) {
  Rgba16 c;
  for (std::uint16_t& x : c) x = std::uint16_t(below(rng, 65536));
  c[3] = 65535;
  return c;
}

LatticeVertex any_vertex(Rng& rng, std::int64_t reach) {
  return {below(rng, 2 * reach) - reach, below(rng, 2 * reach) - reach, below(rng, 2 * reach) - reach};
}

HardScene scene_of(const std::vector<Painted>& painted) {
  HardScene scene;
  scene.tiles.resize(1);
  for (const Painted& p : painted) add_painted(scene.tiles[0], p, lattice_unit_m);
  return scene;
}

/// Returns one case per sliver. Small triangles cover about the same area of each voxel as the sliver, so that the
/// voxel's colour shows the sliver's weight.
std::vector<HardCase> slivers() {
  // The slivers are a little shorter than the maximum, and their coordinates need few bits.
  constexpr std::int64_t far = (max_side_voxels / 2 - 2048) * subvoxels;
  const std::pair<const char*, Triangle> shapes[] = {
      {"sliver-along-x", {{{-far, 100, 100}, {far, 100, 100}, {far, 101, 100}}}},
      {"sliver-on-lattice-edge", {{{-far, 0, 0}, {far, 0, 0}, {far, 1, 0}}}},
      {"sliver-on-diagonal", {{{-far, -far, -far}, {far, far, far}, {far, far, far + 1}}}},
      {"sliver-of-fibonacci", {{{0, 0, 100}, {267914296, 165580141, 100}, {165580141, 102334155, 100}}}}};
  std::vector<HardCase> out;
  for (const auto& [name, sliver] : shapes) {
    const bool is_fibonacci = sliver[0][0] == 0;
    HardCase hard =
        lattice_case(name, "extremes",
                     is_fibonacci ? "aspect 10^17, half a sub-voxel² over a million voxels; exact clipping"
                                  : "aspect 10^9, a sub-voxel wide, four million voxels long; exact clipping");
    std::vector<Painted> painted{{sliver, {65535, 20000, 0, 65535}, AlphaMode::opaque, {}}};
    for (std::int64_t i = -8; i < 8 && !is_fibonacci; ++i) {
      const std::int64_t x = 256 * i + 20, y = name == std::string("sliver-on-diagonal") ? x : 20;
      const std::int64_t z = name == std::string("sliver-on-diagonal") ? x : 20;
      painted.push_back(
          {{{{x, y, z}, {x + 11, y, z}, {x, y + 13, z + 1}}}, {0, 0, 65535, 65535}, AlphaMode::opaque, {}});
    }
    hard.scenes = {scene_of(painted)};
    out.push_back(std::move(hard));
  }
  return out;
}

/// Returns copies of the smallest triangle, half a sub-voxel².
HardMesh min_triangles(std::size_t count, const LatticeVertex& at, int material) {
  HardMesh mesh;
  const auto x = float(at[0]), y = float(at[1]), z = float(at[2]);
  mesh.position = {x, y, z, x + 1, y, z, x, y + 1, z};
  mesh.material = material;
  for (std::size_t i = 0; i < count; ++i) mesh.index.insert(mesh.index.end(), {0, 1, 2});
  return mesh;
}

/// Returns a case with millions of triangles, sorted by colour. A float sum, or a sum that saturates, would lose the
/// later triangles.
HardCase millions(int million) {
  HardCase hard = lattice_case("millions-in-one-voxel", "extremes",
                               std::to_string(million) + " million smallest triangles and one large; closed form");
  constexpr std::size_t a_million = 1000000;
  constexpr double large = 65536;  // area of the large triangle, in units of half a sub-voxel²
  const int of_colour[3] = {million - 2 * (million / 3), million / 3, million / 3};
  HardTile& tile = hard.scenes[0].tiles[0];
  const auto unit = scaled(lattice_unit_m, lattice_unit_m, lattice_unit_m);
  tile.materials = {{{65535, 0, 0, 65535}}, {{0, 65535, 0, 65535}}, {{0, 0, 65535, 65535}}};
  for (int c = 2; c >= 0; --c) {
    tile.meshes.push_back(min_triangles(a_million, {10 + 95 * c, 200 - 90 * c, 10}, c));
    for (int i = 0; i < of_colour[c]; ++i) tile.nodes.push_back({int(tile.meshes.size()) - 1, unit});
  }
  add_mesh(tile, {{{{0, 0, 100}, {256, 0, 100}, {0, 256, 100}}}}, lattice_unit_m, 1);
  hard.expected = [=] {
    const double m = a_million;
    reference::ExpectedVoxel v;
    v.area = v.visible = million * m + large;
    v.colour = {of_colour[0] * m, of_colour[1] * m + large, of_colour[2] * m};
    v.normal = {0, 0, v.area};
    return ExpectedVoxels{{{0, 0, 0}, v}};
  };
  return hard;
}

/// Returns a case with coplanar layers in random order. The first and the last layer must not have more weight than the
/// others.
HardCase coplanar_stack(const char* name, const char* what, const std::function<std::int64_t(std::int64_t)>& z_of) {
  Rng rng(seed);
  HardCase hard = lattice_case(name, "extremes", what);
  std::vector<Painted> layers;
  for (int i = 0; i < 96; ++i) {
    const std::int64_t x = below(rng, 300) - 300, y = below(rng, 300) - 300, end = 400 + below(rng, 300);
    Triangle t{{{x, y, z_of(x)}, {x + end, y, z_of(x + end)}, {x, y + end, z_of(x)}}};
    if (i % 3 == 0) std::swap(t[1], t[2]);
    Rgba16 colour = any_colour(rng);
    if (i % 4 == 0) colour[3] = std::uint16_t(20000 + below(rng, 40000));
    layers.push_back({t, colour, i % 4 == 0 ? AlphaMode::blend : AlphaMode::opaque, {}});
  }
  hard.scenes = {scene_of(layers)};
  for (int order = 0; order < 4; ++order) {
    for (std::size_t i = layers.size() - 1; i > 0; --i)
      std::swap(layers[i], layers[std::size_t(below(rng, std::int64_t(i) + 1))]);
    if (order == 0)
      std::sort(layers.begin(), layers.end(), [](const auto& a, const auto& b) { return a.colour < b.colour; });
    hard.scenes.push_back(scene_of(layers));
  }
  return hard;
}

/// Returns the same twelve triangles under a node that scales. Positions in the file are divided by the node's scale.
HardScene under_scale(double x, double y, double z) {
  Rng rng(seed);
  const double scale[3] = {x, y, z};
  HardScene scene;
  HardTile& tile = scene.tiles.emplace_back();
  for (int i = 0; i < 12; ++i) {
    tile.materials.push_back({any_colour(rng)});
    add_mesh(tile, {{any_vertex(rng, 1800), any_vertex(rng, 1800), any_vertex(rng, 1800)}}, lattice_unit_m, i + 1);
    for (std::size_t v = 0; v < 9; ++v) {
      float& p = tile.meshes.back().position[v];
      p = float(p * lattice_unit_m / scale[v % 3]);
    }
    tile.nodes.back().map = scaled(x, y, z);
  }
  return scene;
}

HardCase scaled_case(const char* name, const char* what, std::vector<HardScene> scenes) {
  HardCase hard = lattice_case(name, "extremes", what);
  hard.scenes = std::move(scenes);
  hard.bounds.placement_m = 1e-6;  // rounding error of the file's float positions, which are below 2 m
  return hard;
}

std::vector<HardCase> transforms() {
  const HardScene plain = under_scale(1, 1, 1);
  return {
      scaled_case("mirrored-once-or-thrice", "negative determinants keep the outside; exact clipping",
                  {under_scale(-1, 1, 1), under_scale(1, -1, 1), under_scale(1, 1, -1), under_scale(-1, -1, -1)}),
      scaled_case("mirrored-twice", "two mirrors are a turn; exact clipping",
                  {under_scale(-1, -1, 1), under_scale(-1, 1, -1), under_scale(1, -1, -1), plain}),
      scaled_case("scale-1e6", "positions of micrometres under a node that multiplies by 10^6; exact clipping",
                  {under_scale(1e6, 1e6, 1e6), plain}),
      scaled_case("scale-1e-6", "positions of thousands of kilometres under 10^-6; exact clipping",
                  {under_scale(1e-6, 1e-6, 1e-6), plain}),
      scaled_case("scale-mixed-and-mirrored", "10^6, -10^-6 and -1 in one node; exact clipping",
                  {under_scale(1e6, -1e-6, -1), plain}),
  };
}

}  // namespace

std::vector<HardCase> extreme_cases(int million_triangles) {
  std::vector<HardCase> all = slivers();
  all.push_back(millions(million_triangles));
  all.push_back(coplanar_stack("coplanar-stack", "96 layers in one plane inside a voxel, four other orders",
                               [](std::int64_t) { return 100; }));
  all.push_back(coplanar_stack("coplanar-stack-on-lattice", "96 layers in a lattice plane, four other orders",
                               [](std::int64_t) { return 256; }));
  all.push_back(coplanar_stack("coplanar-stack-oblique", "96 layers in the plane x = z, four other orders",
                               [](std::int64_t x) { return x; }));
  for (HardCase& hard : transforms()) all.push_back(std::move(hard));
  return all;
}

}  // namespace gigabake::bench
