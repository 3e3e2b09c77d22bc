/// Tilesets with unusable entries, with the spellings that tilers write, and with places that differ from their root's.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/math/georeference.h"
#include "format/source/source.h"
#include "source_scene.h"

namespace gigabake {
namespace {

using test::Json;
using test::SourceFolder;
using test::tile;
using test::tileset;
using testing::AnyOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const Geodetic zurich{47.37, 8.54, 430};

class TilesetEntries : public testing::Test {
 protected:
  TilesetEntries() {
    for (const char* name : {"a.gltf", "b.gltf", "coarse.gltf"}) folder.write(name, test::square_gltf());
  }
  SceneSources open(const Json& document, const SourceOptions& options = {}) const {
    return open_sources(folder.write("set.json", document), options);
  }
  static std::vector<std::string> names(const SceneSources& s) {
    std::vector<std::string> out;
    for (const TileRef& t : s.tiles) out.push_back(t.name);
    return out;
  }
  static std::string losses(const SceneSources& s) {
    std::string out;
    for (const SkippedSource& lost : s.skipped)
      out += (lost.informative ? "(" : "") + lost.name + ": " + lost.reason + "\n";
    return out;
  }
  SourceFolder folder;
};

Json adding(const Json& children) {
  Json root = tile("", children);
  root["refine"] = "ADD";
  return root;
}

/// Returns the column-major matrix that places z-up content at a point of the earth.
Json place_of(const Geodetic& place) {
  const Affine<Ecef, Scene> m = ecef_from_enu(place);
  Json out = Json::array();
  for (std::size_t column = 0; column < 4; ++column)
    for (std::size_t row = 0; row < 4; ++row) out.push_back(row < 3 ? m.m[row][column] : column == 3 ? 1.0 : 0.0);
  return out;
}

// 2026-11-25: each of these URIs made the whole tileset unreadable.
TEST_F(TilesetEntries, AUriThatCannotBeUsedCostsItsTile) {
  for (const char* uri : {"", "http://localhost/b.b3dm", "/etc/passwd", "../../../etc/passwd", "gone.b3dm"}) {
    Json lost = tile("x");
    lost["content"]["uri"] = uri;
    const SceneSources s = open(tileset(adding(Json::array({tile("a.gltf"), lost, tile("b.gltf")}))));
    EXPECT_THAT(names(s), ElementsAre("a.gltf", "b.gltf")) << uri;
    ASSERT_EQ(s.skipped.size(), 1u) << uri;
    EXPECT_FALSE(s.skipped[0].informative);
    EXPECT_THAT(losses(s), HasSubstr("set.json: root.children[1].content.uri")) << uri;
    // 2026-11-25: the place of an error is printed once, in the name of the entry.
    EXPECT_THAT(s.skipped[0].reason, Not(AnyOf(HasSubstr("set.json"), HasSubstr("root.children")))) << uri;
  }
}

TEST_F(TilesetEntries, AContentWithoutUriCostsItself) {
  for (const Json& content : {Json::object(), Json(7), Json{{"uri", 7}}}) {
    Json lost = tile("x");
    lost["content"] = content;
    const SceneSources s = open(tileset(adding(Json::array({tile("a.gltf"), lost}))));
    EXPECT_THAT(names(s), ElementsAre("a.gltf"));
    EXPECT_EQ(s.skipped.size(), 1u);
  }
}

TEST_F(TilesetEntries, AMalformedTileCostsWhatIsBelowIt) {
  Json bad = tile("b.gltf", Json::array({tile("a.gltf")}));
  bad["transform"] = {1, 2, 3};
  const SceneSources s = open(tileset(adding(Json::array({bad, tile("a.gltf")}))));
  EXPECT_THAT(names(s), ElementsAre("a.gltf"));
  EXPECT_THAT(losses(s), HasSubstr("root.children[0].transform: expected an array of 16 numbers"));
}

TEST_F(TilesetEntries, AnExternalTilesetThatCannotBeReadCostsItsTile) {
  Json future = tileset(tile("a.gltf"));
  future["asset"]["version"] = "2.7";
  Json magic = tileset(tile("a.gltf"));
  magic["extensionsRequired"] = {"VENDOR_magic"};
  folder.write("future.json", future);
  folder.write("magic.json", magic);
  folder.write("cut.json", std::string(R"({"asset": {"version": "1.0"}, "root": {)"));
  folder.write("no_archive.3tz", std::string("PK\x03\x04 and nothing else"));
  for (const char* uri : {"future.json", "magic.json", "cut.json", "no_archive.3tz"}) {
    const SceneSources s = open(tileset(adding(Json::array({tile(uri), tile("b.gltf")}))));
    EXPECT_THAT(names(s), ElementsAre("b.gltf")) << uri;
    EXPECT_EQ(s.skipped.size(), 1u) << uri;
  }
}

TEST_F(TilesetEntries, AnAncestorStandsInForAUriThatCannotBeFollowed) {
  Json root = tile("coarse.gltf", Json::array({tile("a.gltf"), tile("http://localhost/b.b3dm")}));
  root["refine"] = "REPLACE";
  EXPECT_THAT(names(open(tileset(root))), ElementsAre("coarse.gltf"));
}

// 2026-11-25: these spellings of members, versions and extensions were refused.
TEST_F(TilesetEntries, SpellingsOfTilersAreUnderstood) {
  Json document = tileset(adding(Json::array({tile("a.gltf")})));
  document["root"]["refine"] = "Add";
  document["extensionsUsed"] = document["extensionsRequired"] = {"3DTILES_batch_table_hierarchy", "MAXAR_content_3tz"};
  for (const char* version : {"1.0.0", "1.1.0", "1.0"}) {
    document["asset"]["version"] = version;
    EXPECT_THAT(names(open(document)), ElementsAre("a.gltf")) << version;
  }
  for (const char* version : {"1.05", "2.0.0", "1.0x"}) {
    document["asset"]["version"] = version;
    EXPECT_THROW(open(document), InputError) << version;
  }
}

TEST_F(TilesetEntries, BackslashesSeparateFolders) {
  folder.write("Data/T 1/a.gltf", test::square_gltf());
  EXPECT_THAT(names(open(tileset(tile("Data\\T%201\\a.gltf")))), ElementsAre("Data/T 1/a.gltf"));
  EXPECT_THAT(losses(open(tileset(adding(Json::array({tile("..\\..\\x.gltf")}))))), HasSubstr("leaves the source"));
}

TEST_F(TilesetEntries, NumbersThatJsonDoesNotHaveAreNamed) {
  for (const char* number : {"NaN", "Infinity", "-Infinity", "nan"}) {
    try {
      open_sources(folder.write("n.json", R"({"asset": {"version": "1.0"}, "geometricError": )" + std::string(number) +
                                              R"(, "root": {}})"),
                   {});
      FAIL() << number;
    } catch (const InputError& e) {
      const std::string name = number[0] == '-' ? number + 1 : number;
      EXPECT_THAT(e.what(), HasSubstr(name + " is not a JSON number"));
    }
  }
}

// 2026-11-25: a root around the earth's centre was read as a local scene. A root around the globe was placed off
// Africa.
TEST_F(TilesetEntries, ThePlaceIsThatOfTheContentWhereTheRootIsElsewhere) {
  Json child = tile("a.gltf");
  child["transform"] = place_of(zurich);
  const std::vector<Json> volumes{
      {{"box", {0, 0, 0, 7972671, 0, 0, 0, 7972671, 0, 0, 0, 7972671}}},
      {{"box", {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}}},
      {{"sphere", {0, 0, 0, 7972671}}},
      {{"region", {-3.141592653589793, -1.5707963267948966, 3.141592653589793, 1.5707963267948966, 0, 100}}},
      {{"region", {0, 0, 0, 0, 0, 0}}},
      {{"box", {1, 2, 3}}},
      Json::object()};
  for (const Json& volume : volumes) {
    Json root = adding(Json::array({child}));
    root["boundingVolume"] = volume;
    const SceneSources s = open(tileset(root));
    ASSERT_TRUE(s.origin) << volume;
    EXPECT_NEAR(s.origin->latitude_deg, zurich.latitude_deg, 1e-4) << volume;
    EXPECT_NEAR(s.origin->longitude_deg, zurich.longitude_deg, 1e-4) << volume;
    EXPECT_NEAR(s.origin->height_m, zurich.height_m, 2) << volume;
    SourceOptions options;
    options.origin = zurich;
    const SceneSources placed = open(tileset(root), options);
    const Point<Scene> corner = placed.tiles.at(0).scene_from_tile({0, 0, 0});
    EXPECT_NEAR(std::hypot(corner.x, corner.y, corner.z), 0, 1e-6) << volume;
    EXPECT_THAT(placed.skipped, testing::Each(testing::Field(&SkippedSource::informative, true)));
  }
}

TEST_F(TilesetEntries, ARootAtItsContentKeepsItsPlace) {
  Json root = adding(Json::array({tile("a.gltf")}));
  root["transform"] = place_of(zurich);
  const SceneSources s = open(tileset(root));
  EXPECT_NEAR(s.origin.value().latitude_deg, zurich.latitude_deg, 1e-9);
  EXPECT_THAT(s.notes, IsEmpty());
}

TEST_F(TilesetEntries, ContentInALocalFrameIsNotPlacedWhereItsRootSays) {
  Json root = adding(Json::array({tile("a.gltf")}));
  root["boundingVolume"] = {{"region", {0.15, 0.82, 0.16, 0.83, 0, 100}}};
  const SceneSources s = open(tileset(root));
  EXPECT_FALSE(s.origin);
  ASSERT_EQ(s.notes.size(), 1u);
  EXPECT_THAT(s.notes[0], HasSubstr("is in a local frame"));
}

class FolderOfTiles : public TilesetEntries {};

// 2026-11-25: coarse and fine tiles were baked together, without their placements.
TEST_F(FolderOfTiles, IsTheTilesetInItByWhateverName) {
  Json root = tile("coarse.gltf", Json::array({tile("a.gltf")}));
  root["refine"] = "REPLACE";
  folder.write("Production_1.json", tileset(root));
  folder.write("metadata.json", std::string("{\"root\": 3, no JSON"));
  EXPECT_THAT(names(open_sources(folder.path(), {})), ElementsAre("a.gltf"));
  folder.write("outer.json", tileset(tile("Production_1.json")));
  EXPECT_THAT(names(open_sources(folder.path(), {})), ElementsAre("a.gltf"));
  folder.write("other.json", tileset(tile("b.gltf")));
  EXPECT_THROW(open_sources(folder.path(), {}), InputError);
}

TEST_F(FolderOfTiles, IsRefusedWhereTilesetsAreBelowItOnly) {
  folder.write("sub/any.json", tileset(tile("../a.gltf")));
  try {
    open_sources(folder.path(), {});
    FAIL() << "was opened";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("any.json: is a tileset inside the folder; name it"));
  }
}

// 2026-11-25: all symbolic links were left out without a warning.
TEST_F(FolderOfTiles, FollowsLinksWithinItAndCountsTheOthers) {
  const SourceFolder outside;
  outside.write("far.gltf", test::square_gltf());
  folder.write("store/0123", test::square_gltf());
  namespace fs = std::filesystem;
  fs::create_symlink("store/0123", folder.path() / "linked.gltf");
  fs::create_symlink("a.gltf", folder.path() / "again.gltf");  // one file, twice
  fs::create_symlink(outside.path() / "far.gltf", folder.path() / "far.gltf");
  fs::create_symlink("nowhere.gltf", folder.path() / "broken.gltf");
  fs::create_directory_symlink(outside.path(), folder.path() / "out");
  const SceneSources s = open_sources(folder.path(), {});
  EXPECT_THAT(names(s), testing::SizeIs(4));
  ASSERT_EQ(s.notes.size(), 1u);
  EXPECT_THAT(s.notes[0],
              HasSubstr("3 symbolic links not followed, since they lead out of the folder or to no file: broken"));
}

}  // namespace
}  // namespace gigabake
