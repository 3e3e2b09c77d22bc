/// Coarser levels compared with a plain implementation of the filters of docs/accuracy.md. The pruned tree is expanded
/// and compared with levels that were never pruned.
#include <gtest/gtest.h>
#include <optional>

#include "bake_scene.h"
#include "closed_meshes.h"
#include "core/base/rules.h"
#include "core/octree/octree.h"
#include "core/octree/plane.h"
#include "print.h"
#include "raster.h"

namespace gigabake::reference {
namespace {

using namespace gigabake::kernels;

/// Returns a/b rounded half up; a and b are not negative.
int rounded(int a, int b) { return (2 * a + b) / (2 * b); }

/// The finer voxels below a coarse voxel; null where a voxel is missing.
using Finer = std::vector<const BakedVoxel*>;

struct Octet {
  Finer child = Finer(8);  ///< x + 2y + 4z
  std::array<const Raster*, 8> raster{};
};

/// The raster of a coarse voxel before downsampling, and the area of each child that is visible from the six sides.
struct Views {
  Raster fine;
  std::array<long, 8> seen{};
};

Views look_at(const Octet& o) {
  int edge = 1;
  for (const Raster* r : o.raster)
    if (r != nullptr) edge = r->edge;
  Views views{blank_raster(2 * edge), {}};
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t low = 0; low < 8; ++low) {
      if ((low >> axis & 1) != 0) continue;
      const std::size_t high = low + (std::size_t(1) << axis);
      const int across[2] = {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2};
      const int u0 = edge * int(low >> across[0] & 1), v0 = edge * int(low >> across[1] & 1);
      for (int v = 0; v < edge; ++v)
        for (int u = 0; u < edge; ++u) {
          const int a = o.raster[low] == nullptr ? 0 : o.raster[low]->at(axis, u, v);
          const int b = o.raster[high] == nullptr ? 0 : o.raster[high]->at(axis, u, v);
          const int either = a + b - rounded(a * b, 255);
          views.fine.cells[std::size_t(axis)][std::size_t(u0 + u + 2 * edge * (v0 + v))] = either;
          views.seen[low] += a + either - b;
          views.seen[high] += b + either - a;
        }
    }
  return views;
}

Raster stored_raster(const Raster& fine) {
  if (fine.edge <= 8) return fine;
  Raster out = blank_raster(8);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (int v = 0; v < 8; ++v)
      for (int u = 0; u < 8; ++u) {
        const int a = int(axis);
        out.cells[axis][std::size_t(u + 8 * v)] =
            rounded(fine.at(a, 2 * u, 2 * v) + fine.at(a, 2 * u + 1, 2 * v) + fine.at(a, 2 * u, 2 * v + 1) +
                        fine.at(a, 2 * u + 1, 2 * v + 1),
                    4);
      }
  return out;
}

std::map<Voxel, Octet> octets_of(const VoxelMap& fine, const Rasters& rasters) {
  std::map<Voxel, Octet> out;
  for (const auto& [p, v] : fine) {
    Octet& o = out[{p[0] >> 1, p[1] >> 1, p[2] >> 1}];
    const auto child = std::size_t((p[0] & 1) + 2 * (p[1] & 1) + 4 * (p[2] & 1));
    o.child[child] = &v;
    o.raster[child] = &rasters.at(p);
  }
  return out;
}

/// Groups the voxels of a level by the voxel, `levels` levels coarser, that contains them.
std::map<Voxel, Finer> finer_of(const VoxelMap& fine, int levels) {
  std::map<Voxel, Finer> out;
  for (const auto& [p, v] : fine) out[p >> levels].push_back(&v);
  return out;
}

/// The sides that normals point to while a mean is computed.
enum class Sides {
  as_stored,
  as_the_first  ///< normals at least 135° from the first normal are turned
};

/// Checks that colour and normal are the weighted means of the finer voxels.
void expect_mean(const BakedVoxel& parent, const Finer& finer, const std::vector<double>& weight, Sides sides) {
  const double opposite = -std::sqrt(0.5);
  double sum = 0;
  Vec3d colour{};
  Direction normal{};
  std::optional<Direction> first;
  bool is_certain = true;
  for (std::size_t c = 0; c < finer.size(); ++c) {
    if (finer[c] == nullptr || weight[c] == 0) continue;
    Direction n = direction_of(finer[c]->normal);
    if (!first) first = n;
    const double along = dot(n, *first);
    is_certain = is_certain && std::abs(along - opposite) > 1e-3;
    if (sides == Sides::as_the_first && along < opposite) n = n * -1;
    sum += weight[c];
    colour += Vec3d::by_axis([&](std::size_t k) { return linear_of(finer[c]->rgba[k] / 255.0); }) * weight[c];
    normal += n * weight[c];
  }
  // Rounding in the 16-bit table of linear values costs at most 0.05 codes, where sRGB is steepest.
  for (std::size_t c = 0; c < 3; ++c) ASSERT_LE(code_error(parent.rgba[c], colour[c] / sum), 0.6) << "channel " << c;
  if (length(normal) / sum > 1e-2 && (is_certain || sides == Sides::as_stored)) {
    ASSERT_LE(angle_deg(direction_of(parent.normal), normal), octahedral_error_deg + 0.05);
  }
}

/// Checks a parent against its finer voxels. `places` is the number of finer voxels that fit into the parent, whether
/// they exist or not.
void expect_parent_by_mean(const BakedVoxel& parent, const Finer& finer, int places, MipFilter filter) {
  std::vector<double> alpha;
  double mean = 0;
  for (const BakedVoxel* v : finer) {
    alpha.push_back(v->rgba[3] / 255.0);
    mean += alpha.back() / places;
  }
  const double expected = 255 * (filter == MipFilter::box ? mean : std::pow(mean, 1 - mean));
  ASSERT_LE(std::abs(parent.rgba[3] - std::max(1.0, expected)), 0.5 + 1e-9) << "alpha";
  expect_mean(parent, finer, alpha, Sides::as_stored);
}

void expect_parent_by_view(const BakedVoxel& parent, const Octet& o, const Views& views) {
  const int edge = views.fine.edge;
  int maximum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    int sum = 0;
    for (const int cell : views.fine.cells[axis]) sum += cell;
    const int directional_coverage = std::max(1, rounded(sum, edge * edge));
    ASSERT_EQ(int(parent.directional_coverage[axis]),
              is_fully_planar(parent.directional_coverage[directional_coverage_plane]) ? 0 : directional_coverage)
        << axis;
    maximum = std::max(maximum, directional_coverage);
  }
  ASSERT_EQ(int(parent.rgba[3]), maximum) << "alpha";
  const long six_sides = 6L * (edge / 2) * (edge / 2);
  std::vector<double> weight(8);
  double sum = 0;
  for (std::size_t c = 0; c < 8; ++c) sum += weight[c] = double((views.seen[c] + six_sides - 1) / six_sides);
  if (sum == 0) weight.assign(8, 1);
  expect_mean(parent, o.child, weight, Sides::as_the_first);
}

