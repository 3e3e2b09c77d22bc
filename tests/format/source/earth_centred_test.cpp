// Mesh files with earth-centred coordinates. 2026-11-22: they were baked tilted.
#include "format/source/earth_centred.h"

#include <cmath>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/math/georeference.h"
#include "core/math/transform.h"
#include "format/source/source.h"
#include "source_scene.h"

namespace gigabake {
namespace {

using test::Json;
using test::SourceFolder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

const Geodetic house_place{47.3, 8.5, 512};

std::string b3dm(const Json& table, const Json& gltf) {
  std::string json = table.dump(), model = gltf.dump();
  const std::uint32_t words[] = {1, std::uint32_t(28 + json.size() + model.size()), std::uint32_t(json.size()), 0, 0,
                                 0};
  return "b3dm" + std::string(reinterpret_cast<const char*>(words), sizeof words) + json + model;
}

std::array<double, 3> centre_m(const Geodetic& g = house_place) {
  const Point<Ecef> p = ecef_of(g);
  return {p.x, p.y, p.z};
}

/// Returns square_gltf(), placed upright at `house_place`: 1 m wide to the east and 1 m high. Its node converts z-up to
/// y-up, because the tileset reader converts back.
Json standing_square(bool with_position) {
  Affine<World, World> y_up;
  y_up.m = {{{1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}}};
  Affine<World, World> enu, upright;
  enu.m = ecef_from_enu(house_place).m;
  upright.m = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};  // identity: the square's z is its height
  if (!with_position)
    for (auto& row : enu.m) row[3] = 0;
  const auto m = (y_up * enu * upright).m;
  Json gltf = test::square_gltf();
  gltf["nodes"][0]["matrix"] = Json::array();
  for (std::size_t c = 0; c < 4; ++c)
    for (std::size_t r = 0; r < 4; ++r) gltf["nodes"][0]["matrix"].push_back(r < 3 ? m[r][c] : (c == 3 ? 1.0 : 0.0));
  gltf["accessors"][0]["min"] = {0, 0, 0};
  gltf["accessors"][0]["max"] = {1, 0, 1};
  return gltf;
}

std::vector<Point<Scene>> vertices(const SceneSources& s, std::size_t tile = 0) {
  const TileMesh mesh = read_tile(s.tiles.at(tile), s.root, ReadScope::everything);
  std::vector<Point<Scene>> out;
  for (const Instance& i : mesh.instances) {
    const std::vector<float>& p = mesh.primitives[std::size_t(i.primitive)].position;
    for (std::size_t v = 0; v + 2 < p.size(); v += 3) out.push_back(i.scene_from_local({p[v], p[v + 1], p[v + 2]}));
  }
  return out;
}

void expect_standing_square(const SceneSources& s) {
  ASSERT_TRUE(s.origin);
  EXPECT_NEAR(s.origin->latitude_deg, house_place.latitude_deg, 2e-5);
  EXPECT_NEAR(s.origin->longitude_deg, house_place.longitude_deg, 2e-5);
  EXPECT_NEAR(s.origin->height_m, house_place.height_m, 1.5);
  const std::vector<Point<Scene>> v = vertices(s);
  const auto edge = [&](std::size_t i) { return Point<Scene>{v[i].x - v[0].x, v[i].y - v[0].y, v[i].z - v[0].z}; };
  EXPECT_NEAR(edge(1).x, 1, 1e-6);  // to 1e-6 m: east at the place and at the origin differ
  EXPECT_NEAR(edge(1).z, 0, 1e-6);
  EXPECT_NEAR(edge(3).x, 0, 1e-6);
  EXPECT_NEAR(edge(3).z, 1, 1e-6);
}

class EarthCentred : public testing::Test {
 protected:
  SceneSources open(const std::string& name, const SourceOptions& options = {}) {
    return open_sources(folder.path() / name, options);
  }
  std::string refusal(const std::string& name) {
    try {
      open(name);
    } catch (const InputError& e) {
      return e.what();
    }
    return "was read";
  }
  void write_tile(const std::string& name) {
    folder.write(name, b3dm({{"BATCH_LENGTH", 0}, {"RTC_CENTER", centre_m()}}, standing_square(false)));
  }
  SourceFolder folder;
};

TEST_F(EarthCentred, ATileStandsUprightHoweverItSaysWhereItIs) {
  Json rtc = standing_square(false);
  rtc["extensions"]["CESIUM_RTC"]["center"] = centre_m();
  write_tile("a.b3dm");
  folder.write("b.gltf", rtc);
  folder.write("c.gltf", standing_square(true));
  for (const char* name : {"a.b3dm", "b.gltf", "c.gltf"}) {
    SCOPED_TRACE(name);
    const SceneSources s = open(name);
    expect_standing_square(s);
    EXPECT_THAT(s.notes, ElementsAre(HasSubstr("earth-centred coordinates, placed on the earth")));
  }
  expect_standing_square(open(""));
  EXPECT_EQ(open("").tiles.size(), 3u);
}

/// 2026-11-22: a tile with earth-centred coordinates was baked tilted, in a local frame, without a warning.
TEST_F(EarthCentred, ATileAloneIsWhereItsTilesetPutsIt) {
  write_tile("a.b3dm");
  Json root = test::tile("a.b3dm");
  const auto c = centre_m();
  root["boundingVolume"] = {{"sphere", {c[0], c[1], c[2], 5}}};
  folder.write("set.json", test::tileset(root));
  const SourceOptions options{false, Geodetic{47.31, 8.49, 400}, {}};
  const SceneSources alone = open("a.b3dm", options), in_set = open("set.json", options);
  EXPECT_EQ(alone.origin, in_set.origin);
  EXPECT_EQ(vertices(alone), vertices(in_set));
}

TEST_F(EarthCentred, AnObjIsZUpThere) {
  const Affine<Ecef, Scene> enu = ecef_from_enu(house_place);
  std::string text;
  for (const Point<Scene>& p : {Point<Scene>{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}}) {
    const Point<Ecef> q = enu(p);
    text += fmt::format("v {:.6f} {:.6f} {:.6f}\n", q.x, q.y, q.z);
  }
  folder.write("a.obj", text + "f 1 2 3 4\n");
  expect_standing_square(open("a.obj"));
}

TEST_F(EarthCentred, InstancesStandWhereEachOfThemHasEastAndNorth) {
  const auto c = centre_m();
  const std::string model = test::square_gltf().dump();
  const std::string table =
      Json{{"INSTANCES_LENGTH", 1}, {"RTC_CENTER", c}, {"EAST_NORTH_UP", true}, {"POSITION", {{"byteOffset", 0}}}}
          .dump();
  const std::uint32_t words[] = {
      1, std::uint32_t(32 + table.size() + 12 + model.size()), std::uint32_t(table.size()), 12, 0, 0, 1};
  folder.write("a.i3dm", "i3dm" + std::string(reinterpret_cast<const char*>(words), sizeof words) + table +
                             std::string(12, '\0') + model);
  const SceneSources s = open("a.i3dm");
  ASSERT_TRUE(s.origin);
  for (const Point<Scene>& p : vertices(s)) EXPECT_NEAR(p.z, 0, 1e-6);  // the model lies on the ground
}

/// 2026-11-22: --origin printed an origin and left the coordinates 6,400 km away.
TEST_F(EarthCentred, WhatIsNotUsedSoIsSaid) {
  write_tile("a.b3dm");
  const SceneSources s = open("a.b3dm", {true, {}, {}});
  EXPECT_FALSE(s.origin);
  EXPECT_THAT(s.notes, ElementsAre(HasSubstr("6,400 km")));
}

TEST_F(EarthCentred, AMixIsRefusedByName) {
  write_tile("a.b3dm");
  folder.write("b.gltf", test::square_gltf());
  EXPECT_THAT(refusal(""), HasSubstr("a.b3dm holds earth-centred coordinates and b.gltf does not"));
}

TEST_F(EarthCentred, AFileThatCannotBeReadIsLeftToTheScan) {
  write_tile("a.b3dm");
  folder.write("b.gltf", std::string("{"));
  folder.write("c.b3dm", std::string("b3dm\x01"));
  expect_standing_square(open(""));
}

TEST_F(EarthCentred, InASceneATileWithoutAPlaceStaysWhereItIs) {
  write_tile("a.b3dm");
  folder.write("house.gltf", test::square_gltf());
  const Json house{{"path", "house.gltf"}, {"place", {{"lon_lat_height", {8.5, 47.3, 512}}}}};
  folder.write("scene.json", Json{{"gigabake", 1}, {"sources", Json::array({{{"path", "a.b3dm"}}, house})}});
  const SceneSources s = open("scene.json");
  expect_standing_square(s);
  const Point<Scene> a = vertices(s, 0).at(0), b = vertices(s, 1).at(0);
  EXPECT_NEAR(std::hypot(a.x - b.x, a.y - b.y, a.z - b.z), 0, 1e-6);
}

/// Returns an OBJ with a triangle whose first corner is (x, y, z) and which is 100 m wide along x and y.
std::string square_at(double x, double y, double z) {
  return fmt::format("v {0} {1} {2}\nv {3} {1} {2}\nv {3} {4} {2}\nf 1 2 3\n", x, y, z, x + 100, y + 100);
}

TEST_F(EarthCentred, ProjectedCoordinatesAreNotTakenForTheEarth) {
  folder.write("sweref99_gothenburg.obj", square_at(319000, 6400000, 20));
  folder.write("sweref99_boras.obj", square_at(377000, 6368000, 150));
  folder.write("gauss_kruger_ulm.obj", square_at(3572000, 5363000, 478));
  folder.write("utm32_zurich.obj", square_at(465000, 5247000, 408));
  for (const char* name : {"sweref99_gothenburg.obj", "sweref99_boras.obj", "gauss_kruger_ulm.obj", "utm32_zurich.obj"})
    for (const UpAxis up : {UpAxis::z, UpAxis::y}) EXPECT_FALSE(open(name, {false, {}, up}).origin) << name;
  EXPECT_THAT(open("utm32_zurich.obj").notes, IsEmpty());
  EXPECT_THAT(open("sweref99_boras.obj").notes, ElementsAre(HasSubstr("may hold projected coordinates")));
}

WorldBox box_at(const Geodetic& g, double half_m) {
  const Point<Ecef> c = ecef_of(g);
  WorldBox out;
  out.add({c.x - half_m, c.y - half_m, c.z - half_m});
  out.add({c.x + half_m, c.y + half_m, c.z + half_m});
  return out;
}

TEST(EarthFit, IsTheSurfaceOfTheEllipsoidAndSmallAgainstIt) {
  for (const double latitude : {-85.0, -35.0, 0.3, 47.0, 80.0, 90.0})
    for (const double longitude : {-177.0, -71.0, 3.0, 8.0, 120.0}) {
      EXPECT_EQ(earth_fit(box_at({latitude, longitude, 300}, 500)), EarthFit::surface) << latitude << " " << longitude;
      EXPECT_EQ(earth_fit(box_at({latitude, longitude, -20e3}, 500)), EarthFit::none);
      EXPECT_EQ(earth_fit(box_at({latitude, longitude, 30e3}, 500)), EarthFit::none);
      EXPECT_EQ(earth_fit(box_at({latitude, longitude, 0}, 2e6)), EarthFit::none);
    }
  EXPECT_EQ(earth_fit(box_at({51.5, 0, 30}, 500)), EarthFit::surface);
  EXPECT_EQ(earth_fit(WorldBox()), EarthFit::none);
  EXPECT_EQ(earth_fit(box_at({0.01, 100, 3}, 100)), EarthFit::or_projected);
}

}  // namespace
}  // namespace gigabake
