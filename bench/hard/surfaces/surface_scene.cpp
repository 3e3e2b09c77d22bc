#include "bench/hard/surfaces/surface_scene.h"

#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <utility>

#include "bench/accuracy/leaks/sheet_mesh.h"
#include "sample/terrain/noise.h"

namespace gigabake::bench {
namespace {

double radians(double deg) { return deg * std::numbers::pi / 180; }

/// A level direction, and the direction to its left.
struct Heading {
  Vec3d along, left;
  explicit Heading(double azimuth_deg)
      : along{std::cos(radians(azimuth_deg)), std::sin(radians(azimuth_deg)), 0}, left{-along[1], along[0], 0} {}
};
constexpr Vec3d upwards{0, 0, 1};

SurfaceScene named(std::string name, std::string what) {
  SurfaceScene scene;
  scene.model.name = name;
  scene.name = std::move(name);
  scene.what = std::move(what);
  scene.model.materials.push_back({"surface", -1, {surface_albedo, surface_albedo, surface_albedo, 1}, 0, true});
  scene.model.meshes.emplace_back();
  return scene;
}

std::vector<Vec3d> corners_of(const Sheet& sheet) {
  std::vector<Vec3d> corners{sheet.corner, sheet.corner + sheet.u, sheet.corner + sheet.v};
  if (sheet.shape == SheetShape::parallelogram) corners.push_back(sheet.corner + sheet.u + sheet.v);
  return corners;
}

enum class Side { outside, inside };

/// Adds the sides of a convex solid. Their triangles are wound so that `front` is their front.
void add_solid(SurfaceScene& scene, const std::vector<Sheet>& sides, Side front = Side::outside) {
  ConvexBody body;
  Vec3d middle{};
  for (const Sheet& side : sides)
    for (const Vec3d& corner : corners_of(side)) body.corners.push_back(corner);
  for (const Vec3d& corner : body.corners) middle = middle + corner / double(body.corners.size());
  for (Sheet side : sides) {
    const bool is_outward = dot(cross(side.u, side.v), side.corner - middle) > 0;
    if (is_outward != (front == Side::outside)) std::swap(side.u, side.v);
    add_sheet(scene.model.meshes[0], side);
  }
  scene.bodies.push_back(std::move(body));
}

/// Half of a house's length and width; the height of its walls, and of its ridge above them.
struct HouseSize {
  double length, width, walls, ridge;
};

/// Returns the floor, the walls, the gables and the roof of a house. `at` is the middle of its floor.
std::vector<Sheet> house_sides(const Vec3d& at, const Heading& heading, const HouseSize& size) {
  const Vec3d along = heading.along * (2 * size.length), across = heading.left * (2 * size.width);
  const Vec3d up = upwards * size.walls, to_ridge = across * 0.5 + upwards * size.ridge;
  const Vec3d corner = at - along * 0.5 - across * 0.5, ridge = corner + up + to_ridge;
  std::vector<Sheet> sides{{corner, along, across},
                           {corner, along, up},
                           {corner + across, along, up},
                           {corner, across, up},
                           {corner + along, across, up}};
  for (const Vec3d& gable : {corner + up, corner + along + up})
    sides.push_back({gable, across, to_ridge, SheetShape::triangle});
  for (const Vec3d& eaves : {corner + up, corner + across + up}) sides.push_back({eaves, along, ridge - eaves});
  return sides;
}

/// Returns the inner surface of a house whose walls, roof and floor are `thickness` thick.
HouseSize inner_size(const HouseSize& outer, double thickness) {
  const double slope = outer.ridge / outer.width, inner_width = outer.width - thickness;
  // The inner roof is parallel to the outer one, `thickness` away from it; heights are above the inner floor.
  const double below_roof = thickness * std::hypot(1, slope);
  return {outer.length - thickness, inner_width, outer.walls + slope * thickness - below_roof - thickness,
          slope * inner_width};
}

/// Returns a random unit vector.
Vec3d random_direction(sample::Random& random) {
  const double z = random.between(-1, 1), turn = random.between(0, 2 * std::numbers::pi);
  const double level = std::sqrt(1 - z * z);
  return {level * std::cos(turn), level * std::sin(turn), z};
}

}  // namespace

SurfaceScene town_scene() {
  constexpr int rows = 8;
  constexpr double apart = 44;
  SurfaceScene scene = named("town", "64 houses of 12 to 32 voxels with floors, without ground");
  sample::Random random(20261128);
  for (int i = 0; i < rows * rows; ++i) {
    const Vec3d at = off_the_lattice + Vec3d{apart * (i % rows) + random.between(-3, 3),
                                             apart * (i / rows) + random.between(-3, 3), random.between(0, 4)};
    const Heading heading(random.between(0, 360));
    const HouseSize size{random.between(8, 16), random.between(6, 12), random.between(10, 18), random.between(4, 10)};
    add_solid(scene, house_sides(at, heading, size));
  }
  return scene;
}

SurfaceScene thin_wires_scene(double thickness) {
  constexpr double length = 160, apart = 9.7;
  constexpr int wires = 12;
  SurfaceScene scene = named(fmt::format("wires-{:g}", thickness),
                             fmt::format("36 bars {:g} thick: a grid 12° steep, and posts", thickness));
  const Heading heading(57.1);
  const Vec3d u = unit_vector(heading.along * std::cos(radians(12)) - upwards * std::sin(radians(12)));
  const Vec3d v = heading.left, w = cross(u, v);
  const auto add = [&](const Vec3d& from, const Vec3d& direction, double wire, const Vec3d& a, const Vec3d& b) {
    add_solid(scene, sides_of(from, direction * wire, a * thickness, b * thickness));
  };
  for (int i = 0; i < wires; ++i) {
    const double at = i * apart;
    add(off_the_lattice + v * at, u, length, v, w);
    add(off_the_lattice + u * at + w * 0.61, v, length, u, w);
    add(off_the_lattice + v * at + u * 130, upwards, 0.3 * length, heading.along, heading.left);
  }
  return scene;
}

SurfaceScene leaves_scene(LeafShape shape, double edge) {
  constexpr double width = 64, cover = 0.05;
  const auto leaves = int(cover * width * width / (edge * edge / 2));  // half of a leaf's area is visible in the mean
  const bool is_solid = shape == LeafShape::solid;
  SurfaceScene scene =
      named(fmt::format("{}-leaves-{:g}", is_solid ? "solid" : "sheet", edge),
            fmt::format("{} {} squares of {:g}, 5 % cover", leaves, is_solid ? "closed thin" : "two-sided", edge));
  sample::Random random(20261129);
  for (int i = 0; i < leaves; ++i) {
    const Vec3d at =
        off_the_lattice + Vec3d{random.between(0, width), random.between(0, width), random.between(0, width / 2)};
    const Vec3d normal = random_direction(random), u = unit_vector(cross(normal, random_direction(random)));
    const Vec3d v = cross(normal, u);
    const Sheet leaf{at, u * edge, v * edge};
    if (is_solid) {
      add_solid(scene, sides_of(leaf.corner, leaf.u, leaf.v, normal * (edge / 10)));
    } else {
      scene.bodies.push_back({corners_of(leaf)});
      add_sheet(scene.model.meshes[0], leaf);
    }
  }
  return scene;
}

WallScene thin_wall_scene(double thickness, double azimuth_deg, double lean_deg) {
  const Heading heading(azimuth_deg);
  WallScene wall;
  static_cast<SurfaceScene&>(wall) =
      named(fmt::format("wall-{:g}-at-{:g}{}", thickness, azimuth_deg, lean_deg > 0 ? "-leaning" : ""),
            fmt::format("solid wall {:g} thick, {:g}° from upright", thickness, lean_deg));
  wall.along = heading.along;
  wall.normal = heading.left * std::cos(radians(lean_deg)) + upwards * std::sin(radians(lean_deg));
  wall.middle = off_the_lattice;
  wall.thickness = thickness;
  const Vec3d up = cross(wall.along, wall.normal);
  const Vec3d corner =
      wall.middle - wall.along * (wall.length / 2) - up * (wall.height / 2) - wall.normal * (thickness / 2);
  add_solid(wall, sides_of(corner, wall.along * wall.length, wall.normal * thickness, up * wall.height));
  return wall;
}

HouseScene closed_house_scene(double thickness, double azimuth_deg) {
  const Heading heading(azimuth_deg);
  const HouseSize outer{32, 22, 24, 14};
  HouseScene house;
  static_cast<SurfaceScene&>(house) =
      named(fmt::format("inside-{:g}-at-{:g}", thickness, azimuth_deg),
            thickness > 0 ? fmt::format("the inside of a closed house with walls {:g} thick", thickness)
                          : "the inside of a closed house of one layer");
  add_solid(house, house_sides(off_the_lattice, heading, outer));
  if (thickness > 0)
    add_solid(house, house_sides(off_the_lattice + upwards * thickness, heading, inner_size(outer, thickness)),
              Side::inside);
  house.inside = off_the_lattice - heading.along * 6.3 + heading.left * 4.1 + upwards * 11.2;
  return house;
}

}  // namespace gigabake::bench