/// Checks a level against the finer level and its rasters. Replaces `rasters` by the rasters of the checked level.
void expect_level_by_view(const VoxelMap& fine, const VoxelMap& coarse, Rasters& rasters) {
  const auto octets = octets_of(fine, rasters);
  Rasters coarse_rasters;
  ASSERT_EQ(coarse.size(), octets.size());
  for (const auto& [position, octet] : octets) {
    ASSERT_TRUE(coarse.count(position));
    const Views views = look_at(octet);
    ASSERT_NO_FATAL_FAILURE(expect_parent_by_view(coarse.at(position), octet, views));
    coarse_rasters[position] = stored_raster(views.fine);
  }
  rasters = std::move(coarse_rasters);
}

/// Checks a level against the level that is `levels` finer.
void expect_level_by_mean(const VoxelMap& fine, int levels, const VoxelMap& coarse, MipFilter filter) {
  const auto all = finer_of(fine, levels);
  ASSERT_EQ(coarse.size(), all.size());
  for (const auto& [position, finer] : all) {
    ASSERT_TRUE(coarse.count(position));
    ASSERT_NO_FATAL_FAILURE(expect_parent_by_mean(coarse.at(position), finer, 1 << 3 * levels, filter));
  }
}

void expect_levels(const BakeScene& scene, const CellVolume& volume) {
  const MipFilter filter = scene.parameters.mip;
  std::vector<VoxelMap> level{voxels_at(volume, scene.parameters, 0)};
  Rasters rasters = rasters_of_finest(level[0]);
  for (std::size_t lod = 1; lod < volume.levels.size(); ++lod) {
    SCOPED_TRACE("lod " + std::to_string(lod));
    level.push_back(voxels_at(volume, scene.parameters, int(lod)));
    const std::size_t below = filter == MipFilter::thesis && lod >= 2 ? 2 : 1;
    if (filter == MipFilter::coverage)
      expect_level_by_view(level[lod - 1], level[lod], rasters);
    else
      expect_level_by_mean(level[lod - below], int(below), level[lod], filter);
    if (testing::Test::HasFatalFailure()) return;
  }
}

/// Fills [low, high)³ with parallel squares in every layer of voxels. All voxels there are present and equal.
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

class Levels : public testing::TestWithParam<MipFilter> {
 protected:
  /// Returns an empty scene with the filter under test, and a window of edge³ voxels from `lowest` on.
  static BakeScene empty_scene(const Voxel& lowest, std::uint32_t edge) {
    BakeScene scene;
    scene.set_window(lowest, edge);
    scene.parameters.mip = GetParam();
    return scene;
  }
};

