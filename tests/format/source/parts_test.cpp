// Large files that are read in parts have the same triangles as the files read whole.
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numeric>
#include <random>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "format/source/mesh_parts.h"
#include "format/source/source.h"
#include "format/source/tile_hash.h"
#include "made_glb.h"
#include "parts_check.h"
#include "source_scene.h"

namespace gigabake {
namespace {

using namespace test;
using testing::HasSubstr;

/// The number of quads along the edge of a grid whose triangles fill 4.2 parts.
constexpr std::uint32_t edge = 742, points = edge + 1, grid_vertices = points * points;
constexpr std::size_t parts_of_grid = 2 * edge * edge / max_part_triangles + 1;

std::vector<std::uint32_t> corners_of_grid() {
  std::vector<std::uint32_t> out;
  for (std::uint32_t y = 0; y < edge; ++y)
    for (std::uint32_t x = 0; x < edge; ++x) {
      const std::uint32_t a = y * points + x, b = a + 1, c = a + points, d = c + 1;
      out.insert(out.end(), {a, b, d, a, d, c});
    }
  return out;
}

template <class T>
std::vector<T> numbers(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<T> out(count);
  for (T& v : out) v = std::is_floating_point_v<T> ? T(random()) / T(1 << 20) : T(random());
  return out;
}

class InParts : public testing::Test {
 protected:
  std::size_t parts_of(const MadeGlb& made) {
    open(made);
    return expect_same_in_parts(sources.tiles.at(0), sources.root);
  }
  void open(const MadeGlb& made) { sources = open_sources(folder.write("a.glb", made.glb()), {}); }
  TileMesh read(const PrimitiveSink& sink = nullptr) {
    return read_tile(sources.tiles.at(0), sources.root, ReadScope::everything, sink);
  }
  std::string refusal(const PrimitiveSink& sink = nullptr) {
    try {
      read(sink);
    } catch (const InputError& e) {
      return e.what();
    }
    return "was read";
  }
  SourceFolder folder;
  SceneSources sources;
};

TEST_F(InParts, AnIndexedGridWithColoursAndTextureCoordinates) {
  MadeGlb made;
  const int position = made.add(numbers<float>(3 * grid_vertices, 1), 3, of_floats);
  Json& p = made.add_primitive(position, made.add(corners_of_grid(), 1, of_words));
  p["attributes"]["COLOR_0"] = made.add(numbers<std::uint8_t>(4 * grid_vertices, 2), 4, of_bytes, true);
  p["attributes"]["TEXCOORD_0"] = made.add(numbers<std::uint16_t>(2 * grid_vertices, 3), 2, of_shorts, true);
  p["attributes"]["NORMAL"] = made.add(numbers<float>(3 * grid_vertices, 4), 3, of_floats);
  p["material"] = 0;
  made.gltf["images"] = {{{"uri",
                           "data:image/png;base64,"
                           "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGM4kWIEAANWAV/oF4RSAAAA"
                           "AElFTkSuQmCC"}}};
  made.gltf["textures"] = {{{"source", 0}}};
  made.gltf["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  EXPECT_EQ(parts_of(made), parts_of_grid);
  const Primitive read_whole = read().primitives.at(0);
  EXPECT_FALSE(read_whole.uv.empty() || read_whole.rgba.empty() || read_whole.normal.empty());
}

TEST_F(InParts, VerticesInRandomOrder) {
  std::vector<std::uint32_t> order(grid_vertices), corners = corners_of_grid();
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), std::mt19937(4));
  for (std::uint32_t& c : corners) c = order[c];
  MadeGlb made;
  const int position = made.add(numbers<float>(3 * grid_vertices, 5), 3, of_floats, false, 64);
  made.add_primitive(position, made.add(corners, 1, of_words));
  EXPECT_EQ(parts_of(made), parts_of_grid);
}

/// Some vertices are so far apart that they are read one by one.
TEST_F(InParts, AFewOfManyVertices) {
  std::vector<std::uint32_t> corners = numbers<std::uint32_t>(300, 6);
  constexpr std::uint32_t many = 3 * max_part_triangles + 1;
  for (std::uint32_t& c : corners) c %= many;
  corners[0] = 0, corners[1] = many - 1;
  MadeGlb made;
  const int position = made.add(numbers<std::uint16_t>(3 * std::size_t(many), 7), 3, of_signed_shorts, true, 8);
  made.add_primitive(position, made.add(corners, 1, of_words));
  EXPECT_EQ(parts_of(made), 1u);
  std::size_t kept = 0;
  read([&](std::size_t, Primitive&& p) { kept = p.position.size() / 3; });
  EXPECT_LE(kept, corners.size());
}

TEST_F(InParts, IndicesOfSixteenBits) {
  std::vector<std::uint16_t> corners = numbers<std::uint16_t>(3 * (2 * max_part_triangles + 5), 8);
  for (std::uint16_t& c : corners) c %= 60000;
  MadeGlb made;
  made.add_primitive(made.add(numbers<float>(3 * 60000, 9), 3, of_floats), made.add(corners, 1, of_shorts));
  EXPECT_EQ(parts_of(made), 3u);
}

TEST_F(InParts, TrianglesWithoutIndices) {
  MadeGlb made;
  made.add_primitive(made.add(numbers<float>(9 * (max_part_triangles + 1), 10), 3, of_floats));
  EXPECT_EQ(parts_of(made), 2u);
}

/// Every other triangle of a strip is reversed, also if the strip continues in another part.
TEST_F(InParts, StripsAndFans) {
  std::vector<std::uint32_t> order = numbers<std::uint32_t>(max_part_triangles + 8, 11);
  for (std::uint32_t& v : order) v %= 1000;
  MadeGlb made;
  const int position = made.add(numbers<float>(3 * 1000, 12), 3, of_floats), indices = made.add(order, 1, of_words);
  made.add_primitive(position, indices, 5);
  made.add_primitive(position, indices, 6);
  EXPECT_EQ(parts_of(made), 4u);
}

TEST_F(InParts, FaultsOfSeveralPartsOfWhichTheFirstIsReported) {
  std::vector<std::uint32_t> corners = corners_of_grid();
  for (const std::uint64_t part : {3, 2, 1}) corners[3 * (part * max_part_triangles + 7)] = grid_vertices + part;
  MadeGlb made;
  made.add_primitive(made.add(numbers<float>(3 * grid_vertices, 12), 3, of_floats), made.add(corners, 1, of_words));
  open(made);
  const ThreadPool pool(3);
  for (int round = 0; round < 20; ++round) {
    try {
      read_tile(
          sources.tiles.at(0), sources.root, ReadScope::everything, [](std::size_t, Primitive&&) {}, pool);
      ADD_FAILURE() << "was read";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(std::to_string(grid_vertices + 1)));
    }
  }
}

