// Instances are not expanded: the scan reads their boxes, and a cell uses the instances that overlap it.
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <sys/resource.h>

#include "glb_scene.h"
#include "tests/random_seed.h"
#include "worker/pipeline/cell_loader.h"
#include "worker/scan/scan_tile.h"

namespace gigabake {
namespace {

/// Writes a fan of `triangles` around the origin, about a metre wide, placed at each x, y, z of `translation`.
void write_instanced(const std::filesystem::path& folder, int triangles, const std::vector<float>& translation,
                     const std::vector<float>& rotation) {
  std::vector<float> position{0, 0.5f, 0};
  std::vector<std::uint32_t> index;
  for (int i = 0; i < triangles; ++i) {
    const double turn = 2 * 3.141592653589793 * i / triangles;
    position.insert(position.end(), {float(0.5 * std::cos(turn)), 0, float(0.5 * std::sin(turn))});
    index.insert(index.end(), {0, std::uint32_t(1 + (i + 1) % triangles), std::uint32_t(1 + i)});
  }
  std::ofstream bin(folder / "a.bin", std::ios::binary);
  std::string views, accessors;
  std::size_t offset = 0;
  const auto put = [&](const auto& values, const char* type, int component, std::size_t components) {
    const std::size_t bytes = values.size() * 4;
    bin.write(reinterpret_cast<const char*>(values.data()), std::streamsize(bytes));
    views += std::string(views.empty() ? "" : ",") + R"({"buffer":0,"byteOffset":)" + std::to_string(offset) +
             R"(,"byteLength":)" + std::to_string(bytes) + "}";
    accessors += std::string(accessors.empty() ? "" : ",") + R"({"bufferView":)" +
                 std::to_string(std::count(views.begin(), views.end(), '{') - 1) + R"(,"componentType":)" +
                 std::to_string(component) + R"(,"count":)" + std::to_string(values.size() / components) +
                 R"(,"type":")" + type + "\"}";
    offset += bytes;
  };
  put(position, "VEC3", 5126, 3);
  put(index, "SCALAR", 5125, 1);
  put(translation, "VEC3", 5126, 3);
  put(rotation, "VEC4", 5126, 4);
  std::ofstream(folder / "a.gltf") << R"({"asset":{"version":"2.0"},"extensionsRequired":["EXT_mesh_gpu_instancing"],
    "extensionsUsed":["EXT_mesh_gpu_instancing"],"nodes":[{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":
    {"attributes":{"TRANSLATION":2,"ROTATION":3}}}}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"buffers":[{"uri":"a.bin","byteLength":)"
                                   << offset << "}],\"bufferViews\":[" << views << "],\"accessors\":[" << accessors
                                   << "]}";
}

struct Forest {
  std::vector<float> translation, rotation;
};

/// Returns trees that all have the same height above the lattice.
Forest random_forest(std::size_t trees, double extent_m, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  Forest f;
  for (std::size_t i = 0; i < trees; ++i) {
    f.translation.insert(f.translation.end(), {float(extent_m * unit(rng)), 3, float(extent_m * unit(rng))});
    f.rotation.insert(f.rotation.end(), {float(unit(rng)), float(unit(rng)), float(unit(rng)), float(unit(rng))});
  }
  return f;
}

SceneSources forest_sources(const std::filesystem::path& folder) {
  return open_sources(folder / "a.gltf", {true, {}, {}});
}

BakeParameters metre_lattice() {
  BakeParameters p;
  p.voxel_size_m = 0.25;
  p.cell_voxels = 64;
  return p;
}

using ColumnsByPlace = std::map<std::pair<std::int64_t, std::int64_t>, ColumnExtent>;

ColumnsByPlace by_place(const TileScan& scan) {
  ColumnsByPlace columns;
  for (const ColumnExtent& c : scan.columns) columns[{c.column_x, c.column_y}] = c;
  return columns;
}

TEST(Instances, ScannedByBoxesReachWhereTheirTrianglesReachAndHardlyFarther) {
  const test::RandomSeed seed;
  const Forest forest = random_forest(3000, 300, seed);
  const ThreadPool pool(2);
  const ScratchFolder few, many;
  write_instanced(few.path(), 300, forest.translation, forest.rotation);   // 900 000 triangles, scanned one by one
  write_instanced(many.path(), 400, forest.translation, forest.rotation);  // 1 200 000 triangles, scanned by boxes
  const TileScan exact = scan_tile(forest_sources(few.path()), 0, metre_lattice(), pool);
  const TileScan boxed = scan_tile(forest_sources(many.path()), 0, metre_lattice(), pool);
  ASSERT_EQ(exact.error + boxed.error, "");
  EXPECT_EQ(boxed.triangles, 1200000u);
  EXPECT_EQ(hull(exact.bounds, boxed.bounds), boxed.bounds);
  EXPECT_LE(boxed.bounds.size()[0], exact.bounds.size()[0] + 24);
  const ColumnsByPlace near = by_place(exact), far = by_place(boxed);
  EXPECT_GE(far.size(), near.size());
  for (const auto& [place, column] : near) {
    ASSERT_TRUE(far.contains(place)) << place.first << ", " << place.second;
    EXPECT_LE(far.at(place).z_min, column.z_min);
    EXPECT_GE(far.at(place).z_end, column.z_end);
    EXPECT_LE(far.at(place).z_end - far.at(place).z_min, column.z_end - column.z_min + 24);
  }
}

std::uint64_t peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::uint64_t(usage.ru_maxrss) * 1024;
}

TEST(Instances, AMillionOfAThousandTrianglesAreScannedInSecondsAndBytesEach) {
  const Forest forest = random_forest(1000000, 5000, 7);
  const ScratchFolder folder;
  write_instanced(folder.path(), 1000, forest.translation, forest.rotation);
  const std::uint64_t before = peak_bytes();
  const auto start = std::chrono::steady_clock::now();
  const TileScan s = scan_tile(forest_sources(folder.path()), 0, metre_lattice(), ThreadPool(2));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const double bytes = double(peak_bytes() - before) / 1e6;
  std::cout << "a million instances: " << seconds << " s, " << bytes << " bytes each at the peak\n";
  EXPECT_EQ(s.error, "");
  EXPECT_EQ(s.triangles, 1000000000u);
  EXPECT_LT(seconds, 30);
  EXPECT_LT(bytes, 700);
}

TEST(Instances, OfACellAreThoseThatComeNearIt) {
  const Forest forest = random_forest(3000, 300, 11);
  const ScratchFolder folder;
  write_instanced(folder.path(), 400, forest.translation, forest.rotation);
  const SceneSources sources = forest_sources(folder.path());
  const BakeParameters parameters = metre_lattice();
  CellLoader loader(sources, parameters, std::uint64_t(1) << 28, 2);
  CellJob job;
  job.tiles = {0};
  job.cell_voxels = parameters.cell_voxels;
  const LoadedCell cell = loader.load(job);
  EXPECT_GT(cell.parts.size(), 0u);
  EXPECT_LT(cell.parts.size(), 30u);  // the forest has 3000 trees on 360 000 m², the cell has 256 m²
}

}  // namespace
}  // namespace gigabake
