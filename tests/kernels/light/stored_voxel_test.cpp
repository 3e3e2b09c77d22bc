#include "kernels/light/stored_voxel.h"

#include <algorithm>
#include <array>
#include <bit>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "kernels/marching/scene.h"

namespace gigabake::kernels {
namespace {

constexpr int lod = 2;

/// Random columns of a page.
struct RandomPage {
  std::vector<std::uint8_t> rgba, directional_coverage;
  std::vector<std::int8_t> normal;

  RandomPage(std::size_t voxels, std::mt19937_64& random)
      : rgba(4 * voxels), directional_coverage(4 * voxels), normal(2 * voxels) {
    for (std::uint8_t& value : rgba) value = std::uint8_t(random());
    for (std::uint8_t& value : directional_coverage) value = std::uint8_t(random() % 64);
    for (std::int8_t& value : normal) value = std::int8_t(random());
  }
  StoredVoxels voxels() const { return {rgba.data(), normal.data(), directional_coverage.data(), nullptr}; }
};

/// A slot whose voxels are copies of random voxels of two pages, and its runs.
struct CopiedSlot {
  SlotVoxels slot;
  std::vector<VoxelRun> runs;

  CopiedSlot(const StoredVoxelShading& shading, const std::array<StoredVoxels, max_brick_pages>& pages,
             std::uint32_t page_voxels, std::mt19937_64& random) {
    for (int z = 0; z < slot_edge; ++z)
      for (int y = 0; y < slot_edge; ++y) {
        if (random() % 3 == 0) continue;
        add_run(shading, pages, page_voxels, random, y, z, std::uint16_t(random() & 255 & random()), 0);
        if (random() % 2 == 0) add_run(shading, pages, page_voxels, random, y, z, 1 << 8, 1);
      }
  }

 private:
  void add_run(const StoredVoxelShading& shading, const std::array<StoredVoxels, max_brick_pages>& pages,
               std::uint32_t page_voxels, std::mt19937_64& random, int y, int z, std::uint16_t row, std::uint8_t page) {
    if (row == 0) return;
    const std::uint32_t from = std::uint32_t(random() % (page_voxels - 8));
    const auto place = [&](int x) { return x + slot_edge * (y + slot_edge * z); };
    runs.push_back({from, std::uint16_t(place(std::countr_zero(row))), std::uint8_t(std::popcount(row)), page});
    slot.row[z][y] = std::uint16_t(slot.row[z][y] | row);
    std::uint32_t i = from;
    for (std::uint32_t rest = row; rest != 0; rest &= rest - 1)
      slot.voxel[place(std::countr_zero(rest))] = shaded_voxel(shading, lod, pages[page], i++);
  }
};

bool operator==(const PackedVoxel& a, const PackedVoxel& b) { return std::ranges::equal(a.word, b.word); }

void expect_equal(const CastBrick& brick, const CastBrick& expected) {
  EXPECT_EQ(brick.head.blocks, expected.head.blocks);
  EXPECT_EQ(brick.head.layers, expected.head.layers);
  ASSERT_EQ(brick.part_count, expected.part_count);
  ASSERT_EQ(brick.parts.size(), expected.parts.size());
  for (std::size_t i = 0; i < brick.parts.size(); ++i) EXPECT_TRUE(brick.parts[i] == expected.parts[i]) << i;
}

/// A brick that is copied from pages, or from a pool of pages, equals the brick that is packed from its voxels.
TEST(StoredVoxels, CopiesOfRunsEqualPackedVoxels) {
  constexpr unsigned seed = 5;
  constexpr std::uint32_t page_voxels = 1000;
  std::mt19937_64 random(seed);
  const std::vector<std::uint8_t> coverage(std::size_t(max_cast_lods) * 256, 255);
  StoredVoxelShading shading;
  shading.light = {{0.6f, 0, 0.8f}, {1, 0.9f, 0.8f}, {0.2f, 0.3f, 0.4f}, {0.1f, 0.1f, 0.1f}};
  shading.tables = TableStore::host().view();
  shading.coverage = coverage.data();
  shading.has_normals = true;
  const RandomPage pool(2 * page_voxels, random);
  CastBrick brick;
  brick.lod = lod;
  brick.pages[0] = {0, true, false};
  brick.pages[1] = {page_voxels, true, false};
  std::array<StoredVoxels, max_brick_pages> pages;
  for (std::size_t i = 0; i < 2; ++i) pages[i] = voxels_of(pool.voxels(), brick.pages[i]);
  for (int round = 0; round < 300; ++round) {
    const CopiedSlot copied(shading, pages, page_voxels, random);
    CastBrick expected;
    pack_brick(copied.slot, expected);
    pack_layers(copied.slot, brick);
    brick.runs = copied.runs;
    ASSERT_EQ(brick.part_count, expected.part_count);
    CastBrick pooled = brick;
    pooled.parts.resize(pooled.part_count);
    copy_pooled_runs(shading, pool.voxels(), pooled, pooled.parts.data());
    expect_equal(pooled, expected);
    copy_runs(shading, pages, brick);
    EXPECT_TRUE(brick.runs.empty());
    expect_equal(brick, expected);
  }
}

/// The table of colours of classes has an entry for content without a class, and twelve in turn.
TEST(StoredVoxels, ClassesUseTheColoursInTurn) {
  std::vector<std::uint8_t> table;
  for (int i = 0; i < 3 * (1 + class_colour_count); ++i) table.push_back(std::uint8_t(i));
  EXPECT_EQ(colour_of_class(table.data(), no_class) - table.data(), 0);
  EXPECT_EQ(colour_of_class(table.data(), 1) - table.data(), 3);
  EXPECT_EQ(colour_of_class(table.data(), 12) - table.data(), 36);
  EXPECT_EQ(colour_of_class(table.data(), 13) - table.data(), 3);
  EXPECT_EQ(colour_of_class(table.data(), 65535) - table.data(), 3 * (1 + 65534 % 12));
}

}  // namespace
}  // namespace gigabake::kernels
