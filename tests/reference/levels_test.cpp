/// Coarser levels against the filters of docs/accuracy.md written plainly, voxel by voxel; and the pruned tree,
/// expanded, against levels that were never pruned.
#include <gtest/gtest.h>

#include "bake_scene.h"
#include "closed_meshes.h"
#include "print.h"

namespace gigabake::reference {
namespace {

using namespace gigabake::kernels;

struct Octet {
  std::array<double, 8> alpha{};  ///< 0 … 1, child x + 2y + 4z
  double visible = 0;
  std::array<double, 3> colour{};
  Direction normal{};
};

std::map<Voxel, Octet> octets_of(const VoxelMap& fine) {
  std::map<Voxel, Octet> out;
  for (const auto& [p, v] : fine) {
    Octet& o = out[{p[0] >> 1, p[1] >> 1, p[2] >> 1}];
    const double alpha = v.rgba[3] / 255.0;
    o.alpha[std::size_t((p[0] & 1) + 2 * (p[1] & 1) + 4 * (p[2] & 1))] = alpha;
    o.visible += alpha;
    const Direction n = direction_of(v.normal);
    for (int c = 0; c < 3; ++c) {
      o.colour[c] += alpha * linear_of(v.rgba[c] / 255.0);
      o.normal[c] += alpha * n[c];
    }
  }
  return out;
}

/// What a view along an axis sees of two voxels one behind the other, averaged over axes and columns.
double directional_coverage(const std::array<double, 8>& a) {
  double sum = 0;
  for (int x = 0; x < 2; ++x)
    for (int y = 0; y < 2; ++y) {
      sum += 1 - (1 - a[x + 2 * y]) * (1 - a[x + 2 * y + 4]);
      sum += 1 - (1 - a[x + 4 * y]) * (1 - a[x + 4 * y + 2]);
      sum += 1 - (1 - a[2 * x + 4 * y]) * (1 - a[2 * x + 4 * y + 1]);
    }
  return sum / 12;
}

double filtered_alpha(const Octet& o, MipFilter filter) {
  if (filter == MipFilter::coverage) return directional_coverage(o.alpha);
  const double mean = o.visible / 8;
  return filter == MipFilter::box ? mean : std::pow(mean, 1 - mean);
}

void expect_parent(const BakedVoxel& parent, const Octet& o, MipFilter filter) {
  const double alpha = std::max(1.0, 255 * filtered_alpha(o, filter));
  ASSERT_LE(std::abs(parent.rgba[3] - alpha), 0.5 + 1e-9) << "alpha";
  // The table of linear values has 16 bits: at worst 0.05 codes, where sRGB is steepest, for each of two roundings.
  for (int c = 0; c < 3; ++c) ASSERT_LE(code_error(parent.rgba[c], o.colour[c] / o.visible), 0.6) << "channel " << c;
  const double length =
      std::sqrt(o.normal[0] * o.normal[0] + o.normal[1] * o.normal[1] + o.normal[2] * o.normal[2]) / o.visible;
  if (length > 1e-2) {
    ASSERT_LE(angle_deg(direction_of(parent.normal), o.normal), octahedral_error_deg + 0.05);
  }
}

void expect_levels(const BakeScene& scene, const CellVolume& volume) {
  VoxelMap fine = voxels_at(volume, scene.parameters, 0);
  for (int lod = 1; lod < int(volume.levels.size()); ++lod) {
    const VoxelMap coarse = voxels_at(volume, scene.parameters, lod);
    const auto octets = octets_of(fine);
    ASSERT_EQ(coarse.size(), octets.size()) << "lod " << lod;
    for (const auto& [position, octet] : octets) {
      ASSERT_TRUE(coarse.count(position)) << "lod " << lod;
      expect_parent(coarse.at(position), octet, scene.parameters.mip);
      if (testing::Test::HasFatalFailure()) return;
    }
    fine = coarse;
  }
}

/// Parallel sheets through every layer of voxels of [low, high)³: every voxel there is present and alike.
void fill(BakeScene& scene, const Voxel& low, const Voxel& high, std::uint32_t material) {
  std::vector<Triangle> mesh;
  const std::int64_t x0 = low[0] * 256, y0 = low[1] * 256, x1 = high[0] * 256, y1 = high[1] * 256;
  for (std::int64_t z = low[2]; z < high[2]; ++z) {
    const std::int64_t h = z * 256 + 100;
    mesh.push_back({{{x0, y0, h}, {x1, y0, h}, {x1, y1, h}}});
    mesh.push_back({{{x0, y0, h}, {x1, y1, h}, {x0, y1, h}}});
  }
  scene.add_mesh(mesh, material);
}

class Levels : public testing::TestWithParam<MipFilter> {};

TEST_P(Levels, AreTheFiltersOfTheLevelBelowForRandomTranslucentScenes) {
  const std::uint64_t seed = 91;
  Rng rng(seed);
  for (int i = 0; i < 12; ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", scene " + std::to_string(i));
    BakeScene scene;
    scene.set_window({-32, 64, -64}, 64);
    scene.parameters.mip = GetParam();
    for (int k = 0; k < 40; ++k) {
      Rgba16 colour;
      for (auto& c : colour) c = std::uint16_t(uniform(rng, 0, 65535));
      const auto at = [&](std::int64_t low) { return uniform(rng, low * 256, (low + 64) * 256); };
      Triangle t;
      for (auto& v : t) v = {at(-32), at(64), at(-64)};
      if (has_area(t)) scene.add_painted({t, colour, i % 2 ? AlphaMode::blend : AlphaMode::opaque, {}});
    }
    expect_levels(scene, scene.bake());
    if (HasFatalFailure()) return;
  }
}

TEST_P(Levels, OfAFilledBlockAreOneLeafAndExpandToEveryVoxel) {
  BakeScene scene;
  scene.set_window({0, 0, 0}, 64);
  scene.parameters.mip = GetParam();
  fill(scene, {0, 0, 0}, {64, 64, 64}, scene.add_colour({50000, 20000, 1000, 65535}));
  const CellVolume volume = scene.bake();
  ASSERT_EQ(volume.nodes.kind.size(), 1u);
  EXPECT_EQ(volume.nodes.kind[0], NodeKind::leaf_constant);
  for (const Level& level : volume.levels) EXPECT_TRUE(level.key.empty());
  EXPECT_EQ(voxels_at(volume, scene.parameters, 0).size(), 64u * 64 * 64);
  expect_levels(scene, volume);
}

/// One triangle of another colour in one voxel: the branches around it stay leaves, the way down to it does not.
TEST_P(Levels, OfAFilledBlockWithOneOddVoxelKeepTheOddVoxel) {
  BakeScene scene;
  scene.set_window({0, 0, 0}, 64);
  scene.parameters.mip = GetParam();
  fill(scene, {0, 0, 0}, {64, 64, 64}, 0);
  const auto red = scene.add_colour({65535, 0, 0, 65535});
  scene.add_mesh({{{{8970, 4362, 10}, {9200, 4370, 10}, {8980, 4590, 10}}}}, red);
  const CellVolume volume = scene.bake();
  const VoxelMap voxels = voxels_at(volume, scene.parameters, 0);
  EXPECT_EQ(voxels.size(), 64u * 64 * 64);
  EXPECT_LT(voxels.at({35, 17, 0}).rgba[1], 255);
  EXPECT_EQ(volume.levels[0].key.size(), 1u) << "one brick is not constant";
  EXPECT_LE(volume.nodes.kind.size(), 1u + 3 * 8);
  expect_levels(scene, volume);
}

TEST_P(Levels, OfAHalfFilledWindowExpandToWhatWasThere) {
  BakeScene scene;
  scene.set_window({-64, 0, 64}, 64);
  scene.parameters.mip = GetParam();
  fill(scene, {-64, 0, 64}, {-20, 40, 100}, 0);
  const CellVolume volume = scene.bake();
  EXPECT_EQ(voxels_at(volume, scene.parameters, 0).size(), 44u * 40 * 36);
  expect_levels(scene, volume);
}

/// Layers of two colours: parents are all alike, their children are not.
TEST_P(Levels, OfAStripedBlockAreConstantAboveAndBricksBelow) {
  BakeScene scene;
  scene.set_window({0, 0, 0}, 32);
  scene.parameters.mip = GetParam();
  const std::uint32_t stripes[2] = {scene.add_colour({65535, 0, 0, 65535}), scene.add_colour({0, 65535, 0, 65535})};
  for (std::int64_t z = 0; z < 32; ++z) fill(scene, {0, 0, z}, {32, 32, z + 1}, stripes[z % 2]);
  const CellVolume volume = scene.bake();
  EXPECT_EQ(volume.levels[0].key.size(), 64u);
  EXPECT_TRUE(volume.levels[1].key.empty());
  for (std::size_t n = 0; n < volume.nodes.kind.size(); ++n)
    EXPECT_EQ(volume.nodes.kind[n], volume.nodes.lod[n] == 0 ? NodeKind::brick : NodeKind::constant);
  expect_levels(scene, volume);
}

/// The table's order and links as kernels/cell.h and format/shard.h promise them.
void expect_tree(const Nodes& nodes, int lods) {
  std::vector<int> visits(nodes.key.size(), 0);
  ASSERT_EQ(nodes.lod[0], lods - 1);
  visits[0] = 1;
  for (std::size_t n = 0; n < nodes.key.size(); ++n) {
    ASSERT_EQ(visits[n], 1) << "node " << n << " must be the child of one earlier node";
    ASSERT_TRUE(nodes.kind[n] != NodeKind::leaf_constant || nodes.child_mask[n] == 0);
    if (nodes.child_mask[n] == 0) {
      ASSERT_EQ(nodes.first_child[n], 0xffffffffu);
      ASSERT_TRUE(nodes.lod[n] == 0 || nodes.kind[n] == NodeKind::leaf_constant);
    }
    std::size_t child = nodes.first_child[n];
    for (std::uint64_t c = 0; c < 8; ++c) {
      if (!(nodes.child_mask[n] >> c & 1)) continue;
      ASSERT_LT(child, nodes.key.size());
      ASSERT_EQ(nodes.key[child], nodes.key[n] << 3 | c);
      ASSERT_EQ(nodes.lod[child], nodes.lod[n] - 1);
      ++visits[child++];
    }
  }
}

TEST(NodeTable, IsATreeInMortonOrderLevelByLevel) {
  const std::uint64_t seed = 93;
  Rng rng(seed);
  for (int i = 0; i < 20; ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", scene " + std::to_string(i));
    BakeScene scene;
    scene.set_window({-64, -64, -64}, 128);
    scene.add_mesh(random_hull({uniform(rng, -999, 999), 5, 7}, 256 << i % 6, 1, 6, rng).triangles);
    if (i % 3 == 0) fill(scene, {-32, -32, -32}, {10, 20, 30}, 0);
    expect_tree(scene.bake().nodes, 5);
    if (HasFatalFailure()) return;
  }
}

