// The CUDA backend bakes whole cells to the same bits as the CPU. The tests are skipped, with the reason, if there is
// no GPU.
#include <algorithm>
#include <gtest/gtest.h>

#include "core/base/thread_pool.h"
#include "kernels/cpu/bake_cell.h"
#include "kernels/cuda/baker.h"
#include "tests/kernels/cuda_scenes.h"

namespace gigabake::kernels {
namespace {

void expect_equal(const CellVolume& host, const CellVolume& device) {
  ASSERT_EQ(host.levels.size(), device.levels.size());
  for (std::size_t l = 0; l < host.levels.size(); ++l) {
    const Level &h = host.levels[l], &d = device.levels[l];
    ASSERT_EQ(h.key, d.key) << "lod " << l;
    ASSERT_EQ(h.mask, d.mask) << "lod " << l;
    ASSERT_EQ(h.first, d.first) << "lod " << l;
    ASSERT_EQ(h.rgba, d.rgba) << "lod " << l;
    ASSERT_EQ(h.normal, d.normal) << "lod " << l;
    ASSERT_EQ(h.directional_coverage, d.directional_coverage) << "lod " << l;
  }
  EXPECT_EQ(host.nodes.key, device.nodes.key);
  EXPECT_EQ(host.nodes.lod, device.nodes.lod);
  EXPECT_EQ(host.nodes.kind, device.nodes.kind);
  EXPECT_EQ(host.nodes.child_mask, device.nodes.child_mask);
  EXPECT_EQ(host.nodes.first_child, device.nodes.first_child);
  EXPECT_EQ(host.nodes.value, device.nodes.value);
  EXPECT_EQ(host.nodes.normal, device.nodes.normal);
  EXPECT_EQ(host.nodes.directional_coverage, device.nodes.directional_coverage);
  EXPECT_EQ(host.content_hash, device.content_hash);
  EXPECT_EQ(host.above, device.above);
}

void expect_equal_counts(const CellStats& host, const CellStats& device) {
  EXPECT_EQ(host.triangles, device.triangles);
  EXPECT_EQ(host.non_finite, device.non_finite);
  EXPECT_EQ(host.zero_area, device.zero_area);
  EXPECT_EQ(host.oversized, device.oversized);
  EXPECT_EQ(host.bad_uv, device.bad_uv);
  EXPECT_EQ(host.pairs, device.pairs);
  EXPECT_EQ(host.fragments, device.fragments);
}

class CudaBakerTest : public testing::Test {
 protected:
  void SetUp() override {
    const CudaDevices devices = cuda_devices();
    if (devices.usable.empty()) GTEST_SKIP() << devices.reason;
    baker_ = std::make_unique<CudaBaker>(devices.usable[0], std::uint64_t(64) << 20);
  }

  void expect_same_bits(test::TestCell& cell, const CellParameters& parameters) {
    const CellInput input = cell.input();
    const CellVolume host = bake_cell(input, parameters, pool_), device = baker_->bake_cell(input, parameters);
    expect_equal_counts(host.stats, device.stats);
    expect_equal(host, device);
  }

