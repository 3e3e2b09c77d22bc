#include "core/octree/parameters.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "core/base/error.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

TEST(BakeParameters, ComeBackFromTheirText) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  for (int round = 0; round < 100; ++round) {
    BakeParameters p;
    p.voxel_size_m = std::ldexp(1 + double(rng() % 1000000) / 1e6, int(rng() % 30) - 15);
    p.lattice_origin_m = {double(rng()) / 3, -0.1, 1e-300};
    p.cell_voxels = 8u << rng() % 11;
    p.surface = SurfaceRule(rng() % 3);
    p.mip = MipFilter(rng() % 3);
    p.normals = rng() % 2 == 0;
    p.directional_coverage = rng() % 2 == 0;
    p.max_error = std::uint32_t(rng() % 128);
    if (p.normals && p.mip == MipFilter::coverage && p.directional_coverage && p.cell_voxels >= 64)
      p.depth_error = std::uint32_t(rng() % 128);
    p.codec = Codec(rng() % 2);
    const BakeParameters q = parameters_from_json(to_json(p));
    EXPECT_EQ(p.voxel_size_m, q.voxel_size_m);
    EXPECT_EQ(p.lattice_origin_m, q.lattice_origin_m);
    EXPECT_EQ(p.cell_voxels, q.cell_voxels);
    EXPECT_EQ(p.surface, q.surface);
    EXPECT_EQ(p.mip, q.mip);
    EXPECT_EQ(p.normals, q.normals);
    EXPECT_EQ(p.directional_coverage, q.directional_coverage);
    EXPECT_EQ(p.max_error, q.max_error);
    EXPECT_EQ(p.depth_error, q.depth_error);
    EXPECT_EQ(p.codec, q.codec);
    EXPECT_EQ(to_json(p), to_json(q));
  }
}

TEST(BakeParameters, AreOneLineInAFixedOrder) {
  BakeParameters p;
  p.voxel_size_m = 0.1;
  EXPECT_EQ(to_json(p), R"({"voxel_size_m":0.1,"lattice_origin_m":[0.0,0.0,0.0],"cell_voxels":1024,"surface":"area",)"
                        R"("mip":"coverage","normals":true,"max_error":0,"codec":"deflate"})");
}

TEST(BakeParameters, OfTheFirstScenesAreReadAsWhatWasTheOnlyWayThen) {
  const BakeParameters p = parameters_from_json(
      R"({"voxel_size_m":0.1,"lattice_origin_m":[0.0,0.0,0.0],"cell_voxels":1024,"surface":"area","mip":"coverage",)"
      R"("normals":true})");
  EXPECT_EQ(p.codec, Codec::lz4);
  EXPECT_EQ(p.max_error, 0u);
  EXPECT_TRUE(p.directional_coverage);
}

TEST(BakeParameters, HaveCoverageAlongTheAxesWhereItIsMadeAndWanted) {
  BakeParameters p;
  EXPECT_TRUE(has_directional_coverage(p));
  p.mip = MipFilter::thesis;
  EXPECT_FALSE(has_directional_coverage(p));
  p.mip = MipFilter::coverage;
  p.directional_coverage = false;
  EXPECT_FALSE(has_directional_coverage(p));
}

TEST(BakeParameters, AreRefusedWhereTheTextIsNotTheirs) {
  for (const char* bad : {"", "{", "[]", "{}", "null", R"({"voxel_size_m":"1"})"})
    EXPECT_THROW(parameters_from_json(bad), InputError) << bad;
}

TEST(BakeParameters, NameAValueThatIsUnknown) {
  BakeParameters good;
  good.voxel_size_m = 1;
  const std::string text = to_json(good);
  for (const char* name : {"area", "coverage", "deflate"}) {
    std::string unknown = text;
    unknown.replace(unknown.find(name), std::string(name).size(), "aria");
    try {
      parameters_from_json(unknown);
      ADD_FAILURE() << unknown;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("'aria'"), std::string::npos) << error.what();
    }
  }
  std::string number = text;
  number.replace(number.find("\"area\""), 6, "0");
  EXPECT_THROW(parameters_from_json(number), InputError);
}

TEST(BakeParameters, NameTheFieldThatIsOutOfRange) {
  const auto told = [](auto change) {
    BakeParameters p;
    p.voxel_size_m = 1;
    change(p);
    try {
      check(p);
    } catch (const UsageError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(told([](BakeParameters&) {}), "");
  for (const double bad : {0.0, -1.0, std::nan(""), 1e-7, 1e7, double(INFINITY)})
    EXPECT_EQ(told([bad](BakeParameters& p) { p.voxel_size_m = bad; }).find("`voxel_size_m`: "), 0u) << bad;
  for (const std::uint32_t bad : {0u, 4u, 100u, 16384u})
    EXPECT_EQ(told([bad](BakeParameters& p) { p.cell_voxels = bad; }).find("`cell_voxels`: "), 0u) << bad;
  EXPECT_EQ(told([](BakeParameters& p) { p.max_error = 128; }).find("`max_error`: "), 0u);
  EXPECT_EQ(told([](BakeParameters& p) { p.depth_error = 128; }).find("`depth_error`: "), 0u);
  EXPECT_EQ(told([](BakeParameters& p) { p.lattice_origin_m[1] = INFINITY; }).find("`lattice_origin_m`: "), 0u);
}

}  // namespace
}  // namespace gigabake