TEST_F(InParts, SparseValuesOfAnyPart) {
  MadeGlb made;
  const int position = made.add(numbers<float>(3 * grid_vertices, 13), 3, of_floats);
  made.add_primitive(position, made.add(corners_of_grid(), 1, of_words));
  const int where = made.add(std::vector<std::uint32_t>{5, grid_vertices - 1, 5}, 1, of_words),
            values = made.add(numbers<float>(9, 14), 3, of_floats);
  made.gltf["accessors"][std::size_t(position)]["sparse"] = {
      {"count", 3},
      {"indices", {{"bufferView", where}, {"componentType", of_words}}},
      {"values", {{"bufferView", values}}}};
  EXPECT_EQ(parts_of(made), parts_of_grid);
}

TEST_F(InParts, SeveralPrimitivesAndPlacements) {
  MadeGlb made;
  const int position = made.add(numbers<float>(3 * grid_vertices, 15), 3, of_floats),
            grid = made.add(corners_of_grid(), 1, of_words),
            few = made.add(std::vector<std::uint32_t>{0, 1, 2}, 1, of_words);
  made.add_primitive(position, few);
  made.add_primitive(position, grid);
  made.add_primitive(position, few, 0);  // points
  made.add_primitive(position, few, 6);
  made.gltf["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {1, 2, 3}}}};
  made.gltf["scenes"][0]["nodes"] = {1, 0};
  EXPECT_EQ(parts_of(made), parts_of_grid + 2);
  std::size_t taken = 0;
  const TileMesh mesh = read([&](std::size_t, Primitive&&) { ++taken; });
  EXPECT_EQ(taken, parts_of_grid + 2) << "a mesh that is placed twice is read once";
  EXPECT_EQ(mesh.instances.size(), 2 * (parts_of_grid + 2));
}

/// The STL has one full part and three more facets.
TEST_F(InParts, AnStl) {
  std::string bytes(84, ' ');
  const std::uint32_t facets = max_part_triangles + 3;
  std::memcpy(&bytes[80], &facets, sizeof facets);
  const std::vector<float> values = numbers<float>(std::size_t(facets) * 12, 16);
  bytes.reserve(84 + 50 * std::size_t(facets));
  for (std::uint32_t f = 0; f < facets; ++f) {
    bytes.append(reinterpret_cast<const char*>(&values[12 * std::size_t(f)]), 48);
    bytes.append(2, '\0');
  }
  sources = open_sources(folder.write("a.stl", bytes), {});
  EXPECT_EQ(expect_same_in_parts(sources.tiles.at(0), sources.root), 2u);
}

TEST_F(InParts, AGlbIsReadFromItsFileAsFromMemory) {
  MadeGlb made;
  const int position = made.add(numbers<float>(3 * grid_vertices, 17), 3, of_floats, false, 20);
  made.add_primitive(position, made.add(corners_of_grid(), 1, of_words));
  open(made);
  const TileMesh of_file = read();
  folder.write("a.bin", std::string(made.bin.begin(), made.bin.end()));
  sources = open_sources(folder.write("a.gltf", made.gltf_of("a.bin")), {});
  const TileMesh of_memory = read();
  EXPECT_EQ(of_file.primitives.at(0).position, of_memory.primitives.at(0).position);
  EXPECT_EQ(of_file.primitives.at(0).index, of_memory.primitives.at(0).index);
}

class LargeGrid : public InParts {
 protected:
  LargeGrid() {
    const int position = made.add(numbers<float>(3 * grid_vertices, 18), 3, of_floats);
    made.add_primitive(position, made.add(corners_of_grid(), 1, of_words));
    open(made);
  }
  ~LargeGrid() override { set_memory_limit(0); }
  MadeGlb made;
};

TEST_F(LargeGrid, CutWhileItIsReadIsOneLineAndNoSignal) {
  const auto& file = sources.tiles.at(0).path;
  const std::string line = refusal([&](std::size_t, Primitive&&) { std::filesystem::resize_file(file, 10'000); });
  EXPECT_THAT(line, HasSubstr("a.glb: became shorter while it was read (at byte "));
}

TEST_F(LargeGrid, NamesABadIndexOfTheLastPartAsInOnePiece) {
  const std::uint32_t beyond = grid_vertices;
  std::memcpy(&made.bin[made.bin.size() - 4], &beyond, sizeof beyond);
  EXPECT_EQ(parts_of(made), 0u);
  EXPECT_THAT(refusal([](std::size_t, Primitive&&) {}),
              HasSubstr("index " + std::to_string(6 * edge * edge - 1) + " is " + std::to_string(grid_vertices)));
}

TEST_F(LargeGrid, WhatTheSinkThrowsPassesThrough) {
  EXPECT_THROW(read([](std::size_t, Primitive&&) { throw 7; }), int);
  EXPECT_THROW(read([](std::size_t, Primitive&&) { throw std::bad_alloc(); }), std::bad_alloc);
}

/// One part of a grid needs memory for the corners of 2^18 triangles and half as many vertices, 12 MB.
TEST_F(LargeGrid, ClaimsAPartWhereItIsHandedOverInParts) {
  set_memory_limit(std::uint64_t(14) << 20);
  EXPECT_EQ(refusal([](std::size_t, Primitive&&) {}), "was read");
  set_memory_limit(std::uint64_t(11) << 20);
  EXPECT_THAT(refusal([](std::size_t, Primitive&&) {}), HasSubstr("`memory_bytes` allows 11.0 MB"));
}

/// The file is longer than the memory limit of the process.
TEST_F(LargeGrid, IsIdentifiedWithoutBeingHeld) {
  const Hash128 hash = tile_hash(sources.tiles.at(0), sources.root);
  set_memory_limit(std::uint64_t(1) << 20);
  EXPECT_EQ(tile_hash(sources.tiles.at(0), sources.root), hash);
}

/// 2026-11-23: a stride of 0 was checked as one byte but read as the item size, so the read went beyond the view.
TEST_F(InParts, AStrideOfZeroIsNone) {
  MadeGlb made;
  const int position = made.add(numbers<float>(9, 19), 3, of_floats);
  made.add_primitive(position);
  made.gltf["bufferViews"][0]["byteStride"] = 0;
  EXPECT_EQ(parts_of(made), 1u);
  made.gltf["accessors"][0]["count"] = 6;
  open(made);
  EXPECT_THAT(refusal(), HasSubstr("accessors[0]: 6 items from byte 0 exceed a buffer view of 36 bytes"));
}

/// 2026-11-23: sparse values in a view with a stride were read beyond the view. Sparse values must not have a stride.
TEST_F(InParts, SparseValuesHaveNoSpacing) {
  MadeGlb made;
  const int position = made.add(numbers<float>(9, 20), 3, of_floats),
            where = made.add(std::vector<std::uint32_t>{0, 1}, 1, of_words),
            values = made.add(numbers<float>(4, 21), 1, of_floats);
  made.add_primitive(position);
  made.gltf["bufferViews"][std::size_t(values)]["byteStride"] = 4;
  made.gltf["accessors"][0]["sparse"] = {{"count", 2},
                                         {"indices", {{"bufferView", where}, {"componentType", of_words}}},
                                         {"values", {{"bufferView", values}}}};
  open(made);
  EXPECT_THAT(refusal(), HasSubstr("accessors[0].sparse.values: 2 items from byte 0 exceed a buffer view of 16 bytes"));
}

TEST(UsedVertices, AreAscendingAndKeepTheirCorners) {
  const std::vector<std::uint32_t> corners{900, 70, 71, 900, 134, 70};
  std::vector<std::uint32_t> renumbered = corners;
  const UsedVertices used(corners);
  used.renumber(renumbered);
  EXPECT_THAT(used.ascending(), testing::ElementsAre(70, 71, 134, 900));
  for (std::size_t i = 0; i < corners.size(); ++i) EXPECT_EQ(used.ascending()[renumbered[i]], corners[i]);
  EXPECT_TRUE(UsedVertices({}).ascending().empty());
}

}  // namespace
}  // namespace gigabake
