/// Levels above the cells are the same for any division of the scene into cells and blocks.
#include "kernels/cpu/mip/overview.h"

#include <bit>
#include <gtest/gtest.h>
#include <random>

#include "core/base/error.h"
#include "kernels/cpu/bake_cell.h"
#include "tests/kernels/cuda_scenes.h"
#include "tests/random_seed.h"

namespace gigabake::kernels {
namespace {

constexpr std::uint32_t whole_voxels = 128;
constexpr int whole_lods = 5;

struct OverviewRules {
  MipFilter mip = MipFilter::coverage;
  bool normals = true, directional_coverage = true;
  std::uint32_t max_error = 0;
  bool classes = false;
};

CellParameters parameters_of(const test::TestCell& cell, const OverviewRules& rules) {
  CellParameters p = cell.parameters(SurfaceRule::area, rules.mip, rules.normals);
  p.window_voxels = whole_voxels;
  p.directional_coverage = rules.directional_coverage;
  p.max_error = rules.max_error;
  p.classes = rules.classes;
  return p;
}

/// Returns parts of at most 200 triangles of the cell, with five classes in turn.
std::vector<PartView> classified_parts(const CellInput& input) {
  constexpr std::size_t corners = 600, classes = 5;
  std::vector<PartView> parts;
  for (std::size_t p = 0; p < input.parts.size; ++p)
    for (std::size_t at = 0; at < input.parts[p].index.size; at += corners) {
      PartView part = input.parts[p];
      part.index = {part.index.data + at, std::min(corners, part.index.size - at)};
      part.voxel_class = VoxelClass(parts.size() % classes);
      parts.push_back(part);
    }
  return parts;
}

/// A baked cell or overview, with its position.
struct Baked {
  DownsampleState source;
  Vec3i64 min;
};

/// A scene that is baked in cells, and then in larger and larger blocks up to one. The hashes of each level are summed.
class InBlocks {
 public:
  InBlocks(const CellInput& input, const CellParameters& parameters, std::mt19937& random)
      : input_(input), parameters_(parameters), random_(random) {}

  /// Returns the hashes of all levels. `z_shift`, 0 to 7, moves the cells by an eighth of their edge per unit.
  std::vector<Hash128> hashes(std::uint32_t cell_voxels, std::int64_t z_shift) {
    bake_cells(cell_voxels, z_shift);
    std::int64_t edge = cell_voxels;
    while (edge < whole_voxels) {
      int levels = 1 + int(random_() % 3);
      while (edge << levels > whole_voxels) --levels;
      bake_overviews(edge, levels);
      edge <<= levels;
    }
    return hash_;
  }
  const std::vector<Baked>& baked() const { return baked_; }

 private:
  void bake_cells(std::uint32_t cell_voxels, std::int64_t z_shift) {
    const std::int64_t n = cell_voxels, whole = whole_voxels, z_min = (z_shift - 8) * n / 8 % n;
    for (std::int64_t z = z_min; z < whole; z += n)
      for (std::int64_t y = 0; y < whole; y += n)
        for (std::int64_t x = 0; x < whole; x += n) {
          CellParameters p = parameters_;
          p.window_voxels = cell_voxels;
          p.window_min = {x, y, z};
          keep(bake_cell(input_, p, pool_), 0, {x, y, z});
        }
  }

  void bake_overviews(std::int64_t child_edge, int levels) {
    std::vector<Baked> below = std::move(baked_);
    baked_.clear();
    std::shuffle(below.begin(), below.end(), random_);
    std::vector<JoinedChild> children;
    for (const Baked& b : below) children.push_back({&b.source, b.min});
    const std::int64_t edge = child_edge << levels, whole = whole_voxels;
    for (std::int64_t z = 0; z < whole; z += edge)
      for (std::int64_t y = 0; y < whole; y += edge)
        for (std::int64_t x = 0; x < whole; x += edge) {
          OverviewParameters p{{x, y, z}, int(std::bit_width(std::uint64_t(child_edge / 8))) - 1, levels};
          p.mip = parameters_.mip, p.normals = parameters_.normals,
          p.directional_coverage = parameters_.directional_coverage;
          p.max_error = parameters_.max_error, p.classes = parameters_.classes;
          keep(bake_overview(children, p, pool_), p.child_lod + 1, {x, y, z});
        }
  }

