/// Scenes of random painted triangles, baked by bake_cell() in windows of several bricks. Presence, colour, alpha and
/// normal of each voxel are compared with exact pieces.
#include <gtest/gtest.h>

#include "bake_scene.h"
#include "core/base/rules.h"
#include "print.h"
#include "triangle_families.h"

namespace gigabake::reference {
namespace {

using namespace gigabake::kernels;

/// Min area of a voxel whose colour is checked, voxel². If the area is less, the rounding of the weights (±½
/// unit) affects the colour, so only the presence of the voxel is checked.
constexpr double min_checked_area = 1e-4;

Rgba16 random_colour(Rng& rng) {
  Rgba16 c;
  for (auto& x : c) x = std::uint16_t(uniform(rng, 0, 65535));
  return c;
}

/// Returns a random triangle with colours. Alpha is at least a tenth, so that the rounding error of a premultiplied
/// colour in 16 bits stays small.
Painted random_painted(Family family, const Window& window, Rng& rng) {
  Painted p{random_triangle(family, window, rng), random_colour(rng), AlphaMode(uniform(rng, 0, 2)), {}};
  p.colour[3] = std::uint16_t(uniform(rng, 6554, 65535));
  if (uniform(rng, 0, 2) == 0) {
    p.mode = AlphaMode::opaque;
    p.vertex_colours = {random_colour(rng), random_colour(rng), random_colour(rng)};
    for (Rgba16& c : *p.vertex_colours) c[3] = 65535;
  }
  return p;
}

void expect_voxel(const BakedVoxel& baked, const ExpectedVoxel& expected) {
  ASSERT_LE(std::abs(baked.rgba[3] - 255 * expected.alpha()), 0.501);
  // Rounding premultiplied colours to 1/65535 changes a colour by at most 0.05 / visible_fraction() codes, where sRGB
  // is steepest. Weights are rounded too, so colour and normal of a tiny visible area are not compared.
  if (expected.visible < min_checked_area) return;
  for (int c = 0; c < 3; ++c)
    ASSERT_LE(code_error(baked.rgba[c], expected.linear(c)), 0.55 + 0.1 / expected.visible_fraction())
        << "channel " << c;
  if (expected.certainty() > 1e-2) {
    ASSERT_LE(expected.normal_error_deg(direction_of(baked.normal)), octahedral_error_deg + 0.05);
  }
}

class RandomScenes : public testing::TestWithParam<Family> {
 protected:
  void expect_scene(const std::vector<Painted>& painted, SurfaceRule rule, const Window& window) {
    BakeScene scene;
    scene.set_window(window.min, std::uint32_t(window.edge));
    scene.parameters.surface = rule;
    for (const Painted& p : painted) scene.add_painted(p);
    VoxelMap baked = voxels_at(scene.bake(), scene.parameters, 0);
    for (const auto& [position, expected] : expected_voxels(painted, rule, window)) {
      SCOPED_TRACE("voxel " + std::to_string(position[0]) + " " + std::to_string(position[1]) + " " +
                   std::to_string(position[2]));
      if (std::abs(255 * expected.alpha() - 0.5) < 1e-3) continue;
      const auto found = baked.find(position);
      ASSERT_EQ(found != baked.end(), 255 * expected.alpha() >= 0.5);
      if (found == baked.end()) continue;
      if (expected.area >= min_checked_area) expect_voxel(found->second, expected);
      if (HasFatalFailure()) return;
      baked.erase(found);
    }
    ASSERT_TRUE(baked.empty()) << baked.size() << " voxels too many";
  }
};

TEST_P(RandomScenes, HoldTheExactAveragesOfWhatIsInEachVoxel) {
  const std::uint64_t seed = 81 + std::uint64_t(GetParam());
  const bool large = GetParam() >= Family::large;
  Rng rng(seed);
  for (int i = 0; i < (large ? 12 : 150); ++i) {
    const std::int64_t edge = large ? 16 : 8 << uniform(rng, 0, 2);
    const Window window{{8 * uniform(rng, -99, 99), 8 * uniform(rng, -99, 99), 8 * uniform(rng, -99, 99)}, edge};
    std::vector<Painted> painted;
    for (std::int64_t k = uniform(rng, 1, large ? 4 : 12); k > 0; --k)
      painted.push_back(random_painted(GetParam(), window, rng));
    for (const SurfaceRule rule : {SurfaceRule::area, SurfaceRule::conservative, SurfaceRule::thin}) {
      SCOPED_TRACE("scene " + std::to_string(i) + " of " + std::to_string(painted.size()) + " triangles" +
                   describe(seed, 0, painted[0].triangle, rule));
      expect_scene(painted, rule, window);
      if (HasFatalFailure()) return;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Random, RandomScenes, testing::ValuesIn(all_families),
                         [](const auto& row) { return std::string(name_of(row.param)); });

}  // namespace
}  // namespace gigabake::reference
