/// Classes of voxels compared with areas in exact rational arithmetic (docs/voxels.md, "Classes").
#include <algorithm>
#include <gtest/gtest.h>
#include <map>

#include "bake_scene.h"
#include "print.h"
#include "tests/random_seed.h"
#include "triangle_families.h"

namespace gigabake::reference {
namespace {

using namespace gigabake::kernels;

/// Areas that differ by less than this may have equal weights: 2^-36 voxel² per triangle is their rounding.
constexpr double equal_areas = 1e-9;
constexpr std::int64_t subvoxel_edge = 256;

struct ClassifiedTriangle {
  Triangle triangle;
  VoxelClass voxel_class;
};

using ClassAreas = std::map<Voxel, std::map<VoxelClass, double>>;

ClassAreas exact_areas(const std::vector<ClassifiedTriangle>& triangles, const Window& window, SurfaceRule rule) {
  ClassAreas areas;
  for (const auto& [triangle, voxel_class] : triangles) {
    const std::vector<Piece> pieces = pieces_in(triangle, window);
    const std::set<Voxel> voxels = occupied(triangle, pieces, rule);
    for (const Piece& piece : pieces)
      if (voxels.contains(piece.voxel)) areas[piece.voxel][voxel_class] += area_voxel2(piece, triangle);
  }
  return areas;
}

BakeScene scene_of(const std::vector<ClassifiedTriangle>& triangles, std::uint32_t edge) {
  BakeScene scene;
  scene.set_window({0, 0, 0}, edge);
  scene.parameters.classes = true;
  for (const auto& [triangle, voxel_class] : triangles) scene.add_triangle(triangle).voxel_class = voxel_class;
  return scene;
}

std::map<Voxel, VoxelClass> classes_at(const CellVolume& volume, const CellParameters& parameters, int lod) {
  std::map<Voxel, VoxelClass> out;
  for (const auto& [at, value] : voxels_at(volume, parameters, lod)) out[at] = value.voxel_class;
  return out;
}

std::map<Voxel, VoxelClass> classes_at(const BakeScene& scene, int lod = 0) {
  return classes_at(scene.bake(), scene.parameters, lod);
}

/// Returns a rectangle at height `z` as two triangles. Coordinates are sub-voxels.
std::vector<ClassifiedTriangle> rectangle(std::int64_t x0, std::int64_t y0, std::int64_t x1, std::int64_t y1,
                                          std::int64_t z, VoxelClass voxel_class) {
  return {{{{{x0, y0, z}, {x1, y0, z}, {x1, y1, z}}}, voxel_class},
          {{{{x0, y0, z}, {x1, y1, z}, {x0, y1, z}}}, voxel_class}};
}

std::vector<ClassifiedTriangle> joined(std::initializer_list<std::vector<ClassifiedTriangle>> lists) {
  std::vector<ClassifiedTriangle> all;
  for (const auto& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

std::vector<ClassifiedTriangle> random_triangles(const Window& window, Rng& rng) {
  constexpr Family families[] = {Family::tiny,
                                 Family::small,
                                 Family::sliver,
                                 Family::lattice_vertices,
                                 Family::half_voxel_ties,
                                 Family::axis_parallel,
                                 Family::in_lattice_plane,
                                 Family::diagonal_plane};
  std::vector<ClassifiedTriangle> triangles;
  const auto count = uniform(rng, 2, 14);
  for (std::int64_t i = 0; i < count; ++i)
    triangles.push_back({random_triangle(families[uniform(rng, 0, 7)], window, rng), VoxelClass(uniform(rng, 0, 3))});
  return triangles;
}

TEST(VoxelClasses, HaveTheMaxExactArea) {
  const test::RandomSeed seed;
  Rng rng(seed);
  std::size_t voxels = 0, of_several = 0;
  for (int round = 0; round < 300; ++round) {
    const Window window{{0, 0, 0}, 8};
    const std::vector<ClassifiedTriangle> triangles = random_triangles(window, rng);
    BakeScene scene = scene_of(triangles, 8);
    scene.parameters.surface = SurfaceRule(uniform(rng, 0, 2));
    const ClassAreas exact = exact_areas(triangles, window, scene.parameters.surface);
    const std::map<Voxel, VoxelClass> found = classes_at(scene);
    ASSERT_EQ(found.size(), exact.size());
    for (const auto& [at, areas] : exact) {
      double max_area = 0;
      for (const auto& [of_class, area] : areas) max_area = std::max(max_area, area);
      ASSERT_TRUE(areas.contains(found.at(at)));
      ASSERT_GE(areas.at(found.at(at)), max_area - equal_areas) << "round " << round;
      ++voxels;
      of_several += areas.size() > 1 ? 1 : 0;
    }
  }
  EXPECT_GT(of_several, voxels / 20);
}

TEST(VoxelClasses, OfEqualAreasAreTheLowest) {
  const auto left = [](VoxelClass c) { return rectangle(0, 0, subvoxel_edge / 2, subvoxel_edge, 100, c); };
  const auto right = [](VoxelClass c) { return rectangle(subvoxel_edge / 2, 0, subvoxel_edge, subvoxel_edge, 200, c); };
  for (const auto& [a, b] : {std::pair<VoxelClass, VoxelClass>{3, 5}, {5, 3}, {0, 7}, {7, 0}, {65535, 65534}})
    EXPECT_EQ(classes_at(scene_of(joined({left(a), right(b)}), 8)),
              (std::map<Voxel, VoxelClass>{{{0, 0, 0}, std::min(a, b)}}));
  // A little more area decides.
  const auto more = rectangle(0, 0, subvoxel_edge / 2, 1, 30, 9);
  EXPECT_EQ(classes_at(scene_of(joined({left(3), right(9), more}), 8)).at({0, 0, 0}), 9);
  // The areas of a class add up, whatever their number.
  const auto quarter = [](std::int64_t x, VoxelClass c) {
    return rectangle(x, 0, x + subvoxel_edge / 4, subvoxel_edge, 60, c);
  };
  EXPECT_EQ(classes_at(scene_of(joined({left(1), quarter(128, 2), quarter(192, 2), quarter(128, 2)}), 8)).at({0, 0, 0}),
            2);
  EXPECT_EQ(classes_at(scene_of(joined({left(1), quarter(128, 2), quarter(192, 2)}), 8)).at({0, 0, 0}), 1);
}

TEST(VoxelClasses, CountContentWithoutAClassAndNotWhatIsTransparent) {
  const auto large = rectangle(0, 0, subvoxel_edge, subvoxel_edge, 100, 0),
             small = rectangle(0, 0, subvoxel_edge / 2, subvoxel_edge, 120, 4);
  EXPECT_EQ(classes_at(scene_of(joined({large, small}), 8)).at({0, 0, 0}), 0);
  BakeScene scene = scene_of(small, 8);
  const std::uint32_t clear = scene.add_colour({65535, 65535, 65535, 0}, AlphaMode::blend);
  const std::uint32_t faint = scene.add_colour({65535, 65535, 65535, 20000}, AlphaMode::blend);
  for (const auto& [triangle, voxel_class] : large) scene.add_triangle(triangle, clear).voxel_class = voxel_class;
  EXPECT_EQ(classes_at(scene).at({0, 0, 0}), 4) << "alpha is 0";
  for (const auto& [triangle, voxel_class] : large) scene.add_triangle(triangle, faint).voxel_class = 8;
  EXPECT_EQ(classes_at(scene).at({0, 0, 0}), 8) << "alpha does not weigh areas";
}

TEST(VoxelClasses, DoNotDependOnOrderThreadsMemoryAndWindow) {
  const test::RandomSeed seed;
  Rng rng(seed);
  std::vector<ClassifiedTriangle> triangles;
  for (int i = 0; i < 12; ++i) {
    const auto some =
        random_triangles({{uniform(rng, 0, 3) * 8, uniform(rng, 0, 3) * 8, uniform(rng, 0, 3) * 8}, 8}, rng);
    triangles.insert(triangles.end(), some.begin(), some.end());
  }
  // Many triangles in one voxel, of classes in no order.
  for (int i = 0; i < 3000; ++i)
    triangles.push_back({random_triangle(Family::tiny, {{8, 8, 8}, 8}, rng), VoxelClass(uniform(rng, 0, 65535))});
  const CellVolume first = scene_of(triangles, 32).bake();
  std::ranges::shuffle(triangles, rng);
  BakeScene shuffled = scene_of(triangles, 32);
  shuffled.parameters.memory_bytes = 1;
  EXPECT_TRUE(same_bits(first, shuffled.bake(3)));
  EXPECT_EQ(first.content_hash, shuffled.bake().content_hash);
  const std::map<Voxel, VoxelClass> whole = classes_at(shuffled, 1);
  std::map<Voxel, VoxelClass> parts;
  for (int i = 0; i < 8; ++i) {
    BakeScene part = scene_of(triangles, 16);
    part.set_window({(i & 1) * 16, (i >> 1 & 1) * 16, (i >> 2) * 16}, 16);
    parts.merge(classes_at(part, 1));
  }
  EXPECT_EQ(parts, whole);
}

/// Returns one rectangle per voxel column, at height `z` in voxels and a half, with random classes.
std::vector<ClassifiedTriangle> checkered(std::int64_t edge, std::int64_t z, Rng& rng) {
  std::vector<ClassifiedTriangle> triangles;
  for (std::int64_t i = 0; i < edge * edge; ++i) {
    const std::int64_t x = i % edge * subvoxel_edge, y = i / edge * subvoxel_edge;
    const auto one = rectangle(x, y, x + subvoxel_edge, y + subvoxel_edge, z * subvoxel_edge + subvoxel_edge / 2,
                               VoxelClass(uniform(rng, 0, 3)));
    triangles.insert(triangles.end(), one.begin(), one.end());
  }
  return triangles;
}

/// Returns the class with the largest weight in the children of each voxel; of equal weights the lowest.
std::map<Voxel, VoxelClass> majorities(const VoxelMap& children, bool by_alpha) {
  std::map<Voxel, std::map<VoxelClass, int>> weights;
  for (const auto& [at, value] : children) weights[at >> 1][value.voxel_class] += by_alpha ? value.rgba[3] : 1;
  std::map<Voxel, VoxelClass> out;
  for (const auto& [at, of_classes] : weights)
    out[at] =
        std::ranges::max_element(of_classes, [](const auto& a, const auto& b) { return a.second < b.second; })->first;
  return out;
}

TEST(VoxelClasses, OfCoarserLevelsAreMajorities) {
  const test::RandomSeed seed;
  Rng rng(seed);
  for (const MipFilter mip : {MipFilter::coverage, MipFilter::box})
    for (int round = 0; round < 8; ++round) {
      // The children of a flat surface have equal weights.
      BakeScene scene = scene_of(checkered(16, 5, rng), 16);
      scene.parameters.mip = mip;
      scene.parameters.normals = round % 2 == 0;
      const CellVolume volume = scene.bake();
      EXPECT_EQ(classes_at(volume, scene.parameters, 1), majorities(voxels_at(volume, scene.parameters, 0), false));
    }
  for (int round = 0; round < 20; ++round) {
    // The filter `box` weighs children by alpha.
    std::vector<ClassifiedTriangle> triangles;
    for (int i = 0; i < 6; ++i) {
      const auto some = random_triangles({{0, 0, 0}, 16}, rng);
      triangles.insert(triangles.end(), some.begin(), some.end());
    }
    BakeScene scene = scene_of(triangles, 16);
    scene.parameters.mip = MipFilter::box;
    for (Part& part : scene.parts())
      part.material = scene.add_colour({9000, 9000, 9000, std::uint16_t(uniform(rng, 3000, 65535))}, AlphaMode::blend);
    const CellVolume volume = scene.bake();
    EXPECT_EQ(classes_at(volume, scene.parameters, 1), majorities(voxels_at(volume, scene.parameters, 0), true));
  }
}

TEST(VoxelClasses, DivideConstantNodes) {
  // Two blocks of voxels that are equal in all but their class: eight bricks, each constant.
  std::vector<ClassifiedTriangle> triangles;
  for (std::int64_t z = 0; z < 16; ++z)
    for (const int side : {0, 1}) {
      const auto half = rectangle(side * 8 * subvoxel_edge, 0, (side + 1) * 8 * subvoxel_edge, 16 * subvoxel_edge,
                                  z * subvoxel_edge + subvoxel_edge / 2, VoxelClass(1 + side));
      triangles.insert(triangles.end(), half.begin(), half.end());
    }
  for (const std::uint32_t max_error : {0u, 9u}) {
    BakeScene scene = scene_of(triangles, 16);
    scene.parameters.max_error = max_error;
    const CellVolume volume = scene.bake();
    for (std::size_t n = 0; n < volume.nodes.key.size(); ++n)
      EXPECT_EQ(volume.nodes.kind[n] == NodeKind::brick, volume.nodes.lod[n] == 1) << "only the root has two classes";
    for (const auto& [at, voxel_class] : classes_at(volume, scene.parameters, 0))
      EXPECT_EQ(voxel_class, at[0] < 8 ? 1 : 2);
    scene.parameters.classes = false;
    EXPECT_NE(scene.bake().nodes.kind[0], NodeKind::brick) << "without classes all voxels are equal";
  }
}

TEST(VoxelClasses, ChangeNoOtherValue) {
  const test::RandomSeed seed;
  Rng rng(seed);
  for (int round = 0; round < 20; ++round) {
    BakeScene scene = scene_of(random_triangles({{0, 0, 0}, 16}, rng), 16);
    const VoxelMap with = voxels_at(scene.bake(), scene.parameters, 0);
    scene.parameters.classes = false;
    VoxelMap without = voxels_at(scene.bake(), scene.parameters, 0);
    for (auto& [at, value] : without) value.voxel_class = with.at(at).voxel_class;
    EXPECT_EQ(with, without);
  }
}

TEST(VoxelClasses, OfLeavesAreThoseOfTheirLevel) {
  // Ground of level 2 with two classes, and a fine triangle far from it.
  BakeScene scene;
  scene.set_window({0, 0, 0}, 64);
  scene.parameters.classes = true;
  const std::int64_t edge = 64 * subvoxel_edge;
  for (const auto& [triangle, voxel_class] : joined({rectangle(0, 0, edge / 2, edge, 2 * subvoxel_edge, 6),
                                                     rectangle(edge / 2, 0, edge, edge, 2 * subvoxel_edge, 7)})) {
    Part& part = scene.add_triangle(triangle);
    part.voxel_class = voxel_class;
    part.lod = 2;
  }
  const LatticeVertex corner{100, 100, 60 * subvoxel_edge};
  scene.add_triangle({corner, corner + LatticeVertex{200, 0, 0}, corner + LatticeVertex{0, 200, subvoxel_edge}})
      .voxel_class = 8;
  const CellVolume volume = scene.bake();
  for (const auto& [at, voxel_class] : classes_at(volume, scene.parameters, 2)) {
    if (at[2] == 0) {
      EXPECT_EQ(voxel_class, at[0] < 8 ? 6 : 7);
    } else {
      EXPECT_EQ(voxel_class, 8);
    }
  }
  EXPECT_EQ(classes_at(volume, scene.parameters, 3).at({0, 0, 0}), 6);
}

}  // namespace
}  // namespace gigabake::reference
