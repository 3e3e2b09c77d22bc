/// Classes from textures of ids, compared with areas in closed form (docs/classes.md).
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>

#include "bake_scene.h"
#include "tests/random_seed.h"
#include "triangle_families.h"

namespace gigabake::reference {
namespace {

using namespace gigabake::kernels;

constexpr std::int64_t steps_per_voxel = 256;
using Areas = std::map<VoxelClass, double>;

/// An image whose texels are ids of one channel.
struct IdImage {
  int width, height;
  std::vector<std::uint8_t> ids;

  std::vector<std::uint8_t> rgba() const {
    std::vector<std::uint8_t> out;
    for (const std::uint8_t id : ids) out.insert(out.end(), {77, id, 5, std::uint8_t(255 - id)});
    return out;
  }
};

TexelIds green_ids(std::int32_t add = 0) {
  TexelIds ids;
  ids.channel[0] = 1;
  ids.add = add;
  return ids;
}

BakeScene scene_of(const IdImage& image, const TexelIds& ids, std::uint32_t edge, Wrap wrap = Wrap::repeat) {
  BakeScene scene;
  scene.set_window({0, 0, 0}, edge);
  scene.parameters.classes = true;
  scene.add_part({}).id_texture = {scene.add_texture(image.rgba(), image.width, image.height), wrap, wrap, ids};
  return scene;
}

/// Adds a rectangle at height `z` in voxels to the scene's first part. Texture coordinates start at `first` and grow by
/// `per` images per voxel.
void add_rectangle(BakeScene& scene, double width, double depth, double z, double first, double per) {
  Part& part = scene.parts().front();
  const auto base = std::uint32_t(part.position.size() / 3);
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {width, 0.0}, {width, depth}, {0.0, depth}}) {
    for (const double p : {x, y, z}) part.position.push_back(float(p * double(steps_per_voxel)));
    for (const double p : {x, y}) part.id_uv.push_back(float(first + p * per));
  }
  for (const std::uint32_t corner : {0, 1, 2, 0, 2, 3}) part.index.push_back(base + corner);
}

std::map<Voxel, VoxelClass> classes_of(const CellVolume& volume, const CellParameters& parameters, int lod = 0) {
  std::map<Voxel, VoxelClass> out;
  for (const auto& [at, value] : voxels_at(volume, parameters, lod)) out[at] = value.voxel_class;
  return out;
}

int texel_index(std::int64_t i, int size, Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) return int(std::clamp<std::int64_t>(i, 0, size - 1));
  const std::int64_t period = wrap == Wrap::repeat ? size : 2 * size, at = (i % period + period) % period;
  return int(at < size ? at : period - 1 - at);
}

/// Returns the areas of classes in a voxel of add_rectangle(), as sums over all texels.
Areas areas_in(const IdImage& image, const TexelIds& ids, Wrap wrap, double first, double per, double x, double y) {
  const std::vector<std::uint8_t> rgba = image.rgba();
  Areas areas;
  const auto overlaps = [](double low, double high, auto visit) {
    for (std::int64_t i = std::int64_t(std::floor(low)); double(i) < high; ++i)
      visit(i, std::min(high, double(i + 1)) - std::max(low, double(i)));
  };
  const double s = (first + x * per) * image.width, t = (first + y * per) * image.height;
  overlaps(s, s + per * image.width, [&](std::int64_t i, double along) {
    overlaps(t, t + per * image.height, [&](std::int64_t j, double across) {
      const int texel = texel_index(j, image.height, wrap) * image.width + texel_index(i, image.width, wrap);
      areas[ids.class_of(&rgba[4 * std::size_t(texel)])] += along * across;
    });
  });
  return areas;
}

VoxelClass of_max_area(const Areas& areas) {
  return std::ranges::max_element(areas, [](const auto& a, const auto& b) { return a.second < b.second; })->first;
}

TEST(IdTextures, GiveVoxelsTheClassOfTheMaxArea) {
  const test::RandomSeed seed;
  Rng rng(seed);
  for (int round = 0; round < 60; ++round) {
    const int size = 1 << uniform(rng, 0, 4);
    IdImage image{size, size, {}};
    for (int i = 0; i < size * size; ++i) image.ids.push_back(std::uint8_t(uniform(rng, 0, 3)));
    const auto wrap = Wrap(uniform(rng, 0, 2));
    // Powers of two: all areas are exact, so that ties are ties.
    const double per = std::ldexp(1.0, int(uniform(rng, -4, 1))), first = double(uniform(rng, -32, 32)) / 8;
    BakeScene scene = scene_of(image, green_ids(100), 8, wrap);
    add_rectangle(scene, 8, 8, 3.5, first, per);
    const auto found = classes_of(scene.bake(), scene.parameters);
    ASSERT_EQ(found.size(), 64u);
    for (const auto& [at, voxel_class] : found)
      ASSERT_EQ(voxel_class,
                of_max_area(areas_in(image, green_ids(100), wrap, first, per, double(at[0]), double(at[1]))))
          << "round " << round << ", size " << size << ", per " << per << ", first " << first << ", wrap " << int(wrap);
  }
}

