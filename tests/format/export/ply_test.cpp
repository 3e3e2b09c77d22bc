#include "format/export/ply/ply.h"

#include <cmath>
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>

#include "core/base/error.h"
#include "tests/format/shard/made_shard.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using made::TempFolder;
using made::Voxel;

struct Vertex {
  double centre_m[3];
  std::int32_t index[3];
  std::uint8_t rgba[4];
  float normal[3];
};

constexpr std::size_t vertex_bytes = 52;

std::vector<Vertex> vertices_of(const std::string& ply) {
  const std::string end = "end_header\n";
  const std::size_t begin = ply.find(end) + end.size();
  std::vector<Vertex> vertices;
  for (std::size_t at = begin; at + vertex_bytes <= ply.size(); at += vertex_bytes) {
    Vertex& v = vertices.emplace_back();
    std::memcpy(v.centre_m, &ply[at], 24);
    std::memcpy(v.index, &ply[at + 24], 12);
    std::memcpy(v.rgba, &ply[at + 36], 4);
    std::memcpy(v.normal, &ply[at + 40], 12);
  }
  EXPECT_EQ((ply.size() - begin) % vertex_bytes, 0u);
  return vertices;
}

TEST(Ply, HoldsCentreIndexColourAndNormalOfAVoxel) {
  const TempFolder folder;
  Shard shard = made::shard_of({{{-3, 9, 17}, {1, 2, 3, 4}, {127, 0}}}, {-8, 8, 16}, 16);
  shard.header.lattice_origin_m = {100, 200, 300};
  made::write_scene_of(folder / "scene.xml", {shard});
  EXPECT_EQ(export_ply(folder / "scene.xml", 0, folder / "v.ply"), 1u);
  const Vertex fine = vertices_of(made::bytes_of(folder / "v.ply")).at(0);
  EXPECT_EQ(fine.centre_m[0], 100 - 2.5 * 0.25);
  EXPECT_EQ(fine.centre_m[1], 200 + 9.5 * 0.25);
  EXPECT_EQ(fine.centre_m[2], 300 + 17.5 * 0.25);
  EXPECT_EQ(fine.index[0], -3);
  EXPECT_EQ(fine.index[1], 9);
  EXPECT_EQ(fine.index[2], 17);
  EXPECT_EQ(std::string(fine.rgba, fine.rgba + 4), "\1\2\3\4");
  EXPECT_EQ(fine.normal[0], 1);
  EXPECT_EQ(fine.normal[1], 0);
  EXPECT_EQ(fine.normal[2], 0);

  export_ply(folder / "scene.xml", 1, folder / "v.ply");
  const Vertex coarse = vertices_of(made::bytes_of(folder / "v.ply")).at(0);
  EXPECT_EQ(coarse.centre_m[0], 100 - 3 * 0.25);
  EXPECT_EQ(coarse.index[0], -2);
  EXPECT_EQ(coarse.index[1], 4);
}

// 2026-11-25: if shard and scene agreed on a hash that differs from the voxels' hash, the export still succeeded.
TEST(Ply, IsRefusedIfTheVoxelsAreNotThoseOfTheContentHash) {
  const TempFolder folder;
  Shard shard = made::shard_of({{{-3, 9, 17}, {1, 2, 3, 4}, {127, 0}}}, {-8, 8, 16}, 16);
  shard.header.content_hash[0] += Hash128{1, 0};
  made::write_scene_of(folder / "scene.xml", {shard});
  EXPECT_THROW(export_ply(folder / "scene.xml", 0, folder / "v.ply"), InputError);
  EXPECT_EQ(export_ply(folder / "scene.xml", 1, folder / "v.ply"), 1u) << "its other level is whole";
}

TEST(Ply, NormalsAreUnitVectorsOnBothHalvesOfTheSphere) {
  const TempFolder folder;
  std::vector<Voxel> voxels;
  for (std::int64_t i = 0; i < 255; ++i)
    voxels.push_back({{i % 16, i / 16, 0}, {1, 1, 1, 1}, {std::int8_t(i - 127), std::int8_t(i * 37 % 255 - 127)}});
  made::write_scene_of(folder / "scene.xml", {made::shard_of(voxels, {0, 0, 0}, 16)});
  export_ply(folder / "scene.xml", 0, folder / "v.ply");
  bool up = false, down = false;
  for (const Vertex& v : vertices_of(made::bytes_of(folder / "v.ply"))) {
    EXPECT_NEAR(std::hypot(v.normal[0], v.normal[1], v.normal[2]), 1, 1e-6);
    up |= v.normal[2] > 0.5f;
    down |= v.normal[2] < -0.5f;
  }
  EXPECT_TRUE(up && down);
}

TEST(Ply, CountsItsVerticesInTheHeader) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  const SceneDescription scene = made::write_scene_of(folder / "scene.xml", {made::random_shard(rng, {3, true, 6})});
  for (int lod = 0; lod < 3; ++lod) {
    const std::uint64_t voxels = export_ply(folder / "scene.xml", lod, folder / "v.ply");
    const std::string ply = made::bytes_of(folder / "v.ply");
    EXPECT_EQ(voxels, scene.cells[0].voxels[std::size_t(lod)]);
    EXPECT_NE(ply.find("element vertex " + std::to_string(voxels) + "\n"), std::string::npos);
    EXPECT_EQ(vertices_of(ply).size(), voxels);
  }
}

TEST(Ply, IsNotWrittenWhereTheSceneHasNoSuchLevelOrAShardIsDamaged) {
  const TempFolder folder;
  made::write_scene_of(folder / "scene.xml", {made::small_shard()});
  EXPECT_THROW(export_ply(folder / "scene.xml", 2, folder / "v.ply"), InputError);
  std::filesystem::resize_file(folder / "shards/c_0_0_0.h5", 100);
  EXPECT_THROW(export_ply(folder / "scene.xml", 0, folder / "v.ply"), InputError);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2);
}

TEST(Ply, RefusesIndicesBeyond32Bits) {
  const TempFolder folder;
  const std::int64_t far = std::int64_t(1) << 33;
  made::write_scene_of(folder / "scene.xml", {made::shard_of({{{far, 0, 0}, {1, 1, 1, 1}, {}}}, {far, 0, 0}, 8)});
  EXPECT_THROW(export_ply(folder / "scene.xml", 0, folder / "v.ply"), InputError);
}

}  // namespace
}  // namespace gigabake
