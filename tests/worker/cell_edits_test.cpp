// The edits of a cell: the same voxels in one step and in ranges of bricks.
#include "worker/edit/cell_edits.h"

#include <gtest/gtest.h>

#include "core/octree/morton.h"

namespace gigabake {
namespace {

using kernels::Level;

Edit edit_of(EditType kind, EditShape shape) {
  Edit edit;
  edit.type = kind;
  edit.shape = std::move(shape);
  edit.rgb = {1, 2, 3};
  return edit;
}

/// Returns a level whose every third brick has a voxel in each word.
Level sparse_level(std::uint64_t bricks) {
  Level level;
  level.first = {0};
  for (std::uint64_t key = 0; key < bricks; key += 3) {
    level.key.push_back(key);
    level.mask.insert(level.mask.end(), 8, std::uint64_t(1) << key % 64);
    level.rgba.insert(level.rgba.end(), 32, std::uint8_t(key));
    level.normal.insert(level.normal.end(), 16, std::int8_t(key % 100));
    for (int v = 0; v < 8; ++v) level.directional_coverage.insert(level.directional_coverage.end(), {0, 0, 0, 35});
    level.first.push_back(level.first.back() + 8);
  }
  return level;
}

Level part_of(const Level& level, std::uint64_t first, std::uint64_t end) {
  Level out;
  for (std::size_t b = 0; b < level.key.size(); ++b) {
    if (level.key[b] < first || level.key[b] >= end) continue;
    if (out.first.empty()) out.first.push_back(0);
    const auto voxel = std::ptrdiff_t(level.first[b]);
    out.key.push_back(level.key[b]);
    out.mask.insert(out.mask.end(), level.mask.begin() + 8 * std::ptrdiff_t(b),
                    level.mask.begin() + 8 * std::ptrdiff_t(b) + 8);
    const auto copy = [&](const auto& from, auto& to, std::ptrdiff_t per_voxel, std::ptrdiff_t voxels) {
      to.insert(to.end(), from.begin() + per_voxel * voxel, from.begin() + per_voxel * (voxel + voxels));
    };
    const auto voxels = std::ptrdiff_t(level.first[b + 1] - level.first[b]);
    copy(level.rgba, out.rgba, 4, voxels);
    copy(level.normal, out.normal, 2, voxels);
    copy(level.directional_coverage, out.directional_coverage, 4, voxels);
    out.first.push_back(out.first.back() + std::uint64_t(voxels));
  }
  return out;
}

class CellEditsTest : public testing::Test {
 protected:
  CellEditsTest() {
    parameters_.frame = {1, {}};
    parameters_.window_min = {-128, 0, 64};
    parameters_.window_voxels = 128;
    const auto list = std::make_shared<EditList>();
    list->push_back(edit_of(EditType::carve, SphereShape{{-60, 60, 120}, 30}));
    list->push_back(edit_of(EditType::fill, BoxShape{{-100, 20, 70}, {-50, 61.5, 140}}));
    list->push_back(edit_of(EditType::paint, CylinderShape{{-70, 40, 100}, 20, 50}));
    list->push_back(edit_of(EditType::carve, SphereShape{{500, 500, 500}, 20}));
    in_scene_.emplace(list, std::nullopt, parameters_.frame);
  }

  kernels::CellParameters parameters_;
  std::optional<EditsInScene> in_scene_;
  ThreadPool pool_{2};
};

TEST_F(CellEditsTest, ApplyToRangesOfBricksAsToTheWholeCell) {
  const CellEdits edits(*in_scene_, parameters_, pool_);
  ASSERT_FALSE(edits.empty());
  const kernels::LevelEdits functions = edits.functions();
  constexpr std::uint64_t bricks = 16 * 16 * 16, step = 64;
  Level whole = sparse_level(bricks);
  functions.apply(whole, 0, bricks);
  std::uint64_t filled = 0, found = 0;
  for (std::uint64_t first = 0; first < bricks; first += step) {
    Level part = part_of(sparse_level(bricks), first, first + step);
    functions.apply(part, first, first + step);
    const Level expected = part_of(whole, first, first + step);
    EXPECT_EQ(part.key, expected.key);
    EXPECT_EQ(part.mask, expected.mask);
    EXPECT_EQ(part.first, expected.first);
    EXPECT_EQ(part.rgba, expected.rgba);
    EXPECT_EQ(part.normal, expected.normal);
    EXPECT_EQ(part.directional_coverage, expected.directional_coverage);
    filled += functions.filled_voxels(first, first + step), found += part.key.size();
  }
  EXPECT_EQ(found, whole.key.size());
  EXPECT_EQ(filled, functions.filled_voxels(0, bricks));
  EXPECT_GE(filled, std::uint64_t(50 * 41 * 70));
}

TEST_F(CellEditsTest, AreNoneWhereNoEditSelectsAVoxel) {
  parameters_.window_min = {1024, 0, 64};
  EXPECT_TRUE(CellEdits(*in_scene_, parameters_, pool_).empty());
}

TEST_F(CellEditsTest, ChangeOnlyTheVoxelsThatTheySelect) {
  const CellEdits edits(*in_scene_, parameters_, pool_);
  constexpr std::uint64_t bricks = 16 * 16 * 16;
  const Level before = sparse_level(bricks);
  Level after = before;
  edits.functions().apply(after, 0, bricks);
  const auto has = [](const Level& level, std::uint64_t key, int voxel) {
    const auto at = std::lower_bound(level.key.begin(), level.key.end(), key);
    if (at == level.key.end() || *at != key) return false;
    return (level.mask[8 * std::size_t(at - level.key.begin()) + std::size_t(voxel) / 64] >> voxel % 64 & 1) != 0;
  };
  for (std::uint64_t key = 0; key < bricks; ++key) {
    const Vec3i64 min = parameters_.window_min + static_cast<Vec3i64>(demorton(key)) * 8;
    for (int i = 0; i < brick_voxels; ++i) {
      const Vec3i64 voxel = min + Vec3i64{i % 8, i / 8 % 8, i / 64};
      bool expected = has(before, key, i) && !in_scene_->selects(0, voxel);
      expected |= in_scene_->selects(1, voxel);
      ASSERT_EQ(has(after, key, i), expected) << key << " " << i;
    }
  }
}

}  // namespace
}  // namespace gigabake