TEST(IdTextures, OfEqualAreasTakeTheLowestClass) {
  // Each voxel has a half or a quarter of each id.
  for (const auto& [ids, expected] : {std::pair<std::vector<std::uint8_t>, VoxelClass>{{9, 4, 9, 4}, 4},
                                      {{4, 9, 9, 4}, 4},
                                      {{8, 7, 6, 5}, 5},
                                      {{9, 9, 9, 4}, 9}}) {
    BakeScene scene = scene_of({2, 2, ids}, green_ids(), 8);
    add_rectangle(scene, 8, 8, 3.5, 0, 1);
    for (const auto& [at, voxel_class] : classes_of(scene.bake(), scene.parameters)) EXPECT_EQ(voxel_class, expected);
  }
}

TEST(IdTextures, CombineChannelsAndHaveANullId) {
  BakeScene scene;
  scene.set_window({0, 0, 0}, 8);
  scene.parameters.classes = true;
  TexelIds ids;
  ids.channels = 3;
  ids.channel[0] = 3, ids.channel[1] = 0, ids.channel[2] = 1;
  ids.null_id = 7 + 256 * 2 + 65536;
  ids.add = -65536;
  const std::int32_t texture = scene.add_texture({3, 1, 99, 5, 2, 1, 99, 7}, 2, 1);
  scene.add_part({}).id_texture = {texture, Wrap::repeat, Wrap::repeat, ids};
  add_rectangle(scene, 8, 8, 3.5, 0, 1.0 / 8);
  for (const auto& [at, voxel_class] : classes_of(scene.bake(), scene.parameters))
    EXPECT_EQ(voxel_class, at[0] < 4 ? 5 + 256 * 3 : no_class);
}

TEST(IdTextures, LeaveTrianglesWithoutUsableCoordinatesTheirClass) {
  BakeScene scene = scene_of({1, 1, {6}}, green_ids(), 8);
  add_rectangle(scene, 8, 8, 3.5, 0, 1);
  scene.parts().front().voxel_class = 12;
  scene.parts().front().id_uv[2] = NAN;
  const CellVolume volume = scene.bake();
  EXPECT_EQ(volume.stats.bad_uv, 1u);
  const auto classes = classes_of(volume, scene.parameters);
  EXPECT_EQ(classes.at({7, 0, 3}), 12);
  EXPECT_EQ(classes.at({0, 7, 3}), 6);
}

TEST(IdTextures, OfManyTexelsPerVoxelAreSampled) {
  // 512 × 512 texels per voxel. The left quarter of each image has id 2.
  IdImage image{512, 512, {}};
  for (int i = 0; i < 512 * 512; ++i) image.ids.push_back(i % 512 < 128 ? 2 : 3);
  BakeScene scene = scene_of(image, green_ids(), 8);
  add_rectangle(scene, 8, 8, 3.5, 0, 1);
  for (const auto& [at, voxel_class] : classes_of(scene.bake(), scene.parameters)) EXPECT_EQ(voxel_class, 3);
}

TEST(IdTextures, ChangeNoOtherValueAndDoNotDependOnThreadsMemoryAndWindow) {
  const test::RandomSeed seed;
  Rng rng(seed);
  IdImage image{16, 16, {}};
  for (int i = 0; i < 256; ++i) image.ids.push_back(std::uint8_t(uniform(rng, 0, 5)));
  const auto filled = [&](std::uint32_t edge) {
    BakeScene scene = scene_of(image, green_ids(), edge);
    add_rectangle(scene, 32, 32, 3.5, 0.3, 0.21);
    add_rectangle(scene, 21, 32, 17.25, -4.7, 0.013);
    Part& part = scene.parts().front();  // slanted triangles
    Rng positions(7);
    for (int i = 0; i < 60; ++i) {
      for (int c = 0; c < 3; ++c) part.position.push_back(float(uniform(positions, 0, 32 * steps_per_voxel)));
      for (int c = 0; c < 2; ++c) part.id_uv.push_back(float(uniform(positions, -900, 900)) / 128);
      part.index.push_back(std::uint32_t(part.position.size() / 3 - 1));
    }
    return scene;
  };
  BakeScene scene = filled(32);
  const CellVolume whole = scene.bake();
  scene.parameters.memory_bytes = 1;
  EXPECT_TRUE(same_bits(whole, scene.bake(3)));
  std::map<Voxel, VoxelClass> parts;
  for (int i = 0; i < 8; ++i) {
    BakeScene part = filled(16);
    part.set_window({(i & 1) * 16, (i >> 1 & 1) * 16, (i >> 2) * 16}, 16);
    parts.merge(classes_of(part.bake(), part.parameters));
  }
  EXPECT_EQ(parts, classes_of(whole, scene.parameters));
  const VoxelMap with = voxels_at(whole, scene.parameters, 0);
  scene.parameters.classes = false;
  VoxelMap without = voxels_at(scene.bake(), scene.parameters, 0);
  for (auto& [at, value] : without) value.voxel_class = with.at(at).voxel_class;
  EXPECT_EQ(with, without);
}

}  // namespace
}  // namespace gigabake::reference