  void keep(CellVolume volume, int first_lod, const Vec3i64& min) {
    if (volume.levels.empty()) return;
    hash_.resize(std::max(hash_.size(), std::size_t(first_lod) + volume.content_hash.size()));
    for (std::size_t l = 0; l < volume.content_hash.size(); ++l)
      hash_[std::size_t(first_lod) + l] += volume.content_hash[l];
    baked_.push_back({std::move(volume.above), min});
  }

  const ThreadPool pool_{2};
  const CellInput input_;
  const CellParameters parameters_;
  std::mt19937& random_;
  std::vector<Baked> baked_;
  std::vector<Hash128> hash_;
};

class OverviewLevels : public testing::TestWithParam<OverviewRules> {};

TEST_P(OverviewLevels, AreThoseOfOneCellOverAllForEverySizeOfCellsAndBlocks) {
  const gigabake::test::RandomSeed seed;
  std::mt19937 random{unsigned(seed)};
  test::TestCell cell = test::ground("", whole_voxels, 30, false, true);
  CellInput input = cell.input();
  const std::vector<PartView> parts = classified_parts(input);
  input.parts = {parts.data(), parts.size()};
  const CellParameters parameters = parameters_of(cell, GetParam());
  CellVolume whole = bake_cell(input, parameters, ThreadPool(2));
  ASSERT_EQ(whole.content_hash.size(), std::size_t(whole_lods));
  for (const std::uint32_t edge : {8u, 16u, 32u, 64u}) {
    // Quantization groups span a brick, and bricks move with the cells.
    const std::int64_t z_shift = GetParam().max_error == 0 ? std::int64_t(random() % 8) : 0;
    InBlocks blocks(input, parameters, random);
    EXPECT_EQ(blocks.hashes(edge, z_shift), whole.content_hash) << "cells of " << edge << ", shifted by " << z_shift;
    ASSERT_EQ(blocks.baked().size(), 1u);
    EXPECT_EQ(blocks.baked()[0].source, whole.above) << "what a level above the root would be made of";
  }
}

INSTANTIATE_TEST_SUITE_P(OfEveryRule, OverviewLevels,
                         testing::Values(OverviewRules{}, OverviewRules{MipFilter::coverage, false},
                                         OverviewRules{MipFilter::coverage, true, false},
                                         OverviewRules{MipFilter::coverage, true, true, 4},
                                         OverviewRules{MipFilter::thesis}, OverviewRules{MipFilter::thesis, false},
                                         OverviewRules{MipFilter::box}, OverviewRules{MipFilter::box, true, true, 9},
                                         OverviewRules{MipFilter::coverage, true, true, 0, true},
                                         OverviewRules{MipFilter::coverage, false, false, 4, true},
                                         OverviewRules{MipFilter::box, true, true, 0, true}));

TEST(Overview, OfChildrenWithoutVoxelsHasNone) {
  const DownsampleState nothing;
  const JoinedChild child{&nothing, {}};
  EXPECT_TRUE(bake_overview(std::span(&child, 1), {{}, 3, 3}, ThreadPool(1)).levels.empty());
}

TEST(Overview, RefusesChildrenThatOverlapOrDoNotFitItsRules) {
  test::TestCell cell = test::ground("", 64, 10, false, true);
  const CellVolume volume =
      bake_cell(cell.input(), cell.parameters(SurfaceRule::area, MipFilter::coverage, true), ThreadPool(1));
  const JoinedChild twice[2] = {{&volume.above, {}}, {&volume.above, {}}};
  OverviewParameters p{{}, 3, 2};
  EXPECT_NO_THROW(bake_overview(std::span(twice, 1), p, ThreadPool(1)));
  EXPECT_THROW(bake_overview(twice, p, ThreadPool(1)), InputError);
  p.mip = MipFilter::thesis;
  EXPECT_THROW(bake_overview(std::span(twice, 1), p, ThreadPool(1)), InputError);
  DownsampleState torn = volume.above;
  torn.raster.pop_back();
  const JoinedChild child{&torn, {}};
  EXPECT_THROW(bake_overview(std::span(&child, 1), {{}, 3, 2}, ThreadPool(1)), InputError);
  OverviewParameters with_classes{{}, 3, 2};
  with_classes.classes = true;
  EXPECT_THROW(bake_overview(std::span(twice, 1), with_classes, ThreadPool(1)), InputError);
}

}  // namespace
}  // namespace gigabake::kernels
