#include <cmath>
#include <random>

#include "bench/hard/exact_place.h"
#include "bench/hard/hard_case.h"

namespace gigabake::bench {
namespace {

using Rng = std::mt19937_64;

constexpr double voxel_m = 0.01;
/// The minimum distance of vertices from rounding ties, in sub-voxels. It is a hundred times the bound of the placement
/// error, so that long double and double snap to the same vertex.
constexpr long double tie_margin = 0.03L;

Affine<World, World> rounded(const LongAffine& map) {
  Affine<World, World> out;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 4; ++c) out.m[r][c] = double(map.m[r][c]);
  return out;
}

double between(Rng& rng, double low, double high) { return low + (high - low) * double(rng() >> 11) * 0x1p-53; }

bool keeps_away_from_ties(const LongPoint& p_lattice) {
  for (const long double x : p_lattice) {
    const long double fraction = x + 0.5L - floorl(x + 0.5L);
    if (fraction < tie_margin || fraction > 1 - tie_margin) return false;
  }
  return true;
}

LongAffine placement_of(const HardScene& scene, const Geodetic& origin, std::size_t tile) {
  return exact_placements(scene, origin)[tile];
}

/// Adds small triangles around the tile's own origin, all in one mesh.
void add_triangles(HardScene& scene, std::size_t tile, const Geodetic& origin, const BakeParameters& parameters,
                   int count, Rng& rng) {
  HardTile& t = scene.tiles[tile];
  t.meshes.resize(1);
  t.nodes = {HardNode()};
  const LongAffine placement = placement_of(scene, origin, tile);
  HardMesh& mesh = t.meshes[0];
  while (int(mesh.index.size()) < 3 * count) {
    double middle[3];
    for (double& m : middle) m = between(rng, -0.2, 0.2);
    float corner[9];
    for (int i = 0; i < 9; ++i) corner[i] = float(middle[i % 3] + between(rng, -0.03, 0.03));
    bool usable = true;
    for (int k = 0; k < 3; ++k)
      usable &= keeps_away_from_ties(lattice_place(parameters, placement * LongPoint::from(corner + 3 * k)));
    if (!usable) continue;
    for (int k = 0; k < 3; ++k) mesh.index.push_back(std::uint32_t(mesh.index.size()));
    mesh.position.insert(mesh.position.end(), corner, corner + 9);
  }
}

/// Returns a window of 128 voxels around the tile's origin.
reference::Window window_about(const LongPoint& p_lattice) {
  const auto floored = reference::Voxel::by_axis([&](int r) { return std::int64_t(floorl(p_lattice[r])); });
  return {(floored >> 11 << 3) - reference::Voxel::all(64), 128};
}

/// Returns a case on the earth. `origin` is the origin of the scene frame. If `is_asked` is true, the option --origin
/// specifies it; otherwise it is the place of the first tile.
HardCase earth_case(const char* name, const char* what, const std::vector<Geodetic>& tiles, const Geodetic& origin,
                    bool is_asked) {
  Rng rng(20260511);
  HardCase hard = lattice_case(name, "earth", what);
  hard.parameters.voxel_size_m = voxel_m;
  hard.bounds.placement_m = 1e-8;
  HardScene scene;
  scene.on_earth = true;
  if (is_asked) scene.origin = origin;
  for (const Geodetic& place : tiles) scene.tiles.emplace_back().transform = rounded(ecef_from_enu_at(place));
  for (HardTile& tile : scene.tiles) tile.nodes = {HardNode()};
  for (std::size_t i = 0; i < tiles.size(); ++i)
    add_triangles(scene, i, origin, hard.parameters, 160 / int(tiles.size()), rng);
  hard.window = window_about(lattice_place(hard.parameters, placement_of(scene, origin, 0) * LongPoint{}));
  hard.scenes = {std::move(scene)};
  return hard;
}

/// Returns a case with a local scene far from its origin. The tile's transform contains the distance, so vertices have
/// small coordinates.
HardCase far_case() {
  Rng rng(20260512);
  HardCase hard = lattice_case("far-1000-km-local", "earth", "0.01 m voxels 1,000 km from a local scene's origin");
  hard.parameters.voxel_size_m = voxel_m;
  hard.bounds.placement_m = 1e-9;
  HardScene& scene = hard.scenes[0];
  scene.tiles[0].nodes = {HardNode()};
  scene.tiles[0].transform.m[0][3] = 1e6 + 0.123;
  scene.tiles[0].transform.m[1][3] = -1e6 - 0.456;
  scene.tiles[0].transform.m[2][3] = 3000.789;
  add_triangles(scene, 0, {}, hard.parameters, 160, rng);
  hard.window = window_about(lattice_place(hard.parameters, placement_of(scene, {}, 0) * LongPoint{}));
  return hard;
}

}  // namespace

std::vector<HardCase> earth_cases() {
  const Geodetic north{90, 0, 12}, south{-90, 0, 2800}, fiji{-16.8, 180, 30}, zurich{47.37, 8.54, 410};
  return {
      earth_case("ecef-north-pole", "two tiles that meet at the pole, ECEF; WGS84 in long double",
                 {{90, 0, 12}, {90 - 1e-6, 137, 12}}, north, true),
      earth_case("ecef-south-pole", "the same at the other pole", {{-90, 0, 2800}, {-90 + 1e-6, -42, 2800}}, south,
                 true),
      earth_case("ecef-antimeridian", "tiles 0.2 m to either side of 180°, ECEF; WGS84 in long double",
                 {{-16.8, 180 - 1e-6, 30}, {-16.8, -180 + 1e-6, 30}}, fiji, true),
      earth_case("ecef-own-origin", "the scene has the origin of its tileset; WGS84 in long double", {zurich}, zurich,
                 false),
      earth_case("far-1000-km-ecef", "0.01 m voxels 1,000 km from the scene's origin, ECEF; WGS84 in long double",
                 {zurich}, {56.36, 8.54, 0}, true),
      far_case(),
  };
}

}  // namespace gigabake::bench
