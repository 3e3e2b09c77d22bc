// Instanced and composite tiles of 3D Tiles 1.0, and both forms of implicit tiling.
#include <cmath>
#include <cstring>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/math/georeference.h"
#include "format/source/source.h"
#include "format/source/tile_hash.h"
#include "source_scene.h"

namespace gigabake {
namespace {

using test::Json;
using test::SourceFolder;
using test::tile;
using test::tileset;
using testing::ElementsAre;
using testing::HasSubstr;

void put_word(std::string& to, std::uint32_t v) { to.append(reinterpret_cast<const char*>(&v), 4); }

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// Returns an i3dm tile. `model` is the embedded glTF, or its URI if `is_external`.
std::string i3dm(const Json& table, const std::string& binary, const std::string& model, bool is_external = false) {
  const std::string json = table.dump();
  std::string out = "i3dm";
  put_word(out, 1);
  put_word(out, std::uint32_t(32 + json.size() + binary.size() + model.size()));
  put_word(out, std::uint32_t(json.size()));
  put_word(out, std::uint32_t(binary.size()));
  put_word(out, 0);
  put_word(out, 0);
  put_word(out, is_external ? 0 : 1);
  return out + json + binary + model;
}

std::string b3dm(const std::string& model) {
  std::string out = "b3dm";
  put_word(out, 1);
  put_word(out, std::uint32_t(28 + model.size()));
  for (int i = 0; i < 4; ++i) put_word(out, 0);
  return out + model;
}

std::string cmpt(const std::vector<std::string>& tiles) {
  std::string all;
  for (const std::string& t : tiles) all += t;
  std::string out = "cmpt";
  put_word(out, 1);
  put_word(out, std::uint32_t(16 + all.size()));
  put_word(out, std::uint32_t(tiles.size()));
  return out + all;
}

class TileFormats : public testing::Test {
 protected:
  SceneSources open(const std::string& content, const Json& transform = nullptr) {
    folder.write("content.bin", content);
    Json root = tile("content.bin");
    root["refine"] = "ADD";
    if (!transform.is_null()) root["transform"] = transform;
    return open_sources(folder.write("tileset.json", tileset(root)), {});
  }
  TileMesh read(const SceneSources& s, std::size_t i = 0) {
    return read_tile(s.tiles.at(i), s.root, ReadScope::everything);
  }
  std::string refusal(const std::string& content) {
    try {
      const SceneSources s = open(content);
      if (s.tiles.empty()) return s.skipped.at(0).reason;
      tile_hash(s.tiles.at(0), s.root);
      read(s);
    } catch (const InputError& e) {
      return e.what();
    }
    return "was read";
  }
  SourceFolder folder;
  const std::string square = test::square_gltf().dump();
};

/// Returns the place in the scene of the square's corner (1, 0, 1), y up, which is (1, -1, 0) with z up.
Point<Scene> corner(const TileMesh& mesh, std::size_t instance) {
  return mesh.instances.at(instance).scene_from_local({1, 0, 1});
}

TEST_F(TileFormats, AnI3dmPlacesOneMeshManyTimes) {
  const std::string floats = bytes_of<float>({10,
                                              0,
                                              0,
                                              0,
                                              20,
                                              0,
                                              /* up */ 0,
                                              0,
                                              1,
                                              0,
                                              1,
                                              0,
                                              /* right */ 0,
                                              1,
                                              0,
                                              1,
                                              0,
                                              0,
                                              /* scale */ 2,
                                              3,
                                              1,
                                              1,
                                              1,
                                              4,
                                              /* uniform */ 1,
                                              2});
  const Json table{{"INSTANCES_LENGTH", 2},
                   {"RTC_CENTER", {100, 0, 0}},
                   {"POSITION", {{"byteOffset", 0}}},
                   {"NORMAL_UP", {{"byteOffset", 24}}},
                   {"NORMAL_RIGHT", {{"byteOffset", 48}}},
                   {"SCALE_NON_UNIFORM", {{"byteOffset", 72}}},
                   {"SCALE", {{"byteOffset", 96}}}};
  const SceneSources s = open(i3dm(table, floats, square));
  EXPECT_EQ(s.tiles.at(0).kind, ContentKind::i3dm);
  const TileMesh mesh = read(s);
  EXPECT_EQ(mesh.primitives.size(), 1u);
  ASSERT_EQ(mesh.instances.size(), 2u);
  EXPECT_EQ(mesh.counts.triangles, 4u);
  // The instance maps x to 2 · (0,1,0) and y to 3 · (0,0,1). The corner (1, -1, 0) becomes (0, 2, -3); x moves by 110.
  EXPECT_EQ(corner(mesh, 0), (Point<Scene>{110, 2, -3}));
  // The instance maps x to 2 · (1,0,0) and y to 2 · (0,1,0). The corner becomes (2, -2, 0), moved by (100, 20, 0).
  EXPECT_EQ(corner(mesh, 1), (Point<Scene>{102, 18, 0}));
}

TEST_F(TileFormats, AnI3dmReadsQuantizedPositionsAndOctahedralNormals) {
  // In octahedral coordinates, up (+z) is the middle of the square, and right (+x) is the middle of its right edge.
  const std::string shorts =
      bytes_of<std::uint16_t>({65535, 0, 32768, /* up */ 32768, 32768, /* right */ 65535, 32768});
  const Json table{{"INSTANCES_LENGTH", 1},
                   {"POSITION_QUANTIZED", {{"byteOffset", 0}}},
                   {"QUANTIZED_VOLUME_OFFSET", {-5, 7, 0}},
                   {"QUANTIZED_VOLUME_SCALE", {10, 10, 10}},
                   {"NORMAL_UP_OCT32P", {{"byteOffset", 6}}},
                   {"NORMAL_RIGHT_OCT32P", {{"byteOffset", 10}}}};
  const Point<Scene> p = corner(read(open(i3dm(table, shorts, square))), 0);
  EXPECT_NEAR(p.x, 5 + 1, 1e-3);
  EXPECT_NEAR(p.y, 7, 1e-3);
  EXPECT_NEAR(p.z, 5 - 1, 1e-3);
}

TEST_F(TileFormats, EastNorthUpHoldsWhereAnInstanceStandsOnTheEarth) {
  const Geodetic place{46.5, 8.25, 1200};
  const Point<Ecef> p = ecef_of(place);
  const Json table{{"INSTANCES_LENGTH", 1},
                   {"EAST_NORTH_UP", true},
                   {"RTC_CENTER", {p.x, p.y, p.z}},
                   {"POSITION", {{"byteOffset", 0}}}};
  const SceneSources s = open_sources(
      [&] {
        folder.write("content.bin", i3dm(table, bytes_of<float>({0, 0, 0}), square));
        Json root = tile("content.bin");
        root["boundingVolume"] = {{"sphere", {p.x, p.y, p.z, 10}}};
        return folder.write("tileset.json", tileset(root));
      }(),
      {});
  ASSERT_TRUE(s.origin);
  const Point<Scene> q = corner(read(s), 0);
  EXPECT_NEAR(q.x, 1, 1e-6);
  EXPECT_NEAR(q.y, -1, 1e-6);
  EXPECT_NEAR(q.z, 0, 1e-6);
}

TEST_F(TileFormats, AnI3dmMayNameItsModel) {
  folder.write("models/square.gltf", square);
  const Json table{{"INSTANCES_LENGTH", 1}, {"POSITION", {{"byteOffset", 0}}}};
  const std::string content = i3dm(table, bytes_of<float>({1, 2, 3}), "models/square.gltf  ", true);
  const SceneSources s = open(content);
  EXPECT_EQ(corner(read(s), 0), (Point<Scene>{2, 1, 3}));
  const TileIdentity before = identify_tile(s.tiles[0], s.root);
  EXPECT_EQ(before.files.size(), 2u);
  Json other = test::square_gltf();
  other["nodes"][0]["translation"] = {0, 1, 0};
  folder.write("models/square.gltf", other);
  EXPECT_NE(tile_hash(s.tiles[0], s.root), before.hash) << "the model is part of the tile";
  EXPECT_THAT(refusal(i3dm(table, bytes_of<float>({1, 2, 3}), "../../etc/passwd", true)),
              HasSubstr("leaves the source folder"));
  EXPECT_THAT(refusal(i3dm(table, bytes_of<float>({1, 2, 3}), "gone.gltf", true)), HasSubstr("no such file"));
}

TEST_F(TileFormats, AnI3dmNamesWhatIsWrongWithItsTable) {
  EXPECT_THAT(refusal(i3dm({{"POSITION", {{"byteOffset", 0}}}}, "", square)),
              HasSubstr("INSTANCES_LENGTH: is missing"));
  EXPECT_THAT(refusal(i3dm({{"INSTANCES_LENGTH", 2}, {"POSITION", {{"byteOffset", 0}}}}, "123", square)),
              HasSubstr("POSITION: expected"));
  EXPECT_THAT(refusal(i3dm({{"INSTANCES_LENGTH", 4000000000u}, {"POSITION", {{"byteOffset", 0}}}}, "", square)),
              HasSubstr("more than 2^24 instances"));
  EXPECT_THAT(refusal(i3dm({{"INSTANCES_LENGTH", 1}}, "", square)), HasSubstr("POSITION: is missing"));
  EXPECT_THAT(refusal(i3dm({{"INSTANCES_LENGTH", 1}, {"POSITION", {{"byteOffset", 0}}}},
                           bytes_of<float>({INFINITY, 0, 0}), square)),
              HasSubstr("not finite"));
}

TEST_F(TileFormats, ACompositeIsTheTilesInIt) {
  const Json table{{"INSTANCES_LENGTH", 1}, {"POSITION", {{"byteOffset", 0}}}};
  const std::string there = i3dm(table, bytes_of<float>({5, 0, 0}), square);
  const SceneSources s = open(cmpt({b3dm(square), cmpt({there, "pnts" + b3dm("").substr(4)})}));
  ASSERT_EQ(s.tiles.size(), 2u);
  EXPECT_EQ(s.tiles[0].name, "content.bin[0]");
  EXPECT_EQ(s.tiles[1].name, "content.bin[1][0]");
  EXPECT_EQ(s.skipped.size(), 1u) << "the points";
  EXPECT_EQ(corner(read(s, 0), 0), (Point<Scene>{1, -1, 0}));
  EXPECT_EQ(corner(read(s, 1), 0), (Point<Scene>{6, -1, 0}));
  EXPECT_NE(tile_hash(s.tiles[0], s.root), tile_hash(s.tiles[1], s.root));
  std::string cut = cmpt({b3dm(square)});
  EXPECT_THAT(refusal(cut.substr(0, cut.size() - 1)), HasSubstr("ends inside a tile of the composite"));
  std::string nested = b3dm(square);
  for (int i = 0; i < 9; ++i) nested = cmpt({nested});
  EXPECT_THAT(refusal(nested), HasSubstr("nest deeper than 8"));
}

/// A quadtree with two levels per subtree and four levels in all, in JSON subtrees. In a subtree, bits 0 to 4 state
/// tiles and contents, and bits 0 to 15 state child subtrees.
class Implicit : public testing::Test {
 protected:
  void write_subtree(const std::string& name, unsigned tiles, unsigned contents, unsigned children) {
    const auto buffer = [&](const std::string& suffix, unsigned bits) {
      folder.write(name + suffix, std::string{char(bits), char(bits >> 8)});
      return Json{{"uri", std::filesystem::path(name + suffix).filename().string()}, {"byteLength", 2}};
    };
    const auto view = [](int i) { return Json{{"buffer", i}, {"byteOffset", 0}, {"byteLength", 2}}; };
    folder.write(name, Json{{"buffers", {buffer(".t", tiles), buffer(".c", contents), buffer(".s", children)}},
                            {"bufferViews", {view(0), view(1), view(2)}},
                            {"tileAvailability", {{"bitstream", 0}}},
                            {"contentAvailability", Json::array({Json{{"bitstream", 1}}})},
                            {"childSubtreeAvailability", {{"bitstream", 2}}}});
  }
  void write_content(const std::string& name) { folder.write("content/" + name + ".gltf", test::square_gltf()); }
  SceneSources open(const char* refine = "REPLACE") {
    Json root = tile("content/{level}_{x}_{y}.gltf");
    root["refine"] = refine;
    root["implicitTiling"] = {{"subdivisionScheme", "QUADTREE"},
                              {"subtreeLevels", 2},
                              {"availableLevels", 4},
                              {"subtrees", {{"uri", "subtrees/{level}.{x}.{y}.json"}}}};
    return open_sources(folder.write("tileset.json", tileset(root)), {});
  }
  static std::vector<std::string> names(const SceneSources& s) {
    std::vector<std::string> out;
    for (const TileRef& t : s.tiles) out.push_back(t.name);
    return out;
  }
  SourceFolder folder;
};

/// The root has the children 1 (x = 1) and 2 (y = 1). Below child 1, only the subtree 2/3/1 exists. Its bit is 7, the
/// Morton index of (3, 1).
TEST_F(Implicit, TakesTheFinestAvailableContent) {
  write_subtree("subtrees/0.0.0.json", 0b01101, 0b01101, 1u << 7);
  write_subtree("subtrees/2.3.1.json", 0b10001, 0b10001, 0);
  for (const char* name : {"0_0_0", "1_1_0", "1_0_1", "2_3_1", "3_7_3"}) write_content(name);
  EXPECT_THAT(names(open()), ElementsAre("content/3_7_3.gltf", "content/1_0_1.gltf"));
  EXPECT_THAT(names(open("ADD")), ElementsAre("content/0_0_0.gltf", "content/1_1_0.gltf", "content/2_3_1.gltf",
                                              "content/3_7_3.gltf", "content/1_0_1.gltf"));
}

TEST_F(Implicit, LetsTheAncestorStandInForMissingContentsAndSubtrees) {
  write_subtree("subtrees/0.0.0.json", 0b01101, 0b01101, 1u << 7);
  for (const char* name : {"0_0_0", "1_1_0", "1_0_1"}) write_content(name);
  SceneSources s = open();
  EXPECT_THAT(names(s), ElementsAre("content/1_1_0.gltf", "content/1_0_1.gltf"));
  ASSERT_EQ(s.skipped.size(), 1u);
  EXPECT_THAT(s.skipped[0].reason, HasSubstr("subtrees/2.3.1.json' is missing"));
  write_subtree("subtrees/2.3.1.json", 0b00001, 0b00001, 0);
  s = open();
  EXPECT_THAT(names(s), ElementsAre("content/1_1_0.gltf", "content/1_0_1.gltf"));
  EXPECT_THAT(s.skipped.at(0).reason, HasSubstr("content/2_3_1.gltf' is missing"));
}

TEST_F(Implicit, RefusesBitsThatAreNotThereAndEndlessTrees) {
  const auto refusal = [this] {
    try {
      const SceneSources s = open();
      if (!s.skipped.empty()) return s.skipped[0].reason;
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("was read");
  };
  write_subtree("subtrees/0.0.0.json", 1, 1, 0);
  folder.write("subtrees/0.0.0.json.t", std::string());
  EXPECT_THAT(refusal(), HasSubstr("exceeds a buffer of 0 bytes"));
  folder.write("subtrees/0.0.0.json", Json{{"tileAvailability", {{"constant", 1}}}});
  EXPECT_THAT(refusal(), HasSubstr("childSubtreeAvailability: is missing"));
  folder.write("subtrees/0.0.0.json", std::string("subt\1\0\0\0\377\377\377\377\377\377\377\177", 16));
  EXPECT_THAT(refusal(), HasSubstr("the file ends inside the subtree's header"));
  Json root = tile("a.gltf");
  root["implicitTiling"] = {{"subdivisionScheme", "OCTREE"},
                            {"subtreeLevels", 10},
                            {"availableLevels", 32},
                            {"subtrees", {{"uri", "all.json"}}}};
  const Json one{{"constant", 1}};
  folder.write(
      "all.json",
      Json{{"tileAvailability", one}, {"childSubtreeAvailability", one}, {"contentAvailability", Json::array({one})}});
  EXPECT_THROW(open_sources(folder.write("tileset.json", tileset(root)), {}), InputError);
}

TEST_F(Implicit, ReadsTheExtensionOf10AsTheCoreForm) {
  write_subtree("subtrees/0.0.0.json", 0b00001, 0b00001, 0);
  write_content("0_0_0");
  Json root = tile("content/{level}_{x}_{y}.gltf");
  root["extensions"]["3DTILES_implicit_tiling"] = {{"subdivisionScheme", "QUADTREE"},
                                                   {"subtreeLevels", 2},
                                                   {"maximumLevel", 1},
                                                   {"subtrees", {{"uri", "subtrees/{level}.{x}.{y}.json"}}}};
  Json subtree = Json::parse(R"({"buffers":[{"uri":"0.0.0.json.t","byteLength":2}],"bufferViews":[{"buffer":0,
      "byteOffset":0,"byteLength":1}],"tileAvailability":{"bufferView":0},"contentAvailability":{"bufferView":0},
      "childSubtreeAvailability":{"constant":0}})");
  folder.write("subtrees/0.0.0.json", subtree);
  EXPECT_THAT(names(open_sources(folder.write("tileset.json", tileset(root)), {})), ElementsAre("content/0_0_0.gltf"));
}

}  // namespace
}  // namespace gigabake
