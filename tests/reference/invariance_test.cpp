/// Changes that must not alter any bit: threads, memory, order, partition into parts, windows, whole-voxel shifts.
#include <algorithm>
#include <gtest/gtest.h>

#include "bake_scene.h"
#include "closed_meshes.h"
#include "core/base/rules.h"
#include "core/math/box3.h"

namespace gigabake::reference {
namespace {

using namespace gigabake::kernels;

constexpr std::uint32_t cube_edge = 64;

struct Recipe {
  SurfaceRule surface;
  MipFilter mip;
};

/// Returns textured, vertex-coloured triangles and closed meshes of several materials, some of them mirrored.
std::vector<Part> soup(Rng& rng, const std::vector<std::uint32_t>& materials) {
  std::vector<Part> parts;
  std::uniform_real_distribution<float> unit(0, 1);
  for (int p = 0; p < 4; ++p) {
    Part part;
    part.material = materials[std::size_t(p) % materials.size()];
    if (p == 3) part.scene_from_local = {-1, 0, 0, 9000, 0, 1, 0, 100, 0, 0, 1, -300};
    for (int t = 0; t < 150; ++t) {
      const float reach = t % 10 == 0 ? 16384.0f : 700.0f;
      float corner[3];
      for (float& c : corner) c = 16384.0f * unit(rng) - 2000.0f;
      for (int v = 0; v < 3; ++v) {
        for (const float c : corner) part.position.push_back(c + reach * (unit(rng) - 0.5f));
        part.uv.insert(part.uv.end(), {4 * unit(rng), 4 * unit(rng)});
        for (int c = 0; c < 4; ++c) part.rgba.push_back(std::uint16_t(uniform(rng, 0, 65535)));
        part.index.push_back(std::uint32_t(part.index.size()));
      }
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

BakeScene make_scene(const Recipe& recipe, std::uint64_t seed) {
  Rng rng(seed);
  BakeScene scene;
  scene.set_window({0, 0, 0}, cube_edge);
  scene.parameters.surface = recipe.surface;
  scene.parameters.mip = recipe.mip;
  std::vector<std::uint8_t> texels(4 * 16 * 16);
  for (auto& t : texels) t = std::uint8_t(uniform(rng, 0, 255));
  MaterialView textured, masked;
  textured.wrap_t = Wrap::mirrored_repeat;
  masked.alpha_mode = AlphaMode::mask;
  const std::vector<std::uint32_t> materials = {scene.add_textured(textured, texels, 16, 16),
                                                scene.add_textured(masked, texels, 16, 16),
                                                scene.add_colour({65535, 30000, 20000, 40000}, AlphaMode::blend), 0};
  for (Part& part : soup(rng, materials)) scene.add_part(std::move(part));
  scene.add_mesh(sphere({8192, 8192, 8192}, 6000, 24).triangles, materials[2]);
  scene.add_mesh(box({4096, 4096, 4096}, {12288, 12288, 12288}).triangles);
  return scene;
}

Part triangles_of(const Part& part, const std::vector<std::size_t>& which) {
  Part out = part;
  out.index.clear();
  for (const std::size_t t : which) out.index.insert(out.index.end(), &part.index[3 * t], &part.index[3 * t] + 3);
  return out;
}

class Invariance : public testing::TestWithParam<Recipe> {
 protected:
  static constexpr std::uint64_t seed = 101;
  BakeScene scene_ = make_scene(GetParam(), seed);
  CellVolume volume_ = scene_.bake();

  void expect_same(const BakeScene& other, const char* what, int threads = 1) const {
    EXPECT_TRUE(same_bits(volume_, other.bake(threads))) << what << ", seed " << seed;
  }
};

TEST_P(Invariance, HoldsForAnyNumberOfThreads) {
  ASSERT_GT(volume_.levels.at(0).rgba.size(), 4u * 10000);
  for (const int threads : {2, 3, 8}) expect_same(scene_, "threads", threads);
}

TEST_P(Invariance, HoldsForAnyMemoryBudget) {
  for (const std::uint64_t bytes : {std::uint64_t(1), std::uint64_t(1) << 20, std::uint64_t(1) << 40}) {
    scene_.parameters.memory_bytes = bytes;
    expect_same(scene_, "memory", 2);
  }
}

TEST_P(Invariance, HoldsForPermutedTrianglesAndParts) {
  Rng rng(seed + 1);
  for (Part& part : scene_.parts()) {
    std::vector<std::size_t> order(part.index.size() / 3);
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), rng);
    part = triangles_of(part, order);
  }
  std::shuffle(scene_.parts().begin(), scene_.parts().end(), rng);
  expect_same(scene_, "order");
}

TEST_P(Invariance, HoldsForASceneCutIntoFour) {
  std::deque<Part> quarters;
  for (const Part& part : scene_.parts())
    for (std::size_t q = 0; q < 4; ++q) {
      std::vector<std::size_t> which;
      for (std::size_t t = q; t < part.index.size() / 3; t += 4) which.push_back(t);
      quarters.push_back(triangles_of(part, which));
    }
  scene_.parts() = quarters;
  expect_same(scene_, "parts");
}

/// Returns the voxels of a level that lie in the window [at, at + window_edge)³ of lod 0.
VoxelMap inside(const VoxelMap& voxels, const Voxel& at, std::int64_t window_edge, int lod) {
  VoxelMap out;
  const Box3i64 window{at >> lod, (at + Voxel::all(window_edge)) >> lod};
  for (const auto& [p, v] : voxels)
    if (window.contains(p)) out[p] = v;
  return out;
}

TEST_P(Invariance, HoldsForLodZeroToThreeInAnyWindow) {
  for (const std::uint32_t small : {8u, 16u, 32u})
    for (const Voxel& at : std::vector<Voxel>{{0, 0, 0}, {24, 40, 8}, {-8, 32, 48}, {32, 24, 24}, {16, 16, 16}}) {
      scene_.set_window(at, small);
      const CellVolume volume = scene_.bake();
      const CellParameters small_window = scene_.parameters;
      scene_.set_window({0, 0, 0}, cube_edge);
      for (int lod = 0; lod < int(volume.levels.size()) && lod < 4; ++lod) {
        const VoxelMap found = inside(voxels_at(volume, small_window, lod), {0, 0, 0}, cube_edge, lod);
        const VoxelMap expected = inside(voxels_at(volume_, scene_.parameters, lod), at, small, lod);
        EXPECT_TRUE(found == expected) << "window " << small << " at " << at[0] << " lod " << lod << ", seed " << seed;
      }
    }
}

TEST_P(Invariance, HoldsForAShiftOfSceneAndWindowByWholeVoxels) {
  for (const Voxel& shift : std::vector<Voxel>{{8, 16, -24}, {-8000, 80000, 800}, {1 << 24, -(1 << 24), 1 << 20}}) {
    BakeScene moved = make_scene(GetParam(), seed);
    moved.set_window(shift, cube_edge);
    for (Part& part : moved.parts())
      for (int r = 0; r < 3; ++r) part.scene_from_local[4 * r + 3] += 256.0 * double(shift[r]);
    expect_same(moved, "shift");
  }
}

/// A shift by 1, 2 and 3 voxels along x, y and z is no multiple of a brick. It moves every lod-0 voxel and changes
/// none.
TEST_P(Invariance, HoldsForLodZeroUnderAShiftByOneVoxel) {
  BakeScene moved = make_scene(GetParam(), seed);
  for (Part& part : moved.parts())
    for (int r = 0; r < 3; ++r) part.scene_from_local[4 * r + 3] += 256.0 * (r + 1);
  const VoxelMap here = voxels_at(volume_, scene_.parameters, 0), there = voxels_at(moved.bake(), moved.parameters, 0);
  std::size_t compared = 0;
  for (const auto& [p, v] : here) {
    const Voxel q = p + Voxel{1, 2, 3};
    if (std::max({q[0], q[1], q[2]}) >= cube_edge) continue;
    const auto found = there.find(q);
    ASSERT_TRUE(found != there.end() && found->second == v) << p[0] << ' ' << p[1] << ' ' << p[2] << ", seed " << seed;
    ++compared;
  }
  EXPECT_GT(compared, 10000u);
}

INSTANTIATE_TEST_SUITE_P(Recipe, Invariance,
                         testing::Values(Recipe{SurfaceRule::area, MipFilter::coverage},
                                         Recipe{SurfaceRule::conservative, MipFilter::thesis},
                                         Recipe{SurfaceRule::thin, MipFilter::box}),
                         [](const auto& row) {
                           return row.param.surface == SurfaceRule::area   ? "area"
                                  : row.param.surface == SurfaceRule::thin ? "thin"
                                                                           : "conservative";
                         });

}  // namespace
}  // namespace gigabake::reference
