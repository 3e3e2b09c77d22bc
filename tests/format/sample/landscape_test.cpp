#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>

#include "sample/terrain/terrain_tile.h"

namespace gigabake::sample {
namespace {

using Place = std::pair<double, double>;

const Landscape& landscape() {
  static const Landscape made(384, 1);
  return made;
}

TerrainTile tile_at(MapPoint min, const TileFrame& frame, bool with_objects = false) {
  return make_tile(landscape(), frame, {min, {96, 96}, {48, 48}, {16, 16}, with_objects}, {});
}

/// Returns east, north and up of every vertex of a mesh, in the tile's frame.
std::vector<Corner> vertices(const TerrainTile& t, const GlbMesh& mesh) {
  std::vector<Corner> out;
  const auto& origin = t.model.translation_m;
  for (std::size_t i = 0; i < mesh.position.size(); i += 3)
    out.push_back({origin[0] + double(mesh.position[i]), -(origin[2] + double(mesh.position[i + 2])),
                   origin[1] + double(mesh.position[i + 1])});
  return out;
}

/// Returns east, north and up of the ground vertices of row or column `index` of the grid.
std::vector<std::array<double, 3>> ground_line(const TerrainTile& t, bool column, int index) {
  const std::vector<Corner> all = vertices(t, t.model.meshes[0]);
  std::vector<std::array<double, 3>> line;
  for (int k = 0; k <= 48; ++k) {
    const Corner& c = all[std::size_t(column ? k * 49 + index : index * 49 + k)];
    line.push_back({c.e_m, c.n_m, c.u_m});
  }
  return line;
}

TEST(TerrainTile, SharesItsBorderVerticesExactlyWithItsNeighboursOnTheEarthAndOnTheFlatMap) {
  const Earth earth({46.9312, 8.3017, 610});
  for (const TileFrame frame : {TileFrame{}, TileFrame{&earth}}) {
    const TerrainTile here = tile_at({-96, -96}, frame), east = tile_at({0, -96}, frame),
                      north = tile_at({-96, 0}, frame);
    EXPECT_EQ(ground_line(here, true, 48), ground_line(east, true, 0));
    EXPECT_EQ(ground_line(here, false, 48), ground_line(north, false, 0));
  }
}

TEST(TerrainTile, HasTheHousesWhoseCentresItHoldsWithWallsFromBelowTheGroundToAboveIt) {
  std::size_t houses = 0;
  for (const MapPoint min : {MapPoint{-96, -96}, {0, -96}, {-96, 0}, {0, 0}}) {
    const TerrainTile t = tile_at(min, {}, true);
    houses += t.houses;
    std::map<Place, std::vector<double>> posts;  // heights of wall corners at each place
    for (const GlbMesh& mesh : t.model.meshes)
      if (t.model.materials[std::size_t(mesh.material)].name == "wall")
        for (const Corner& c : vertices(t, mesh)) posts[{c.e_m, c.n_m}].push_back(c.u_m);
    for (const auto& [place, heights] : posts) {
      const double ground_m = landscape().relief.height_m({place.first, place.second});
      EXPECT_GT(*std::max_element(heights.begin(), heights.end()), ground_m + 1) << place.first << " " << place.second;
      if (heights.size() == 1) continue;  // a gable's tip has no other corner below it
      EXPECT_LT(*std::min_element(heights.begin(), heights.end()), ground_m) << place.first << " " << place.second;
    }
  }
  const auto& all = landscape().settlement.houses();
  EXPECT_EQ(houses, std::size_t(std::count_if(all.begin(), all.end(), [](const House& h) {
              return std::max(std::fabs(h.centre.e_m), std::fabs(h.centre.n_m)) < 96;
            })));
  EXPECT_GT(houses, 5u);
}

TEST(TerrainTile, RootsItsTreesInTheGround) {
  const TerrainTile t = tile_at({-192, -96}, {}, true);
  ASSERT_GT(t.trees, 10u);
  double deepest_m = 0;
  for (const Corner& c : vertices(t, t.model.meshes[1]))
    deepest_m = std::min(deepest_m, c.u_m - landscape().relief.height_m({c.e_m, c.n_m}));
  EXPECT_LT(deepest_m, -0.2);
  EXPECT_GT(deepest_m, -1.2);
}

TEST(Settlement, BuildsOnDryGroundClearOfRoadsAndOfOtherHouses) {
  const auto& [seed, relief, settlement, kit] = landscape();
  ASSERT_GT(settlement.houses().size(), 5u);
  for (const House& h : settlement.houses()) {
    EXPECT_GT(relief.river().at(h.centre).shore_m, 0);
    EXPECT_GT(settlement.roads().nearest(h.centre).edge_m, h.depth_m / 2);
    EXPECT_EQ(settlement.to_house_m(h.centre), 0);
    for (const House& other : settlement.houses()) {
      const bool itself = &h == &other;
      EXPECT_TRUE(itself || distance_m(h.centre, other.centre) > 8);
    }
  }
}

TEST(Settlement, GrowsTheSameTreesHoweverTheMapIsCut) {
  const Settlement& s = landscape().settlement;
  const auto whole = s.trees_in({-100, -100}, {100, 100});
  const auto left = s.trees_in({-100, -100}, {13, 100}), right = s.trees_in({13, -100}, {100, 100});
  EXPECT_EQ(whole.size(), left.size() + right.size());
}

TEST(Relief, LiesLevelUnderWaterAndAboveItBesides) {
  const Relief& relief = landscape().relief;
  for (int y = -190; y <= 190; y += 4)
    for (int x = -190; x <= 190; x += 4) {
      const MapPoint p{double(x), double(y)};
      const Reach reach = relief.river().at(p);
      if (reach.shore_m <= 0)
        EXPECT_EQ(relief.height_m(p), reach.level_m) << x << " " << y;
      else
        EXPECT_GT(relief.height_m(p), reach.level_m) << x << " " << y;
    }
}

TEST(Foliage, HasLeavesAndHolesBetweenThem) {
  const Picture p = paint_foliage(1);
  ASSERT_EQ(p.channels, 4);
  std::size_t leaves = 0, holes = 0;
  for (std::size_t i = 3; i < p.bytes.size(); i += 4) ++(p.bytes[i] == 255 ? leaves : holes);
  EXPECT_GT(leaves, p.bytes.size() / 4 / 6);
  EXPECT_GT(holes, p.bytes.size() / 4 / 10);
}

}  // namespace
}  // namespace gigabake::sample
