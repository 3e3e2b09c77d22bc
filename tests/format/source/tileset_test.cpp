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
using testing::ElementsAre;
using testing::HasSubstr;

class TilesetTest : public testing::Test {
 protected:
  TilesetTest() {
    for (const char* name : {"root.gltf", "a.gltf", "b.gltf", "a1.gltf", "a2.gltf"})
      folder.write(name, test::square_gltf());
  }
  SceneSources open(const Json& root, const SourceOptions& options = {}) {
    return open_sources(folder.write("tileset.json", tileset(root)), options);
  }
  static std::vector<std::string> names(const SceneSources& s) {
    std::vector<std::string> out;
    for (const TileRef& t : s.tiles) out.push_back(t.name);
    return out;
  }
  SourceFolder folder;
};

Json refined(Json t, const char* how) {
  t["refine"] = how;
  return t;
}

TEST_F(TilesetTest, TakesTheFinestContentWhereTilesReplace) {
  const Json root = refined(
      tile("root.gltf", Json::array({tile("a.gltf", Json::array({tile("a1.gltf"), tile("a2.gltf")})), tile("b.gltf")})),
      "REPLACE");
  EXPECT_THAT(names(open(root)), ElementsAre("a1.gltf", "a2.gltf", "b.gltf"));
}

TEST_F(TilesetTest, TakesEverythingWhereTilesAdd) {
  const Json root = refined(tile("root.gltf", Json::array({tile("a.gltf"), tile("b.gltf")})), "ADD");
  EXPECT_THAT(names(open(root)), ElementsAre("root.gltf", "a.gltf", "b.gltf"));
}

TEST_F(TilesetTest, LetsTheNearestAncestorStandInForMissingContentWithoutDoublingSurfaces) {
  const Json root =
      refined(tile("root.gltf",
                   Json::array({tile("a.gltf", Json::array({tile("gone.gltf"), tile("a2.gltf")})), tile("b.gltf")})),
              "REPLACE");
  const SceneSources s = open(root);
  EXPECT_THAT(names(s), ElementsAre("a.gltf", "b.gltf"));
  ASSERT_EQ(s.skipped.size(), 1u);
  EXPECT_THAT(s.skipped[0].reason, HasSubstr("gone.gltf"));
  EXPECT_FALSE(s.skipped[0].informative);
}

TEST_F(TilesetTest, KeepsWhatIsFinerWhenNobodyCanStandIn) {
  const Json root = refined(tile("", Json::array({tile("gone.gltf"), tile("b.gltf")})), "REPLACE");
  const SceneSources s = open(root);
  EXPECT_THAT(names(s), ElementsAre("b.gltf"));
  EXPECT_EQ(s.skipped.size(), 1u);
}

TEST_F(TilesetTest, IgnoresMissingContentThatIsReplacedAnyway) {
  const Json root = refined(tile("gone.gltf", Json::array({tile("a.gltf")})), "REPLACE");
  const SceneSources s = open(root);
  EXPECT_THAT(names(s), ElementsAre("a.gltf"));
  EXPECT_TRUE(s.skipped.empty());
}

TEST_F(TilesetTest, FollowsExternalTilesetsAndComposesTheirTransforms) {
  Json inner = tile("../a.gltf");
  inner["transform"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 20, 0, 1};
  folder.write("sub/inner.json", tileset(inner));
  Json root = refined(tile("", Json::array({tile("sub/inner.json?token=1")})), "REPLACE");
  root["transform"] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 5, 0, 0, 1};
  const SceneSources s = open(root);
  ASSERT_THAT(names(s), ElementsAre("a.gltf"));
  EXPECT_EQ(s.tiles[0].scene_from_tile({1, 1, 1}), (Point<Scene>{7, 42, 2}));
}

TEST_F(TilesetTest, RefusesCyclesDeepAndShallow) {
  folder.write("other.json", tileset(refined(tile("tileset.json"), "ADD")));
  EXPECT_THROW(open(refined(tile("other.json"), "ADD")), InputError);
}

TEST_F(TilesetTest, RefusesRequiredExtensionsThatItDoesNotKnow) {
  Json t = tileset(refined(tile("a.gltf"), "ADD"));
  t["extensionsRequired"] = {"VENDOR_magic"};
  EXPECT_THROW(open_sources(folder.write("tileset.json", t), {}), InputError);
}

TEST_F(TilesetTest, StandsOnTheEarthWhereItsRootDoes) {
  const Geodetic place{46.5, 8.25, 1200};
  Json root = refined(tile("a.gltf"), "ADD");
  root["transform"] = Json::array();
  const Affine<Ecef, Scene> enu = ecef_from_enu(place);
  for (std::size_t c = 0; c < 4; ++c)
    for (std::size_t r = 0; r < 4; ++r) root["transform"].push_back(r < 3 ? enu.m[r][c] : (c == 3 ? 1.0 : 0.0));
  const SceneSources s = open(root);
  ASSERT_TRUE(s.origin);
  EXPECT_NEAR(s.origin->latitude_deg, 46.5, 1e-12);
  EXPECT_NEAR(s.origin->height_m, 1200, 1e-8);
  const Point<Scene> p = s.tiles[0].scene_from_tile({100, -50, 3});
  EXPECT_NEAR(p.x, 100, 1e-8);
  EXPECT_NEAR(p.y, -50, 1e-8);
  EXPECT_NEAR(p.z, 3, 1e-8);
  EXPECT_FALSE(open(root, {true, {}, {}}).origin);
}

TEST_F(TilesetTest, ReportsPointsAsInformative) {
  folder.write("cloud.pnts", std::string("pnts") + std::string(24, '\0'));
  const Json root = refined(tile("cloud.pnts", Json::array({tile("a.gltf")})), "ADD");
  const SceneSources s = open(root);
  ASSERT_EQ(s.skipped.size(), 1u);
  EXPECT_TRUE(s.skipped[0].informative);
}

TEST_F(TilesetTest, SceneFilesPlaceSourcesByMetresHeadingAndScale) {
  const Json scene{
      {"gigabake", 1},
      {"sources",
       Json::array({{{"path", "a.gltf"}, {"place", {{"position_m", {10, 20, 30}}}}, {"heading_deg", 90}, {"scale", 2}},
                    {{"path", "b.gltf"}}})}};
  const SceneSources s = open_sources(folder.write("scene.json", scene), {});
  ASSERT_EQ(s.tiles.size(), 2u);
  const Point<Scene> p = s.tiles[0].scene_from_tile({1, 0, 0});  // east turns to south
  EXPECT_NEAR(p.x, 10, 1e-12);
  EXPECT_NEAR(p.y, 18, 1e-12);
  EXPECT_NEAR(p.z, 30, 1e-12);
}

}  // namespace
}  // namespace gigabake
