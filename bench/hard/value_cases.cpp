#include <utility>

#include "bench/hard/hard_case.h"

namespace gigabake::bench {
namespace {

using reference::Painted;
using reference::Rgba16;
using reference::Triangle;

constexpr Rgba16 red{65535, 0, 0, 65535}, green{0, 65535, 0, 65535}, blue{0, 0, 65535, 65535}, black{0, 0, 0, 65535};

/// Adds two triangles that face up and together cover the area of one voxel at height z.
void add_sheet(std::vector<Painted>& scene, std::int64_t z, const Rgba16& colour = reference::white16,
               AlphaMode mode = AlphaMode::opaque) {
  scene.push_back({{{{0, 0, z}, {256, 0, z}, {256, 256, z}}}, colour, mode, {}});
  scene.push_back({{{{0, 0, z}, {256, 256, z}, {0, 256, z}}}, colour, mode, {}});
}

HardCase value_case(const char* name, const char* what, const std::vector<Painted>& triangles,
                    SurfaceRule rule = SurfaceRule::area) {
  HardCase hard = lattice_case(name, "values", what);
  hard.parameters.surface = rule;
  for (const Painted& p : triangles) add_painted(hard.scenes[0].tiles[0], p, lattice_unit_m);
  return hard;
}

HardCase sheets(const char* name, const char* what, const std::vector<std::pair<Rgba16, AlphaMode>>& layers) {
  std::vector<Painted> scene;
  std::int64_t z = 40;
  for (const auto& [colour, mode] : layers) add_sheet(scene, z += 10, colour, mode);
  return value_case(name, what, scene);
}

std::vector<HardCase> colours() {
  const Triangle touching{{{256, 90, 90}, {160, 100, 100}, {160, 90, 110}}};
  std::vector<Painted> tiny;
  add_sheet(tiny, 100, red);
  tiny.push_back({{{{10, 10, 10}, {11, 10, 10}, {10, 11, 10}}}, green, AlphaMode::opaque, {}});
  const Painted graded{{{{100, 100, 100}, {1900, 300, 200}, {700, 1800, 900}}},
                       reference::white16,
                       AlphaMode::opaque,
                       std::array<Rgba16, 3>{red, green, blue}};
  return {
      value_case("tiny-beside-large", "half a sub-voxel² next to two hundred thousand times this area", tiny),
      value_case("touch-takes-colour", "a mere touch occupies a voxel, and it has a colour",
                 {{touching, red, AlphaMode::opaque, {}}}, SurfaceRule::conservative),
      value_case("touch-loses-against-area", "a touch has no weight next to area",
                 {{touching, red, AlphaMode::opaque, {}},
                  {{{{300, 20, 20}, {500, 30, 20}, {400, 230, 20}}}, green, AlphaMode::opaque, {}}},
                 SurfaceRule::conservative),
      value_case("vertex-colours", "three primaries over forty voxels: each has its pieces' mean", {graded}),
      sheets("black-is-there", "black and opaque is not absent", {{black, AlphaMode::opaque}}),
  };
}

std::vector<HardCase> alphas() {
  const auto with_alpha = [](Rgba16 colour, int alpha) {
    colour[3] = std::uint16_t(alpha);
    return colour;
  };
  const AlphaMode blend = AlphaMode::blend, mask = AlphaMode::mask, opaque = AlphaMode::opaque;
  return {
      sheets("translucent-over-opaque", "the translucent one counts by its alpha in colour; the voxel is opaque",
             {{reference::white16, opaque}, {with_alpha(black, 32768), blend}}),
      sheets("alpha-just-absent", "128.4 of 65535 rounds to 0 of 255", {{with_alpha(red, 128), blend}}),
      sheets("alpha-just-there", "129 of 65535 rounds to 1 of 255", {{with_alpha(red, 129), blend}}),
      sheets("mask-below-cutoff", "glTF: alpha ≥ cutoff is visible, smaller alpha is not",
             {{with_alpha(red, 32767), mask}}),
      sheets("mask-at-cutoff", "the same, at the cutoff", {{with_alpha(red, 32768), mask}}),
      sheets("opaque-ignores-alpha", "glTF: OPAQUE ignores alpha", {{with_alpha(red, 0), opaque}}),
  };
}

std::vector<HardCase> normals() {
  std::vector<Painted> opposite;
  add_sheet(opposite, 100);
  add_sheet(opposite, 120);
  for (std::size_t i = 2; i < 4; ++i) std::swap(opposite[i].triangle[1], opposite[i].triangle[2]);
  HardCase cancelling = value_case(
      "opposite-sheets", "their normals cancel: the voxel is two-sided, its normal the axis of both", opposite);
  cancelling.more = [](const HardBake& bake) {
    double wrong = 0;
    for (const auto& [voxel, stored] : bake.voxels) wrong += stored.normal != std::array<std::int8_t, 2>{0, 0};
    return std::vector<HardFigure>{{"not +z", "voxels", wrong, 0}};
  };
  std::vector<Painted> invisible;
  add_sheet(invisible, 100, {65535, 65535, 65535, 0}, AlphaMode::blend);
  invisible.push_back({{{{100, 10, 10}, {100, 200, 10}, {100, 10, 200}}}, reference::white16, AlphaMode::opaque, {}});
  return {cancelling,
          value_case("invisible-has-no-normal", "a surface of alpha 0 has no weight in the direction", invisible)};
}

}  // namespace

std::vector<HardCase> value_cases() {
  std::vector<HardCase> all = colours();
  for (const auto& group : {alphas(), normals()}) all.insert(all.end(), group.begin(), group.end());
  return all;
}

}  // namespace gigabake::bench
