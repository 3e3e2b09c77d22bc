// Cells whose parts have several levels, compared with cells of one level, which other tests compare with exact
// references.
#include "kernels/cpu/voxelize/stored_depth.h"

#include <array>
#include <bit>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "core/octree/morton.h"
#include "kernels/cpu/bake_cell.h"
#include "kernels/cpu/voxelize/clip.h"
#include "tests/random_seed.h"

namespace gigabake::kernels {
namespace {

constexpr int coarse_lod = 3;
constexpr std::uint32_t window_voxels = 128;

using Positions = std::set<Vec3i64>;
using VoxelMap = std::map<Vec3i64, std::array<std::uint8_t, 8>>;

/// Parts of opaque triangles with one level each.
class LevelledParts {
 public:
  LevelledParts() {
    material_.base_rgba[0] = 60000, material_.base_rgba[1] = 20000, material_.base_rgba[2] = 40000;
    material_.base_rgba[3] = 65535;
  }
  void add(int lod, std::vector<float> position) {
    position_.push_back(std::move(position));
    lod_.push_back(lod);
    std::vector<std::uint32_t> index;
    for (std::uint32_t i = 0; i < position_.back().size() / 3; ++i) index.push_back(i);
    index_.push_back(std::move(index));
  }

  /// Returns the parts of levels from `finest` to `coarsest`, all at `as_lod` unless it is -1.
  CellInput input(int finest, int coarsest, int as_lod) {
    parts_.clear();
    for (std::size_t i = 0; i < lod_.size(); ++i) {
      if (lod_[i] < finest || lod_[i] > coarsest) continue;
      PartView part;
      part.position = {position_[i].data(), position_[i].size()};
      part.index = {index_[i].data(), index_[i].size()};
      for (const int diagonal : {0, 5, 10}) part.scene_from_local[diagonal] = 1;
      part.lod = as_lod < 0 ? lod_[i] : as_lod;
      parts_.push_back(part);
    }
    return {{parts_.data(), parts_.size()}, {&material_, 1}, {}};
  }