TEST_P(Levels, AreTheFiltersOfFinerLevelsForRandomTranslucentScenes) {
  const std::uint64_t seed = 91;
  Rng rng(seed);
  for (int i = 0; i < 12; ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", scene " + std::to_string(i));
    BakeScene scene = empty_scene({-32, 64, -64}, 64);
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
  BakeScene scene = empty_scene({0, 0, 0}, 64);
  scene.parameters.normals = false;
  fill(scene, {0, 0, 0}, {64, 64, 64}, scene.add_colour({50000, 20000, 1000, 65535}));
  const CellVolume volume = scene.bake();
  ASSERT_EQ(volume.nodes.kind.size(), 1u);
  EXPECT_EQ(volume.nodes.kind[0], NodeKind::leaf_constant);
  for (const Level& level : volume.levels) EXPECT_TRUE(level.key.empty());
  EXPECT_EQ(voxels_at(volume, scene.parameters, 0).size(), 64u * 64 * 64);
  expect_levels(scene, volume);
}

/// One voxel has a triangle of another colour. Only the branch to this voxel is expanded; the other branches stay
/// leaves.
TEST_P(Levels, OfAFilledBlockWithOneOddVoxelKeepTheOddVoxel) {
  BakeScene scene = empty_scene({0, 0, 0}, 64);
  scene.parameters.normals = false;
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
  BakeScene scene = empty_scene({-64, 0, 64}, 64);
  fill(scene, {-64, 0, 64}, {-20, 40, 100}, 0);
  const CellVolume volume = scene.bake();
  EXPECT_EQ(voxels_at(volume, scene.parameters, 0).size(), 44u * 40 * 36);
  expect_levels(scene, volume);
}

/// Layers of two colours give equal parents and different children.
TEST_P(Levels, OfAStripedBlockAreConstantAboveAndBricksBelow) {
  BakeScene scene = empty_scene({0, 0, 0}, 32);
  const std::uint32_t stripes[2] = {scene.add_colour({65535, 0, 0, 65535}), scene.add_colour({0, 65535, 0, 65535})};
  for (std::int64_t z = 0; z < 32; ++z) fill(scene, {0, 0, z}, {32, 32, z + 1}, stripes[z % 2]);
  const CellVolume volume = scene.bake();
  EXPECT_EQ(volume.levels[0].key.size(), 64u);
  EXPECT_TRUE(volume.levels[1].key.empty());
  for (std::size_t n = 0; n < volume.nodes.kind.size(); ++n)
    EXPECT_EQ(volume.nodes.kind[n], volume.nodes.lod[n] == 0 ? NodeKind::brick : NodeKind::constant);
  expect_levels(scene, volume);
}

/// Bakes one layer of opaque voxels across the whole window. All voxels of a level are equal.
CellVolume bake_sheet(BakeScene& scene, std::size_t axis, std::int64_t layer, std::int64_t edge) {
  const std::int64_t h = layer * 256 + 100, far = edge * 256;
  const auto corner = [&](std::int64_t u, std::int64_t v) {
    LatticeVertex p{};
    p[axis] = h, p[(axis + 1) % 3] = u, p[(axis + 2) % 3] = v;
    return p;
  };
  scene.set_window({0, 0, 0}, std::uint32_t(edge));
  scene.parameters.mip = MipFilter::thesis;
  scene.add_mesh(
      {{{corner(0, 0), corner(far, 0), corner(far, far)}}, {{corner(0, 0), corner(far, far), corner(0, far)}}},
      scene.add_colour({50000, 20000, 1000, 65535}));
  return scene.bake();
}

/// Expected alphas: 1, ½^½, (16/64)^(1 - 16/64), then m^(1 - m), where m is a quarter of the alpha two levels below.
TEST(LevelsByThesis, OfAFlatOpaqueSheetAreTheThesissInCellsOfEverySize) {
  const std::array<double, 5> thesis{1, .707, .354, .240, .110};
  const std::array<int, 7> code{255, 180, 90, 61, 28, 18, 8};
  for (std::size_t lod = 0; lod < thesis.size(); ++lod)
    EXPECT_NEAR(code[lod] / 255.0, thesis[lod], .5 / 255 + .0005) << "lod " << lod;
  for (const std::int64_t edge : {8, 16, 32, 64, 128, 512})
    for (std::size_t axis = 0; axis < (edge < 512 ? 3 : 1); ++axis) {
      SCOPED_TRACE("edge " + std::to_string(edge) + ", axis " + std::to_string(axis));
      BakeScene scene;
      const CellVolume volume = bake_sheet(scene, axis, edge * 3 / 8, edge);
      ASSERT_EQ(edge, 8 << (volume.levels.size() - 1));
      for (std::size_t lod = 0; lod < volume.levels.size(); ++lod) {
        const VoxelMap voxels = voxels_at(volume, scene.parameters, int(lod));
        ASSERT_EQ(voxels.size(), std::size_t((edge >> lod) * (edge >> lod))) << "lod " << lod;
        for (const auto& [position, v] : voxels) {
          ASSERT_EQ(v.rgba[3], code[lod]) << "lod " << lod;
          ASSERT_EQ(v.normal, voxels.begin()->second.normal);
        }
      }
    }
}

/// Checks the table's order and links as promised by kernels/body/cell.h and format/shard/shard.h.
void expect_tree(const NodeTable& nodes, int lods) {
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