  ThreadPool pool_{2};
  std::unique_ptr<CudaBaker> baker_;
};

TEST_F(CudaBakerTest, BakesTheSameBitsAsTheCpuForEveryRuleAndFilter) {
  std::list<test::TestCell> cells = test::all_cells();
  for (test::TestCell& cell : cells)
    for (const SurfaceRule rule : {SurfaceRule::area, SurfaceRule::conservative, SurfaceRule::thin})
      for (const MipFilter filter : {MipFilter::coverage, MipFilter::thesis, MipFilter::box}) {
        SCOPED_TRACE(cell.name + ", rule " + std::to_string(int(rule)) + ", filter " + std::to_string(int(filter)));
        expect_same_bits(cell, cell.parameters(rule, filter, filter != MipFilter::box));
      }
}

TEST_F(CudaBakerTest, BakesCellAfterCellWithFewTexturesInItsCache) {
  const CudaDevices devices = cuda_devices();
  baker_ = std::make_unique<CudaBaker>(devices.usable[0], 1);
  std::list<test::TestCell> cells;
  cells.push_back(test::textured_ground());
  cells.push_back(test::bad_triangles());
  for (int round = 0; round < 3; ++round)
    for (test::TestCell& cell : cells)
      expect_same_bits(cell, cell.parameters(SurfaceRule::area, MipFilter::coverage, true));
}

TEST_F(CudaBakerTest, BakesTheSameBitsAsTheCpuWhereVoxelsMayBeOff) {
  std::list<test::TestCell> cells = test::all_cells();
  for (test::TestCell& cell : cells)
    for (const std::uint32_t codes : {1u, 6u, 40u}) {
      SCOPED_TRACE(cell.name + ", error " + std::to_string(codes));
      CellParameters parameters = cell.parameters(SurfaceRule::area, MipFilter::coverage, true);
      parameters.max_error = codes;
      expect_same_bits(cell, parameters);
    }
}

TEST_F(CudaBakerTest, BakesTheSameBitsAsTheCpuWhereCoverageAlongTheAxesIsNotKept) {
  std::list<test::TestCell> cells = test::all_cells();
  for (test::TestCell& cell : cells)
    for (const std::uint64_t bytes : {std::uint64_t(0), std::uint64_t(1)}) {
      SCOPED_TRACE(cell.name + ", bytes " + std::to_string(bytes));
      CellParameters parameters = cell.parameters(SurfaceRule::area, MipFilter::coverage, true);
      parameters.directional_coverage = false;
      parameters.memory_bytes = bytes;
      expect_same_bits(cell, parameters);
    }
}

TEST_F(CudaBakerTest, BakesTheSameBitsInPartsOfAnySize) {
  std::list<test::TestCell> cells = test::all_cells();
  std::uint64_t max_parts = 0;
  for (test::TestCell& cell : cells)
    for (const auto& [rule, filter] :
         {std::pair(SurfaceRule::area, MipFilter::coverage), std::pair(SurfaceRule::conservative, MipFilter::thesis),
          std::pair(SurfaceRule::thin, MipFilter::box)}) {
      CellParameters parameters = cell.parameters(rule, filter, true);
      const CellInput input = cell.input();
      const CellVolume host = bake_cell(input, parameters, pool_);
      for (const std::uint64_t bytes : {std::uint64_t(1), std::uint64_t(1) << 18, std::uint64_t(1) << 22}) {
        SCOPED_TRACE(cell.name + ", rule " + std::to_string(int(rule)) + ", bytes " + std::to_string(bytes));
        parameters.memory_bytes = bytes;
        const CellVolume device = baker_->bake_cell(input, parameters);
        max_parts = std::max(max_parts, device.stats.batches);
        expect_equal_counts(host.stats, device.stats);
        expect_equal(host, device);
      }
    }
  EXPECT_GT(max_parts, 100u);
}

/// Returns edits that remove every second brick and fill bricks with keys that are multiples of 37.
LevelEdits sparse_edits(const CellParameters& parameters) {
  const auto apply = [parameters](Level& level, std::uint64_t first, std::uint64_t end) {
    const auto put = [](Level& to, const Level& from, std::size_t b) {
      to.key.push_back(from.key[b]);
      to.mask.insert(to.mask.end(), &from.mask[8 * b], &from.mask[8 * b] + 8);
      const auto begin = std::ptrdiff_t(from.first[b]), stop = std::ptrdiff_t(from.first[b + 1]);
      to.rgba.insert(to.rgba.end(), from.rgba.begin() + 4 * begin, from.rgba.begin() + 4 * stop);
      if (!from.normal.empty())
        to.normal.insert(to.normal.end(), from.normal.begin() + 2 * begin, from.normal.begin() + 2 * stop);
      if (!from.directional_coverage.empty())
        to.directional_coverage.insert(to.directional_coverage.end(), from.directional_coverage.begin() + 4 * begin,
                                       from.directional_coverage.begin() + 4 * stop);
      to.first.push_back(to.first.back() + std::uint64_t(stop - begin));
    };
    Level filled;
    filled.key = {0}, filled.mask.assign(8, 0), filled.mask[0] = 5, filled.first = {0, 2};
    filled.rgba = {10, 20, 30, 255, 40, 50, 60, 255};
    if (parameters.normals) filled.normal = {0, 0, 127, 0};
    if (has_finest_planes(parameters)) filled.directional_coverage = {0, 0, 0, 35, 0, 0, 0, 0};
    Level out;
    out.first = {0};
    std::size_t b = 0;
    for (std::uint64_t key = first; key < end; ++key) {
      const bool is_stored = b < level.key.size() && level.key[b] == key;
      filled.key[0] = key;
      if (key % 37 == 0)
        put(out, filled, 0);
      else if (is_stored && key % 2 == 0)
        put(out, level, b);
      b += is_stored ? 1 : 0;
    }
    if (out.key.empty()) out = Level();
    level = std::move(out);
  };
  return {apply, [](std::uint64_t first, std::uint64_t end) { return ((end + 36) / 37 - (first + 36) / 37) * 2; }};
}

TEST_F(CudaBakerTest, BakesTheSameBitsAsTheCpuWithEditsAtOnceAndInParts) {
  std::list<test::TestCell> cells = test::all_cells();
  for (test::TestCell& cell : cells)
    for (const std::uint64_t bytes : {std::uint64_t(0), std::uint64_t(1)}) {
      SCOPED_TRACE(cell.name + ", bytes " + std::to_string(bytes));
      CellParameters parameters = cell.parameters(SurfaceRule::area, MipFilter::coverage, true);
      const LevelEdits edits = sparse_edits(parameters);
      parameters.edits = &edits;
      parameters.memory_bytes = bytes;
      expect_same_bits(cell, parameters);
      const CellVolume host = bake_cell({}, parameters, pool_), device = baker_->bake_cell({}, parameters);
      EXPECT_FALSE(host.levels.empty());
      expect_equal(host, device);
    }
}

TEST_F(CudaBakerTest, KeepsToItsMemory) {
  test::TestCell cell = test::ground("large", 2048, 512, false, true);
  CellParameters parameters = cell.parameters(SurfaceRule::area, MipFilter::coverage, true);
  const CellVolume at_once = baker_->bake_cell(cell.input(), parameters);
  EXPECT_EQ(at_once.stats.batches, 1u);
  parameters.memory_bytes = at_once.stats.peak_bytes / 4;
  const CellVolume in_parts = baker_->bake_cell(cell.input(), parameters);
  constexpr std::uint64_t tables = std::uint64_t(1) << 20;
  EXPECT_LE(in_parts.stats.peak_bytes, parameters.memory_bytes + tables);
  EXPECT_GT(in_parts.stats.batches, 1u);
  expect_equal(at_once, in_parts);
}

/// The arrays are sized by the ratios of the cell before. Between flat ground of large triangles and ground of small
/// ones, items, places and voxels all exceed them, in the middle of a level.
TEST_F(CudaBakerTest, ContinuesWhereTheSizesOfTheCellBeforeDoNotSuffice) {
  for (const AlphaMode alpha : {AlphaMode::opaque, AlphaMode::blend}) {
    std::list<test::TestCell> cells;
    for (const int quads : {400, 4, 150, 30, 400})
      cells.push_back(test::ground(std::to_string(quads) + " quads", 1024, quads, false, alpha == AlphaMode::blend));
    for (test::TestCell& cell : cells) {
      cell.materials[0].alpha_mode = alpha;
      SCOPED_TRACE(cell.name + ", alpha mode " + std::to_string(int(alpha)));
      expect_same_bits(cell, cell.parameters(SurfaceRule::area, MipFilter::coverage, true));
    }
  }
}

TEST_F(CudaBakerTest, BakesACellWithoutTriangles) {
  test::TestCell cell;
  cell.materials.push_back({});
  expect_same_bits(cell, cell.parameters(SurfaceRule::area, MipFilter::coverage, true));
}

}  // namespace
}  // namespace gigabake::kernels
