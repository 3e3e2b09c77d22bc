#include "scheduler/plan/size_estimate.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>
#include <random>

#include "scheduler/plan/piece_order.h"

namespace gigabake {
namespace {

constexpr std::uint64_t estimate_seed = 20261122;

/// A scene of forty tiles with up to sixty columns. Each column has a different number of voxels per projected voxel.
struct MadeScene {
  std::vector<TileScan> scans;
  std::vector<std::vector<double>> voxels;  ///< by tile and column_x
  SampledScene scene;
  double all = 0;

  explicit MadeScene(std::mt19937_64& random) {
    std::uniform_int_distribution<int> columns(1, 60), size(1, 100000);
    std::normal_distribution<double> ratio(0.8, 0.1);
    for (std::uint32_t t = 0; t < 40; ++t) {
      TileScan& s = scans.emplace_back();
      s.tile = t;
      voxels.emplace_back();
      const double kind = ratio(random);
      for (int x = columns(random); x > 0; --x) {
        const double projected_voxels = size(random);
        s.columns.push_back(
            {std::int64_t(voxels[t].size()), 0, 0, 1, 100, std::uint64_t(projected_voxels * projected_voxel_unit)});
        voxels[t].push_back(projected_voxels * kind * (1 + 0.5 * (ratio(random) - 0.8)));
        all += voxels[t].back();
        scene.projected_voxels += projected_voxels;
      }
      scene.tile_triangles.push_back(100 * s.columns.size());
    }
  }

  std::vector<std::uint64_t> weights() const {
    std::vector<std::uint64_t> weights;
    for (const TileScan& s : scans) {
      weights.push_back(0);
      for (const ColumnExtent& c : s.columns) weights.back() += c.projected_voxels;
    }
    return weights;
  }

  BakedPiece baked(const Piece& piece) const {
    const double v = voxels[piece.tile][std::size_t(piece.column.column_x)];
    const auto lod0 = std::uint64_t(v);
    return {piece.tile, double(piece.column.projected_voxels) / projected_voxel_unit,
            lod0,       lod0 * 4 / 3,
            lod0 * 4,   lod0 * 4 + 20000,
            1,          0.1,
            0.2,        0.1};
  }

  /// Bakes the first `pieces` sample cells of the first `tiles` tiles in random order.
  BakedSample sample(std::size_t tiles, std::size_t pieces, std::uint64_t draw) const {
    std::vector<TileScan> chosen;
    for (const std::uint32_t t : weighted_order(weights(), draw))
      if (chosen.size() < tiles) chosen.push_back(scans[t]);
    BakedSample sample;
    for (const Piece& piece : piece_order(chosen, chosen.size() == scans.size(), draw))
      if (sample.pieces.size() < pieces) sample.pieces.push_back(baked(piece));
    sample.wall_s = 0.25 * double(sample.pieces.size());
    return sample;
  }
};

TEST(SizeEstimate, IsTheSumWhereAllPiecesWereBaked) {
  std::mt19937_64 random(estimate_seed);
  const MadeScene made(random);
  const SizeEstimate e = estimate_size(made.scene, made.sample(40, 1000000, 1));
  EXPECT_NEAR(double(e.voxels_lod0), made.all, 1e-3 * made.all);
  EXPECT_NEAR(e.share, 1, 1e-9);
  EXPECT_NEAR(e.voxels_error, 0, 1e-9);
}

TEST(SizeEstimate, OfTwentyPiecesIsRightOnAverageAndSeldomFartherOffThanItsError) {
  std::mt19937_64 random(estimate_seed);
  const MadeScene made(random);
  double sum = 0;
  int outside = 0;
  constexpr int draws = 200;
  for (int draw = 0; draw < draws; ++draw) {
    const SizeEstimate e = estimate_size(made.scene, made.sample(10, 20, std::uint64_t(draw) * 1000));
    sum += double(e.voxels_lod0);
    outside += std::abs(double(e.voxels_lod0) - made.all) > 3 * e.voxels_error * double(e.voxels_lod0) ? 1 : 0;
  }
  EXPECT_NEAR(sum / draws / made.all, 1, 0.02);
  EXPECT_LT(outside, draws / 10);
}

TEST(SizeEstimate, CountsShardsAndSharesWorkAmongRanks) {
  SampledScene scene{1000, {10, 30}, 7, 2};
  BakedSample sample{{{1, 250, 200, 300, 900, 1900, 1, 1, 2, 1}}, 2};
  const SizeEstimate e = estimate_size(scene, sample);
  EXPECT_EQ(e.voxels_lod0, 800u);
  EXPECT_EQ(e.voxels, 1200u);
  EXPECT_EQ(e.bytes, 1200u * 3 + 7 * 1000);
  // The stages of the sample add up to 4 s and took 2 s. The scene has 40 triangles, of which 30 were read, and four
  // times the voxels of the sample.
  ASSERT_TRUE(e.bake_s);
  EXPECT_NEAR(*e.bake_s, 0.5 * (1.0 * 40 / 30 + 3.0 * 4) / 2, 1e-9);
}

TEST(SizeEstimate, WithoutPiecesGoesByTheSurfaceAndKnowsNoTime) {
  const SizeEstimate e = estimate_size({3000, {}, 2, 1}, {});
  EXPECT_EQ(e.voxels_lod0, 3000u);
  EXPECT_EQ(e.voxels, 4000u);
  EXPECT_FALSE(e.bake_s);
}

TEST(PieceOrder, DrawsEachOnceAndHeavyOnesSooner) {
  std::vector<double> first(3);
  for (std::uint64_t draw = 0; draw < 3000; ++draw) {
    const std::vector<std::uint32_t> order = weighted_order({10, 0, 30}, draw);
    ASSERT_EQ(order.size(), 2u);
    first[order[0]] += 1;
  }
  EXPECT_NEAR(first[2] / 3000, 0.75, 0.04);
}

TEST(PieceOrder, PiecesAreAsLargeAsMayBeAndNoLargerThanACell) {
  EXPECT_EQ(piece_voxels(1e9, 1024), 1024u);
  EXPECT_EQ(piece_voxels(150000, 1024), 256u);
  EXPECT_EQ(piece_voxels(0, 1024), 64u);
  EXPECT_EQ(piece_voxels(0, 32), 32u);
}

TEST(RoundSize, TakesTheNearestHandySize) {
  for (const auto& [size, expected] : {std::pair(0.23, 0.25), {0.97, 1.0}, {0.0031, 0.003}, {7.3, 8.0}, {12.0, 10.0}})
    EXPECT_NEAR(round_size(size), expected, 1e-12);
}

}  // namespace
}  // namespace gigabake
