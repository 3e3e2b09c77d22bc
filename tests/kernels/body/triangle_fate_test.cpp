#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include "kernels/body/voxelize/classify_triangle.h"

namespace gigabake::kernels {
namespace {

/// A window of 8 voxels of 1 m whose lowest corner is the scene's origin.
class TriangleFate : public testing::Test {
 protected:
  TriangleFate() {
    CellParameters parameters;
    parameters.window_voxels = 8;
    window_ = window_of(parameters);
  }

  TriangleClass fate(const std::vector<float>& position) {
    const std::uint32_t index[3] = {0, 1, 2};
    PartArrays part{position.data(), index,         uv_, nullptr, nullptr, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, 0,
                    false,           uv_ != nullptr};
    SnappedVertex p[3];
    for (std::uint32_t i = 0; i < 3; ++i) p[i] = snap_vertex(window_, part, i);
    const TriangleClass fate = classify_triangle(window_, part, index, p);
    bad_uv_ = has_bad_uv(fate, part, index);
    return fate;
  }

  CellWindow window_;
  const float* uv_ = nullptr;
  bool bad_uv_ = false;
};

constexpr float far_m = 1 << 23, nan_m = std::numeric_limits<float>::quiet_NaN(), huge_m = 1e30f;

TEST_F(TriangleFate, KeepsWhatMayTouchTheWindow) {
  EXPECT_EQ(fate({1, 1, 1, 2, 1, 1, 1, 2, 1}), TriangleClass::kept);
  EXPECT_EQ(fate({-9, -9, 4, 30, -9, 4, -9, 30, 4}), TriangleClass::kept);
}

TEST_F(TriangleFate, KeepsContactWithTheWindowsFacesAndNothingBeyond) {
  EXPECT_EQ(fate({8, 0, 0, 8, 1, 0, 8, 0, 1}), TriangleClass::kept);
  EXPECT_EQ(fate({0, 0, 0, 0, 1, 0, 0, 0, 1}), TriangleClass::kept);
  EXPECT_EQ(fate({8.01f, 0, 0, 8.01f, 1, 0, 8.01f, 0, 1}), TriangleClass::elsewhere);
  EXPECT_EQ(fate({-0.01f, 0, 0, -0.01f, 1, 0, -0.01f, 0, 1}), TriangleClass::elsewhere);
}

TEST_F(TriangleFate, DropsVerticesThatAreNoNumbersOrOffTheLatticeWhereverTheOthersAre) {
  EXPECT_EQ(fate({nan_m, 1, 1, 2, 1, 1, 1, 2, 1}), TriangleClass::non_finite);
  EXPECT_EQ(fate({1, 1, 1, 2, 1, huge_m, 1, 2, 1}), TriangleClass::non_finite);
  EXPECT_EQ(fate({far_m, 1, 1, 2, 1, 1, 1, nan_m, 1}), TriangleClass::non_finite);
}

TEST_F(TriangleFate, DropsWhatHasNoAreaAfterTheSnapInsideTheWindowAlone) {
  EXPECT_EQ(fate({1, 1, 1, 2, 2, 2, 3, 3, 3}), TriangleClass::zero_area);
  EXPECT_EQ(fate({1, 1, 1, 1.001f, 1, 1, 1, 1.001f, 1}), TriangleClass::zero_area);
  EXPECT_EQ(fate({11, 1, 1, 12, 2, 2, 13, 3, 3}), TriangleClass::elsewhere);
  EXPECT_EQ(fate({-far_m, 1, 1, 1, 1, 1, far_m, 1, 1}), TriangleClass::zero_area);
}

TEST_F(TriangleFate, SaysOfWhatReachesTooFarThatItDoesWhereItMeetsTheWindow) {
  EXPECT_EQ(fate({1, 1, 1, far_m, 1, 1, 1, 2, 1}), TriangleClass::oversized);
  EXPECT_EQ(fate({10, 10, 1, far_m, 10, 1, 10, 12, 1}), TriangleClass::elsewhere);
  const float last = float(max_coordinate / subvoxels);
  EXPECT_EQ(fate({1, 1, 1, last, 1, 1, 1, 2, 1}), TriangleClass::kept);
}

TEST_F(TriangleFate, HasBadTextureCoordinatesOnlyWhereItIsKept) {
  const float good[6] = {0, 0, 1, 0, 0, 1}, bad[6] = {0, 0, 1, nan_m, 0, 1}, distant[6] = {0, 0, 2e6f, 0, 0, 1};
  for (const float* uv : {good, bad, distant}) {
    uv_ = uv;
    fate({1, 1, 1, 2, 1, 1, 1, 2, 1});
    EXPECT_EQ(bad_uv_, uv != good);
    fate({1, 1, 1, 2, 2, 2, 3, 3, 3});
    EXPECT_FALSE(bad_uv_);
  }
}

TEST_F(TriangleFate, IsCountedOnce) {
  TriangleCounts<std::uint64_t> counts{{100, 5, 4, 3, 2}, 1};
  CellStats stats;
  add_to(stats, counts);
  EXPECT_EQ(stats.triangles, 5u);
  EXPECT_EQ(stats.non_finite, 4u);
  EXPECT_EQ(stats.zero_area, 3u);
  EXPECT_EQ(stats.oversized, 2u);
  EXPECT_EQ(stats.bad_uv, 1u);
}

}  // namespace
}  // namespace gigabake::kernels