TEST(LevelsWithoutNormals, HaveTheSameColours) {
  Rng rng(92);
  BakeScene scene;
  scene.set_window({-16, -16, -16}, 32);
  scene.add_mesh(random_hull({0, 0, 0}, 3000, 1, 8, rng).triangles, scene.add_colour({999, 30000, 60000, 65535}));
  const CellVolume with = scene.bake();
  scene.parameters.normals = false;
  const CellVolume without = scene.bake();
  ASSERT_EQ(with.levels.size(), without.levels.size());
  for (std::size_t lod = 0; lod < with.levels.size(); ++lod) {
    EXPECT_TRUE(without.levels[lod].normal.empty());
    const VoxelMap a = voxels_at(with, scene.parameters, int(lod)), b = voxels_at(without, scene.parameters, int(lod));
    ASSERT_EQ(positions_of(a), positions_of(b));
    for (const auto& [position, voxel] : a) ASSERT_EQ(voxel.rgba, b.at(position).rgba);
  }
}

INSTANTIATE_TEST_SUITE_P(Filter, Levels, testing::Values(MipFilter::coverage, MipFilter::thesis, MipFilter::box),
                         [](const auto& row) {
                           return row.param == MipFilter::coverage ? "coverage"
                                  : row.param == MipFilter::thesis ? "thesis"
                                                                   : "box";
                         });

}  // namespace
}  // namespace gigabake::reference
