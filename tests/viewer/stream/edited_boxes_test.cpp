#include "viewer/stream/exchange/edited_boxes.h"

#include <gtest/gtest.h>

#include "format/edit/edited_fingerprint.h"

namespace gigabake {
namespace {

Edit sphere_at(double x_m, double radius_m = 2) {
  Edit edit;
  edit.type = EditType::carve;
  edit.frame = EditFrame::scene;
  edit.shape = SphereShape{{x_m, 8, 8}, radius_m};
  return edit;
}

SceneHeader header_of(const BakeParameters& parameters) {
  SceneHeader header;
  header.voxel_size_m = parameters.voxel_size_m;
  header.lattice_origin_m = parameters.lattice_origin_m;
  header.parameters = to_json(parameters);
  return header;
}

/// A scene of two cells of 64 voxels of 1 m, along x.
class EditedBoxesTest : public ::testing::Test {
 protected:
  EditedBoxesTest() { parameters.voxel_size_m = 1; }

  /// Returns the cell with the fingerprint that a bake gives it after all edits.
  SceneCell cell_after(std::int64_t column, const EditList& edits) const {
    SceneCell cell;
    cell.lattice_min = {64 * column, 0, 0};
    cell.cell_voxels = 64;
    cell.fingerprint = {std::uint64_t(column), 17};
    const EditsInScene placed(std::make_shared<const EditList>(edits), std::nullopt, SnapFrame{1, {}});
    for (const std::uint32_t e : placed.selecting(window_of(cell)))
      cell.fingerprint = edited_fingerprint(cell.fingerprint, placed.hash(e));
    return cell;
  }
  std::vector<Box3i64> boxes(std::int64_t column, const EditList& previous, const EditList& next) const {
    return EditedBoxes(previous, next, header_of(parameters))
        .of_cell(cell_after(column, previous), cell_after(column, next));
  }
  static std::vector<Box3i64> whole(std::int64_t column) { return {Box3i64::cube({64 * column, 0, 0}, 64)}; }

  BakeParameters parameters;
  const EditList one{sphere_at(10)}, two{sphere_at(10), sphere_at(20)},
      three{sphere_at(10), sphere_at(20), sphere_at(30)};
};

TEST_F(EditedBoxesTest, AreTheBoundsOfAddedEdits) {
  const std::vector<Box3i64> found = boxes(0, one, three);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].min, (Vec3i64{18, 6, 6}));
  EXPECT_EQ(found[1].min, (Vec3i64{28, 6, 6}));
  for (std::size_t a = 0; a < 3; ++a) {
    EXPECT_GE(found[0].end[a], found[0].min[a] + 4);
    EXPECT_LE(found[0].end[a], found[0].min[a] + 5);  // bounds may have a voxel that the sphere only touches
  }
}

TEST_F(EditedBoxesTest, AreTheSameForAnUndo) {
  const std::vector<Box3i64> added = boxes(0, one, three), removed = boxes(0, three, one);
  ASSERT_EQ(added.size(), removed.size());
  for (std::size_t i = 0; i < added.size(); ++i) {
    EXPECT_EQ(added[i].min, removed[i].min);
    EXPECT_EQ(added[i].end, removed[i].end);
  }
}

TEST_F(EditedBoxesTest, AreThePartsInTheCell) {
  const EditList across{sphere_at(64, 5)};
  const std::vector<Box3i64> left = boxes(0, {}, across), right = boxes(1, {}, across);
  ASSERT_EQ(left.size(), 1u);
  ASSERT_EQ(right.size(), 1u);
  EXPECT_EQ(left[0].end[0], 64);
  EXPECT_EQ(right[0].min[0], 64);
}

void expect_equal(const std::vector<Box3i64>& found, const std::vector<Box3i64>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  EXPECT_EQ(found[0].min, expected[0].min);
  EXPECT_EQ(found[0].end, expected[0].end);
}

TEST_F(EditedBoxesTest, AreTheWholeCellWithoutProof) {
  const EditList other{sphere_at(40), sphere_at(20)};
  expect_equal(boxes(0, other, three), whole(0));  // an edit before the last ones differs
  expect_equal(boxes(0, two, two), whole(0));      // no edit explains another content
  SceneCell baked_again = cell_after(0, two);
  baked_again.fingerprint.lo ^= 1;  // another source
  expect_equal(EditedBoxes(one, two, header_of(parameters)).of_cell(cell_after(0, one), baked_again), whole(0));
}

TEST_F(EditedBoxesTest, AreTheWholeCellIfVoxelsDependOnOthers) {
  parameters.max_error = 4;
  expect_equal(boxes(0, one, two), whole(0));
  parameters.max_error = 0;
  parameters.coarsest_lod = 2;
  expect_equal(boxes(0, one, two), whole(0));
}

TEST_F(EditedBoxesTest, AreTheWholeCellAfterManyEdits) {
  EditList many = one;
  for (std::size_t i = 0; i < EditedBoxes::max_edits; ++i) many.push_back(sphere_at(3 + 0.5 * double(i)));
  EXPECT_EQ(boxes(0, one, many).size(), EditedBoxes::max_edits);
  many.push_back(sphere_at(50));
  expect_equal(boxes(0, one, many), whole(0));
}

}  // namespace
}  // namespace gigabake