 private:
  MaterialView material_;
  std::vector<std::vector<float>> position_;
  std::vector<std::vector<std::uint32_t>> index_;
  std::vector<int> lod_;
  std::vector<PartView> parts_;
};

CellParameters parameters_of(MipFilter mip, SurfaceRule rule) {
  CellParameters p;
  p.window_voxels = window_voxels;
  p.mip = mip;
  p.surface = rule;
  return p;
}

/// A coarse slope through the window, and fine triangles: some anywhere, and some that end at faces, edges and corners
/// of octants and bricks.
LevelledParts slope_with_fine_triangles(std::mt19937_64& random) {
  LevelledParts parts;
  const float w = float(window_voxels);
  parts.add(coarse_lod, {0, 0, 40, w, 0, 40, w, w, 80, 0, 0, 40, w, w, 80, 0, w, 80});
  const auto coordinate = [&](int step) { return float(int(random() % (window_voxels / unsigned(step))) * step); };
  std::vector<float> fine, middle;
  for (int i = 0; i < 6; ++i)
    for (const int step : {1, 4, 8, 16, 32}) {
      const std::array<float, 3> at = {coordinate(step), coordinate(step), coordinate(step)};
      for (int corner = 0; corner < 3; ++corner)
        for (int a = 0; a < 3; ++a) {
          const float side = (random() % 2 == 0 ? -1.0f : 1.0f) * float(1 + random() % 3);
          (i % 2 == 0 ? fine : middle).push_back(at[std::size_t(a)] + (corner == a ? side : 0));
        }
    }
  parts.add(0, std::move(fine));
  parts.add(1, std::move(middle));
  return parts;
}

Vec3i64 position_of(std::uint64_t key, int z, int bit) {
  return static_cast<Vec3i64>(demorton(key)) * std::int64_t(brick_edge) + Vec3i64{bit & 7, bit >> 3, z};
}

/// Returns the colour, the normal and the plane of each voxel.
VoxelMap values_of(const Level& level) {
  VoxelMap out;
  std::size_t voxel = 0;
  for (std::size_t b = 0; b < level.key.size(); ++b)
    for (int z = 0; z < brick_edge; ++z)
      for (std::uint64_t rest = level.mask[8 * b + std::size_t(z)]; rest != 0; rest &= rest - 1, ++voxel) {
        std::array<std::uint8_t, 8> value{};
        std::copy_n(&level.rgba[4 * voxel], 4, value.begin());
        for (std::size_t c = 0; c < 2; ++c) value[4 + c] = std::uint8_t(level.normal[2 * voxel + c]);
        if (!level.directional_coverage.empty())
          value[6] = level.directional_coverage[directional_coverage_bytes * voxel + directional_coverage_plane];
        out[position_of(level.key[b], z, std::countr_zero(rest))] = value;
      }
  return out;
}

/// Returns the voxels of lod 0 of a cell whose parts are all of one level, with `lod` as its level 0.
VoxelMap plain_voxels(LevelledParts& parts, int finest, int coarsest, int lod, const CellParameters& parameters) {
  const CellParameters p = at_level(parameters, lod);
  const CellVolume volume = bake_cell(parts.input(finest, coarsest, 0), p, callers_thread());
  if (volume.levels.empty()) return {};
  // Constant bricks have no voxels here: the tests' surfaces are thin.
  return values_of(volume.levels[0]);
}

/// Returns the octants of level `lod` that are refined: those with voxels that parts of finer levels occupy.
Positions refined_octants(LevelledParts& parts, int lod, const CellParameters& parameters) {
  Positions refined;
  for (int finer = 0; finer < lod; ++finer)
    for (const auto& [at, value] : plain_voxels(parts, finer, finer, finer, parameters))
      refined.insert(at >> (lod - finer + 2));
  return refined;
}

/// The leaves of a volume by level, from its nodes.
std::vector<VoxelMap> leaves_of(const CellVolume& volume) {
  std::vector<VoxelMap> leaves(volume.levels.size());
  const NodeTable& n = volume.nodes;
  for (std::size_t i = 0; i < n.leaf_mask.size(); ++i) {
    if (n.leaf_mask[i] == 0) continue;
    EXPECT_EQ(n.kind[i], NodeKind::brick);
    EXPECT_EQ(n.leaf_mask[i] & n.child_mask[i], 0);
    for (const auto& [at, value] : values_of(volume.levels[n.lod[i]])) {
      const Vec3i64 brick = at >> 3, octant = (at >> 2) - (at >> 3) * 2;
      if (brick == static_cast<Vec3i64>(demorton(n.key[i])) &&
          (n.leaf_mask[i] >> (octant[0] | octant[1] << 1 | octant[2] << 2) & 1) != 0)
        leaves[n.lod[i]][at] = value;
    }
  }
  return leaves;
}

CellVolume mixed_volume(LevelledParts& parts, const CellParameters& parameters, const ThreadPool& pool) {
  return bake_cell(parts.input(0, coarse_lod, -1), parameters, pool);
}

TEST(StoredDepth, VoxelizesEachOctantAtOneLevelAsACellOfThatLevelDoes) {
  const gigabake::test::RandomSeed seed;
  std::mt19937_64 random(seed);
  for (const SurfaceRule rule : {SurfaceRule::area, SurfaceRule::conservative, SurfaceRule::thin})
    for (const MipFilter mip : {MipFilter::coverage, MipFilter::box}) {
      SCOPED_TRACE(std::string(name_of(rule)) + ", " + std::string(name_of(mip)));
      LevelledParts parts = slope_with_fine_triangles(random);
      const CellParameters parameters = parameters_of(mip, rule);
      const CellVolume volume = mixed_volume(parts, parameters, ThreadPool(2));
      const std::vector<VoxelMap> leaves = leaves_of(volume);
      VoxelMap finest;
      const Positions bricks = refined_octants(parts, 1, parameters);
      for (const auto& [at, value] : plain_voxels(parts, 0, coarse_lod, 0, parameters))
        if (bricks.contains(at >> 3)) finest[at] = value;
      EXPECT_EQ(values_of(volume.levels[0]), finest);
      EXPECT_FALSE(finest.empty());
      for (int lod = 1; lod <= coarse_lod; ++lod) {
        const Positions refined = refined_octants(parts, lod, parameters),
                        voxelized = refined_octants(parts, lod + 1, parameters);
        VoxelMap expected;
        for (const auto& [at, value] : plain_voxels(parts, lod, coarse_lod, lod, parameters))
          if (!refined.contains(at >> 2) && voxelized.contains(at >> 3)) expected[at] = value;
        EXPECT_EQ(leaves[std::size_t(lod)], expected) << lod;
        EXPECT_FALSE(expected.empty()) << lod;
      }
      for (std::size_t lod = coarse_lod + 1; lod < leaves.size(); ++lod) EXPECT_TRUE(leaves[lod].empty());
    }
}

TEST(StoredDepth, DescribesEachVoxelOfFullDepthOnceAndNoEmptyCube) {
  const gigabake::test::RandomSeed seed;
  std::mt19937_64 random(seed);
  LevelledParts parts = slope_with_fine_triangles(random);
  const CellParameters parameters = parameters_of(MipFilter::coverage, SurfaceRule::area);
  const CellVolume volume = mixed_volume(parts, parameters, ThreadPool(2));
  const std::vector<VoxelMap> leaves = leaves_of(volume);
  const VoxelMap finest = values_of(volume.levels[0]), full = plain_voxels(parts, 0, coarse_lod, 0, parameters);
  std::vector<Positions> used(leaves.size());
  for (const auto& [at, value] : full) {
    int described = finest.contains(at) ? 1 : 0;
    for (std::size_t lod = 1; lod < leaves.size(); ++lod)
      if (leaves[lod].contains(at >> int(lod))) ++described, used[lod].insert(at >> int(lod));
    EXPECT_EQ(described, 1);
  }
  for (std::size_t lod = 1; lod < leaves.size(); ++lod) EXPECT_EQ(used[lod].size(), leaves[lod].size());
}

TEST(StoredDepth, FiltersCoarserLevelsFromChildrenAndLeaves) {
  const gigabake::test::RandomSeed seed;
  std::mt19937_64 random(seed);
  LevelledParts parts = slope_with_fine_triangles(random);
  const CellParameters parameters = parameters_of(MipFilter::coverage, SurfaceRule::area);
  const CellVolume volume = mixed_volume(parts, parameters, callers_thread());
  const std::vector<VoxelMap> leaves = leaves_of(volume);
  for (std::size_t lod = 1; lod < volume.levels.size(); ++lod) {
    Positions expected;
    for (const auto& [at, value] : values_of(volume.levels[lod - 1])) expected.insert(at >> 1);
    for (const auto& [at, value] : leaves[lod]) EXPECT_TRUE(expected.insert(at).second) << lod;
    Positions found;
    for (const auto& [at, value] : values_of(volume.levels[lod])) found.insert(at);
    EXPECT_EQ(found, expected) << lod;
  }
  for (const auto& [at, value] : values_of(volume.levels[coarse_lod + 1])) EXPECT_GT(value[3], 0);
}

TEST(StoredDepth, DoesNotDependOnThreadsAndMemory) {
  const gigabake::test::RandomSeed seed;
  std::mt19937_64 random(seed);
  LevelledParts parts = slope_with_fine_triangles(random);
  CellParameters parameters = parameters_of(MipFilter::coverage, SurfaceRule::area);
  const CellVolume one = mixed_volume(parts, parameters, callers_thread());
  parameters.memory_bytes = 1;
  const CellVolume other = mixed_volume(parts, parameters, ThreadPool(3));
  EXPECT_EQ(one.content_hash, other.content_hash);
  EXPECT_EQ(one.nodes.leaf_mask, other.nodes.leaf_mask);
  EXPECT_EQ(one.above, other.above);
}

TEST(StoredDepth, DoesNotDependOnTheWindow) {
  const gigabake::test::RandomSeed seed;
  std::mt19937_64 random(seed);
  LevelledParts parts = slope_with_fine_triangles(random);
  const CellParameters parameters = parameters_of(MipFilter::coverage, SurfaceRule::area);
  const CellVolume whole = mixed_volume(parts, parameters, callers_thread());
  std::vector<VoxelMap> found(coarse_lod + 1);
  for (int part = 0; part < 8; ++part) {
    CellParameters p = parameters;
    p.window_voxels = window_voxels / 2;
    const Vec3i64 min = Vec3i64{part & 1, part >> 1 & 1, part >> 2} * std::int64_t(window_voxels / 2);
    p.window_min = min;
    const CellVolume volume = mixed_volume(parts, p, callers_thread());
    for (int lod = 0; lod <= coarse_lod && !volume.levels.empty(); ++lod)
      for (const auto& [at, value] : values_of(volume.levels[std::size_t(lod)]))
        found[std::size_t(lod)][at + (min >> lod)] = value;
  }
  for (int lod = 0; lod <= coarse_lod; ++lod)
    EXPECT_EQ(found[std::size_t(lod)], values_of(whole.levels[std::size_t(lod)])) << lod;
}

TEST(StoredDepth, RefinesWhatEditsSelect) {
  LevelledParts parts;
  const float w = float(window_voxels);
  parts.add(coarse_lod, {0, 0, 41, w, 0, 41, w, w, 41, 0, 0, 41, w, w, 41, 0, w, 41});
  CellParameters parameters = parameters_of(MipFilter::coverage, SurfaceRule::area);
  const std::uint64_t edited = morton(3, 4, 5);  // a brick with surface
  Positions before;
  LevelEdits edits;
  edits.for_each_selected = [&](const std::function<void(std::uint64_t)>& visit) { visit(edited); };
  edits.filled_voxels = [](std::uint64_t, std::uint64_t) { return std::uint64_t(0); };
  edits.apply = [&](Level& level, std::uint64_t, std::uint64_t) {
    for (const auto& [at, value] : values_of(level)) before.insert(at);
    keep_voxels(
        level, [](std::uint64_t) { return VoxelMask{}; }, callers_thread());
  };
  parameters.edits = &edits;
  const CellVolume volume = mixed_volume(parts, parameters, callers_thread());
  ASSERT_EQ(before.size(), 64u) << "the surface in the brick, one voxel high";
  for (const Vec3i64& at : before) EXPECT_EQ(at >> 3, (Vec3i64{3, 4, 5}));
  EXPECT_TRUE(volume.levels[0].key.empty()) << "the edit removed it";
  // The octants of the brick and of its ancestors are no leaves; all others are.
  const std::vector<VoxelMap> leaves = leaves_of(volume);
  std::uint64_t covered = 0;
  for (int lod = 1; lod <= coarse_lod; ++lod) covered += leaves[std::size_t(lod)].size() << 2 * lod;
  EXPECT_EQ(covered, window_voxels * window_voxels - 64);
}

}  // namespace
}  // namespace gigabake::kernels
