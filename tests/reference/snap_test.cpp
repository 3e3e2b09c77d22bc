/// The snap compared with exact rationals: the distance that a vertex moves, and the rounding of ties.
#include "core/math/snap.h"

#include <cmath>
#include <gmpxx.h>
#include <gtest/gtest.h>
#include <limits>

#include "triangle_families.h"

namespace gigabake::reference {
namespace {

using namespace gigabake;

constexpr double identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

TEST(Snap, MovesAVertexByAtMostHalfASubVoxelPerAxisBesidesRoundingOfDoubles) {
  const std::uint64_t seed = 31;
  Rng rng(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 20000; ++i) {
    SnapFrame frame{std::ldexp(1 + std::abs(unit(rng)), int(uniform(rng, -10, 10))), {}};
    float local[3];
    for (int r = 0; r < 3; ++r) {
      frame.lattice_origin_m[r] = 1000 * unit(rng);
      local[r] = float(1000 * unit(rng));
    }
    LatticePoint out;
    ASSERT_TRUE(snap(frame, identity, local, out)) << "seed " << seed << " case " << i;
    for (int r = 0; r < 3; ++r) {
      const mpq_class exact =
          (mpq_class(local[r]) - mpq_class(frame.lattice_origin_m[r])) / mpq_class(frame.voxel_size_m) * 256;
      const mpq_class moved = abs(exact - mpq_class(long(out.v[r])));
      // Subtraction, division and the final ½ each round once. Together they err by at most 3 · 2^-53 of the value.
      ASSERT_LE(moved, mpq_class(1, 2) + abs(exact) * mpq_class(std::ldexp(4.0, -53)))
          << "seed " << seed << " case " << i;
    }
  }
}

TEST(Snap, RoundsTiesTowardsPlusInfinity) {
  const SnapFrame frame{256.0, {0, 0, 0}};
  const float local[3] = {0.5f, -0.5f, -1.5f};
  LatticePoint out;
  ASSERT_TRUE(snap(frame, identity, local, out));
  EXPECT_EQ(out.v[0], 1);
  EXPECT_EQ(out.v[1], 0);
  EXPECT_EQ(out.v[2], -1);
}

TEST(Snap, IsExactForLatticePointsFarFromTheOrigin) {
  const SnapFrame frame{1.0, {0, 0, 0}};
  const std::int64_t far_voxels = std::int64_t(1) << 44;
  const double moved[12] = {1, 0, 0, double(far_voxels), 0, 1, 0, -double(far_voxels), 0, 0, 1, 0.25};
  const float local[3] = {0.5f, 0.5f, 0.5f};
  LatticePoint out;
  ASSERT_TRUE(snap(frame, moved, local, out));
  EXPECT_EQ(out.v[0], far_voxels * 256 + 128);
  EXPECT_EQ(out.v[1], -far_voxels * 256 + 128);
  EXPECT_EQ(out.v[2], 192);
}

TEST(Snap, RefusesWhatIsNotANumberOrOffTheLattice) {
  const SnapFrame frame{1.0, {0, 0, 0}};
  LatticePoint out;
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  for (const float bad : {inf, -inf, nan, 1e30f, -1e30f}) {
    const float local[3] = {0, bad, 0};
    EXPECT_FALSE(snap(frame, identity, local, out)) << bad;
  }
}

TEST(Snap, TranslationByWholeVoxelsShiftsTheResultByAsMuch) {
  const std::uint64_t seed = 32;
  Rng rng(seed);
  for (int i = 0; i < 2000; ++i) {
    const std::int64_t shift = uniform(rng, -(std::int64_t(1) << 34), std::int64_t(1) << 34);
    const SnapFrame here{0.5, {0, 0, 0}}, there{0.5, {0.5 * double(shift), 0, 0}};
    const double moved[12] = {1, 0, 0, 0.5 * double(shift), 0, 1, 0, 0, 0, 0, 1, 0};
    const float local[3] = {float(uniform(rng, -4096, 4096)) / 1024.0f, 1, 2};
    LatticePoint a, b, c;
    ASSERT_TRUE(snap(here, identity, local, a) && snap(here, moved, local, b) && snap(there, moved, local, c));
    ASSERT_EQ(b.v[0], a.v[0] + 256 * shift) << "seed " << seed;
    ASSERT_EQ(c.v[0], a.v[0]) << "seed " << seed;
  }
}

}  // namespace
}  // namespace gigabake::reference
