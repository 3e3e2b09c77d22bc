#include "bench/accuracy/leaks/leak_scene.h"

#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <numbers>
#include <utility>

#include "bench/accuracy/leaks/sheet_mesh.h"
#include "sample/settlement/picture.h"
#include "sample/terrain/noise.h"

namespace gigabake::bench {
namespace {

constexpr double pane_alpha = 0.3;

double radians(double deg) { return deg * std::numbers::pi / 180; }

LeakScene scene_of(std::string name, std::string family, std::string what, sample::GlbMesh mesh, double alpha) {
  LeakScene scene;
  scene.name = std::move(name);
  scene.family = std::move(family);
  scene.what = std::move(what);
  sample::GlbMaterial material{"surface", -1, {0.5, 0.4, 0.3, alpha}, 0, true};
  material.blended = alpha < 1;
  scene.model.name = scene.name;
  scene.model.materials.push_back(material);
  scene.model.meshes.push_back(std::move(mesh));
  scene.sheet_alpha = alpha;
  scene.target = off_the_lattice;
  return scene;
}

LeakScene sheets_scene(std::string name, std::string family, std::string what, std::vector<Sheet> sheets,
                       double alpha = 1) {
  LeakScene scene = scene_of(std::move(name), std::move(family), std::move(what), mesh_of(sheets), alpha);
  scene.sheets = std::move(sheets);
  return scene;
}

/// The horizontal directions forward and left for an azimuth, which is measured from east to north.
struct Heading {
  Vec3d forward, left;
  explicit Heading(double azimuth_deg)
      : forward{std::cos(radians(azimuth_deg)), std::sin(radians(azimuth_deg)), 0}, left{-forward[1], forward[0], 0} {}
  Vec3d at(double forwards, double leftwards, double up) const {
    return off_the_lattice + forward * forwards + left * leftwards + Vec3d{0, 0, up};
  }
  Vec3d step(double forwards, double leftwards, double up) const {
    return at(forwards, leftwards, up) - off_the_lattice;
  }
};

Sheet square(double edge, double slope_deg, double azimuth_deg) {
  const Heading heading(azimuth_deg);
  const double level = edge * std::cos(radians(slope_deg)), down = -edge * std::sin(radians(slope_deg));
  return {heading.at(-level / 2, -edge / 2, -down / 2), heading.step(0, edge, 0), heading.step(level, 0, down)};
}

/// Returns the height of the hill: 0 at the border of the square, waves in the middle. `x` and `y` are 0 to 1.
double hill_height(double edge, double x, double y) {
  const double bump = 16 * x * (1 - x) * y * (1 - y);
  const double waves = 2 + std::sin(7 * x + 3 * y) + std::sin(17 * y - 5 * x + 1);
  return edge / 24 * bump * waves;
}

/// Returns the base, divided into quads² quads of two triangles, with a height above each vertex. x, y: 0 to 1.
sample::GlbMesh grid_mesh(const Sheet& base, std::uint32_t quads, const std::function<double(double, double)>& height) {
  sample::GlbMesh mesh;
  for (std::uint32_t j = 0; j <= quads; ++j)
    for (std::uint32_t i = 0; i <= quads; ++i) {
      const double x = double(i) / quads, y = double(j) / quads;
      add_vertex(mesh, base.corner + base.u * x + base.v * y + Vec3d{0, 0, height(x, y)});
    }
  for (std::uint32_t j = 0; j < quads; ++j)
    for (std::uint32_t i = 0; i < quads; ++i) {
      const std::uint32_t a = j * (quads + 1) + i, b = a + 1, c = a + quads + 1, d = c + 1;
      mesh.index.insert(mesh.index.end(), {a, b, d, a, d, c});
    }
  return mesh;
}

/// Adds the four long sides of a bar, without its ends. The sides are divided into pieces, because long triangles slow
/// down the search for the triangles that a ray hits.
void add_bar(const Vec3d& corner, const Vec3d& length, const Vec3d& v, const Vec3d& w, std::vector<Sheet>& bars) {
  constexpr int pieces = 32;
  const Vec3d u = length * (1.0 / pieces);
  for (int i = 0; i < pieces; ++i) {
    const Vec3d from = corner + u * i;
    bars.insert(bars.end(), {{from, u, v}, {from, u, w}, {from + w, u, v}, {from + v, u, w}});
  }
}

/// Returns a random point in the unit ball.
Vec3d in_ball(sample::Random& random) {
  for (;;) {
    const Vec3d p{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
    if (std::hypot(p[0], p[1], p[2]) <= 1) return p;
  }
}

/// A plane and its unit normal, with content in front of it. A ray that hits the plane must be opaque.
struct CoveredPlane {
  Sheet ground;
  Vec3d normal;
  CoveredPlane(double edge, double slope_deg)
      : ground(square(edge, slope_deg, 161.2)),
        normal(Heading(161.2).step(std::sin(radians(slope_deg)), 0, std::cos(radians(slope_deg)))) {}
  Sheet lifted(double height) const { return {ground.corner + normal * height, ground.u, ground.v}; }
};

/// Returns the texture of a plant: blades of different height (`upright`), or one round leaf.
sample::GlbImage plant_image(bool upright) {
  constexpr int edge = 32;
  sample::Picture image(edge, edge, 4);
  for (int y = 0; y < edge; ++y)
    for (int x = 0; x < edge; ++x) {
      const bool is_blade = x % 4 < 2 && edge - y < 8 + x * 37 % 24;
      const bool is_leaf = std::hypot(x - 15.5, y - 15.5) < 13;
      image.set(x, y, {60, 120, 30});
      image.at(x, y)[3] = (upright ? is_blade : is_leaf) ? 255 : 0;
    }
  return {"image/png", sample::to_png(image)};
}

/// Adds a quad with the whole texture.
void add_card(const Vec3d& corner, const Vec3d& u, const Vec3d& v, sample::GlbMesh& mesh) {
  add_sheet(mesh, {corner, u, v});
  mesh.uv.insert(mesh.uv.end(), {0, 65535, 65535, 65535, 0, 0, 65535, 0});
}

LeakScene covered_scene(const std::string& name, double slope_deg, const std::string& what, const CoveredPlane& plane,
                        sample::GlbMaterial material, sample::GlbMesh cover) {
  LeakScene scene = sheets_scene(fmt::format("{}-{:g}", name, slope_deg), "covered planes",
                                 fmt::format("{}, {:g}° steep", what, slope_deg), {plane.ground});
  scene.width = std::hypot(plane.ground.u[0], plane.ground.u[1], plane.ground.u[2]);
  cover.material = 1;
  scene.model.materials.push_back(std::move(material));
  scene.model.meshes.push_back(std::move(cover));
  return scene;
}

/// Returns the azimuth of the next scene. Successive azimuths differ by the golden angle, so none repeats and none is
/// parallel to an axis.
double next_azimuth(int& scenes) { return std::fmod(23.7 + 137.508 * scenes++, 360); }

}  // namespace

LeakScene plane_scene(double edge, double slope_deg, double azimuth_deg) {
  LeakScene scene = sheets_scene(fmt::format("plane-{:g}-at-{:.0f}", slope_deg, azimuth_deg), "planes",
                                 fmt::format("{:g}° steep, falls towards {:.0f}°", slope_deg, azimuth_deg),
                                 {square(edge, slope_deg, azimuth_deg)});
  scene.width = edge;
  return scene;
}

LeakScene hill_scene(double edge) {
  const Sheet base = square(edge, 0, 21.3);
  LeakScene scene = scene_of("hill", "hills", "waves on a bump, 131,072 triangles",
                             grid_mesh(base, 256, [edge](double x, double y) { return hill_height(edge, x, y); }), 1);
  scene.sheets = {base};
  scene.target[2] += hill_height(edge, 0.5, 0.5);
  scene.width = edge;
  return scene;
}

LeakScene steps_scene(const std::string& name, double edge, double tread, double rise) {
  const Heading heading(31.7);
  const int steps = int(edge / std::hypot(tread, rise));
  std::vector<Sheet> sheets;
  for (int i = 0; i < steps; ++i) {
    const double from = (i - 0.5 * steps) * tread, up = (i - 0.5 * steps) * rise;
    sheets.push_back({heading.at(from, -edge / 2, up), heading.step(0, edge, 0), heading.step(0, 0, rise)});
    sheets.push_back({heading.at(from, -edge / 2, up + rise), heading.step(0, edge, 0), heading.step(tread, 0, 0)});
  }
  LeakScene scene =
      sheets_scene(name, "steps", fmt::format("{} steps, {:g} deep, {:g} high", steps, tread, rise), sheets);
  scene.width = steps * std::hypot(tread, rise);
  return scene;
}

LeakScene wall_scene(const std::string& name, double edge, double thickness) {
  const Heading heading(38.9);
  const Vec3d length = heading.step(edge, 0, 0), up = heading.step(0, 0, edge / 2);
  std::vector<Sheet> sheets{{heading.at(-edge / 2, 0, -edge / 4), length, up}};
  if (thickness > 0)
    sheets = sides_of(heading.at(-edge / 2, -thickness / 2, -edge / 4), length, heading.step(0, thickness, 0), up);
  LeakScene scene = sheets_scene(
      name, "thin walls", thickness > 0 ? fmt::format("solid, {:g} thick", thickness) : "one upright layer", sheets);
  scene.width = edge / 2;
  return scene;
}

LeakScene house_scene(double edge) {
  const Heading heading(17.9);
  const double half = edge / 2, side = 0.35 * edge, low = -0.2 * edge, top = 0.1 * edge, ridge = 0.3 * edge;
  const double eaves = 0.04 * edge, eaves_up = top - eaves * (ridge - top) / side;
  const Vec3d up = heading.step(0, 0, top - low);
  std::vector<Sheet> sheets;
  for (const double s : {-1.0, 1.0}) {
    sheets.push_back({heading.at(-half, s * side, low), heading.step(edge, 0, 0), up});
    sheets.push_back({heading.at(s * half, -side, low), heading.step(0, 2 * side, 0), up});
    sheets.push_back({heading.at(s * half, -side, top), heading.step(0, 2 * side, 0),
                      heading.step(0, side, ridge - top), SheetShape::triangle});
    sheets.push_back({heading.at(-half - eaves, 0, ridge), heading.step(edge + 2 * eaves, 0, 0),
                      heading.step(0, s * (side + eaves), eaves_up - ridge)});
  }
  LeakScene scene = sheets_scene("house", "roofs over walls", "four walls, a saddle roof with eaves", sheets);
  scene.width = 2 * side;
  return scene;
}

LeakScene pane_scene(const std::string& name, double edge, double slope_deg, int layers) {
  constexpr double apart = 37.3;
  std::vector<Sheet> sheets;
  for (int i = 0; i < layers; ++i) {
    sheets.push_back(square(edge, slope_deg, 161.2));
    const Vec3d across = Heading(161.2).step(std::sin(radians(slope_deg)), 0, std::cos(radians(slope_deg)));
    sheets.back().corner += across * (apart * i);
  }
  LeakScene scene = sheets_scene(
      name, "panes", fmt::format("{} of alpha {:g}, {:g}° steep", layers, pane_alpha, slope_deg), sheets, pane_alpha);
  scene.width = edge;
  return scene;
}

LeakScene wires_scene(double edge) {
  constexpr double thick = 2.6, apart = 19.4;
  const Sheet whole = square(edge, 12, 57.1);
  const Vec3d up = Heading(57.1).step(thick * std::sin(radians(12)), 0, thick * std::cos(radians(12)));
  std::vector<Sheet> bars;
  for (double from = 0; from + thick <= edge; from += apart)
    for (const auto& [length, across] : {std::pair(whole.u, whole.v), std::pair(whole.v, whole.u)})
      add_bar(whole.corner + across * (from / edge), length, across * (thick / edge), up, bars);
  LeakScene scene = scene_of("wires", "wires", "square bars 2.6 thick and 19.4 apart, 12° steep", mesh_of(bars), 1);
  scene.reference_alpha = LeakReferenceKind::traced;
  scene.sheets = {whole};
  scene.width = edge;
  return scene;
}

LeakScene crown_scene(double edge) {
  constexpr double leaf = 12;
  sample::Random random(20261123);
  sample::GlbMesh mesh;
  const int leaves = int(2 * edge * edge / (leaf * leaf));
  for (int i = 0; i < leaves; ++i) {
    const Vec3d middle = off_the_lattice + in_ball(random) * (edge / 2);
    for (int k = 0; k < 3; ++k) add_vertex(mesh, middle + in_ball(random) * leaf);
    for (int k = 0; k < 3; ++k) mesh.index.push_back(std::uint32_t(mesh.index.size()));
  }
  LeakScene scene = scene_of("crown", "crowns", fmt::format("{} leaves in a ball", leaves), std::move(mesh), 1);
  scene.reference_alpha = LeakReferenceKind::traced;
  scene.width = edge / std::numbers::sqrt3;  // of the cube inside the ball
  const double half = scene.width / 2;
  const Vec3d corner = off_the_lattice - Vec3d::all(half);
  scene.sheets = sides_of(corner, {scene.width, 0, 0}, {0, scene.width, 0}, {0, 0, scene.width});
  return scene;
}

LeakScene plants_scene(double edge, double slope_deg, bool upright) {
  constexpr double card = 9;
  const CoveredPlane plane(edge, slope_deg);
  sample::Random random(20261126);
  sample::GlbMesh mesh;
  const int cards = int(edge * edge / (card * card));
  for (int i = 0; i < cards; ++i) {
    const Vec3d on_u = plane.ground.corner + plane.ground.u * random.between(0, 1);
    const Vec3d at = on_u + plane.ground.v * random.between(0, 1);
    const double turn = random.between(0, 2 * std::numbers::pi);
    const double cosine = card / edge * std::cos(turn), sine = card / edge * std::sin(turn);
    const Vec3d a = plane.ground.u * cosine + plane.ground.v * sine;
    const Vec3d b = plane.ground.v * cosine - plane.ground.u * sine;
    const Vec3d up = plane.normal * card;
    add_card(at + plane.normal * (upright ? 0 : random.between(0.05, 2)), a, upright ? up : b, mesh);
  }
  LeakScene scene =
      covered_scene(upright ? "grass" : "litter", slope_deg, fmt::format("{} alpha-tested cards on a plane", cards),
                    plane, {"plants", 0, {1, 1, 1, 1}, 0.5, true}, std::move(mesh));
  scene.model.images.push_back(plant_image(upright));
  return scene;
}

LeakScene layer_scene(double edge, double slope_deg, bool is_glass) {
  const CoveredPlane plane(edge, slope_deg);
  sample::GlbMaterial material{"layer", -1, {0.2, 0.5, 0.6, pane_alpha}, is_glass ? 0 : 0.5, true};
  material.blended = is_glass;
  return covered_scene(is_glass ? "glass" : "decal", slope_deg,
                       is_glass ? "translucent layer 0.2 voxels before a plane" : "decal that its mask cuts away",
                       plane, material, mesh_of({plane.lifted(0.2)}));
}

LeakScene mixed_winding(LeakScene scene) {
  sample::Random random(20261127);
  scene.name = "mixed-" + scene.name;
  if (scene.sheet_alpha == 1) scene.family = "mixed winding";  // translucent scenes stay in their family
  scene.what += ", half of the triangles wound the other way";
  for (sample::GlbMesh& mesh : scene.model.meshes)
    for (std::size_t i = 0; i < mesh.index.size(); i += 3)
      if (random.between(0, 1) < 0.5) std::swap(mesh.index[i], mesh.index[i + 1]);
  return scene;
}

/// Returns a plane of 32,768 triangles.
static LeakScene divided_plane_scene(double edge, double slope_deg) {
  LeakScene scene = plane_scene(edge, slope_deg, 298.7);
  scene.model.meshes = {grid_mesh(scene.sheets[0], 128, [](double, double) { return 0; })};
  return scene;
}

/// Returns the opaque scenes that are also measured with mixed winding: one or more of each family.
static std::vector<LeakScene> mixed_scenes(double edge) {
  std::vector<LeakScene> scenes;
  for (const double slope_deg : {3., 20., 45., 89.}) scenes.push_back(divided_plane_scene(edge, slope_deg));
  scenes.push_back(hill_scene(edge));
  scenes.push_back(steps_scene("small-steps", edge, 7.3, 5.1));
  scenes.push_back(steps_scene("large-steps", edge, 61.7, 43.9));
  scenes.push_back(wall_scene("wall-of-a-sheet", edge, 0));
  scenes.push_back(wall_scene("wall-0.3-thick", edge, 0.3));
  scenes.push_back(wall_scene("wall-1.6-thick", edge, 1.6));
  scenes.push_back(house_scene(edge));
  for (const bool first : {true, false}) {
    scenes.push_back(plants_scene(edge, 20, first));
    scenes.push_back(layer_scene(edge, 20, first));
  }
  return scenes;
}

std::vector<LeakScene> leak_scenes(double edge) {
  std::vector<LeakScene> scenes;
  int azimuths = 0;
  for (const double slope_deg : {0.5, 3., 10., 20., 45., 70., 89.})
    for (int i = 0; i < 3; ++i) scenes.push_back(plane_scene(edge, slope_deg, next_azimuth(azimuths)));
  scenes.push_back(hill_scene(edge));
  scenes.push_back(steps_scene("small-steps", edge, 7.3, 5.1));
  scenes.push_back(steps_scene("large-steps", edge, 61.7, 43.9));
  scenes.push_back(wall_scene("wall-of-a-sheet", edge, 0));
  scenes.push_back(wall_scene("wall-0.3-thick", edge, 0.3));
  scenes.push_back(wall_scene("wall-1.6-thick", edge, 1.6));
  scenes.push_back(house_scene(edge));
  for (const double slope_deg : {3., 35., 80.})
    scenes.push_back(pane_scene(fmt::format("pane-{:g}", slope_deg), edge, slope_deg, 1));
  scenes.push_back(mixed_winding(pane_scene("pane-35", edge, 35, 1)));
  scenes.push_back(pane_scene("two-panes-70", edge, 70, 2));
  scenes.push_back(wires_scene(edge));
  scenes.push_back(crown_scene(edge));
  for (const double slope_deg : {20., 70., 89.})
    for (const bool first : {true, false}) {
      scenes.push_back(plants_scene(edge, slope_deg, first));
      scenes.push_back(layer_scene(edge, slope_deg, first));
    }
  for (LeakScene& scene : mixed_scenes(edge)) scenes.push_back(mixed_winding(std::move(scene)));
  return scenes;
}

std::vector<LeakScene> few_leak_planes(double edge) {
  return {plane_scene(edge, 3, 23.7), plane_scene(edge, 20, 161.2), plane_scene(edge, 45, 298.7)};
}

}  // namespace gigabake::bench
