#include "format/sample/sample.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>

#include "format/error.h"
#include "format/sample/terrain_tile.h"
#include "format/source.h"

namespace gigabake::sample {
namespace {

namespace fs = std::filesystem;

struct Folder {
  fs::path path;
  Folder() {
    std::string name = (fs::temp_directory_path() / "gigabake-sample-XXXXXX").string();
    path = fs::canonical(mkdtemp(name.data()));
  }
  ~Folder() { fs::remove_all(path); }
};

SampleOptions small(int threads = 1) {
  SampleOptions o;
  o.size_m = 160;
  o.tiles = 2;
  o.ground_step_m = 2;
  o.texel_m = 1;
  o.threads = threads;
  return o;
}

std::map<std::string, std::string> files_in(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) {
      std::ifstream in(entry.path(), std::ios::binary);
      files[entry.path().lexically_relative(folder).string()] = std::string(std::istreambuf_iterator<char>(in), {});
    }
  return files;
}

TEST(Sample, GivesTheSameBytesAgainAndForAnyThreads) {
  const Folder a, b;
  write_sample(a.path, small(1));
  write_sample(b.path, small(2));
  EXPECT_EQ(files_in(a.path), files_in(b.path));
  SampleOptions other = small();
  other.seed = 2;
  const Folder c;
  write_sample(c.path, other);
  EXPECT_NE(files_in(a.path), files_in(c.path));
}

TEST(Sample, IsATilesetOnTheEarthWhoseTilesReplaceTheOverview) {
  const Folder f;
  const SampleReport report = write_sample(f.path, small());
  const SceneSources s = open_sources(f.path / "tileset.json", {});
  ASSERT_TRUE(s.origin);
  EXPECT_NEAR(s.origin->latitude_deg, small().origin.latitude_deg, 1e-9);
  EXPECT_EQ(s.tiles.size(), 4u);
  EXPECT_TRUE(s.skipped.empty());
  std::uint64_t triangles = 0;
  bool has_mask = false;
  for (const TileRef& t : s.tiles) {
    const TileMesh mesh = read_tile(t, s.root, ReadScope::everything);
    triangles += mesh.counts.triangles;
    for (const Material& m : mesh.materials)
      if (m.alpha_mode == AlphaMode::mask && m.texture.image >= 0)
        has_mask |= decode_image(mesh.images[std::size_t(m.texture.image)]).has_alpha;
  }
  EXPECT_EQ(triangles, report.triangles);
  EXPECT_GT(report.houses, 0u);
  EXPECT_GT(report.trees, 0u);
  EXPECT_TRUE(has_mask);
  EXPECT_EQ(open_sources(f.path / "local", {}).tiles.size(), 4u);
}

/// Ground vertices of a tile in the frame, by position east and north.
std::map<std::pair<double, double>, double> border(const TerrainTile& t, double east_m) {
  std::map<std::pair<double, double>, double> out;
  const GlbMesh& ground = t.model.meshes[0];
  for (std::size_t i = 0; i < ground.position.size(); i += 3) {
    const double e = t.model.translation_m[0] + double(ground.position[i]);
    if (std::fabs(e - east_m) < 1e-6)
      out[{e, -(t.model.translation_m[2] + double(ground.position[i + 2]))}] =
          t.model.translation_m[1] + double(ground.position[i + 1]);
  }
  return out;
}

TEST(Sample, NeighbouringTilesShareTheirBorderExactly) {
  const Relief relief(160, 3);
  const Settlement settlement(relief, 3);
  const TilePlan west{{-80, -80}, 80, 40, 16, false}, east{{0, -80}, 80, 40, 16, false};
  const auto a = border(make_tile(relief, settlement, 3, {}, west), 0),
             b = border(make_tile(relief, settlement, 3, {}, east), 0);
  EXPECT_EQ(a.size(), 41u);
  EXPECT_EQ(a, b);
}

TEST(Sample, HousesStandOnDryGroundClearOfRoadsAndOfEachOther) {
  const Relief relief(384, 1);
  const Settlement settlement(relief, 1);
  ASSERT_GT(settlement.houses().size(), 5u);
  for (const House& h : settlement.houses()) {
    EXPECT_GT(relief.river().at(h.centre).shore_m, 0);
    EXPECT_GT(settlement.roads().nearest(h.centre).edge_m, 0);
    for (const House& other : settlement.houses()) {
      const bool itself = &h == &other;
      EXPECT_TRUE(itself || distance_m(h.centre, other.centre) > 8);
    }
  }
}

TEST(Sample, TreesOfATileAreThoseOfItsHalves) {
  const Relief relief(200, 1);
  const Settlement settlement(relief, 1);
  const auto whole = settlement.trees_in({-100, -100}, {100, 100});
  const auto left = settlement.trees_in({-100, -100}, {13, 100}), right = settlement.trees_in({13, -100}, {100, 100});
  EXPECT_EQ(whole.size(), left.size() + right.size());
}

TEST(Sample, RefusesOptionsAndFoldersThatItShouldNotTouch) {
  const Folder f;
  SampleOptions o = small();
  o.size_m = 3;
  EXPECT_THROW(write_sample(f.path, o), UsageError);
  std::ofstream(f.path / "thesis.tex") << "mine";
  EXPECT_THROW(write_sample(f.path, small()), InputError);
  EXPECT_EQ(files_in(f.path).size(), 1u);
}

}  // namespace
}  // namespace gigabake::sample
