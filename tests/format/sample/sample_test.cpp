#include "sample/sample.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "format/source/source.h"

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

/// Returns a tile's box in the tileset, in metres: minimum east, north and up, then maximum east, north and up.
std::array<double, 6> box_of(const nlohmann::json& tile) {
  const std::vector<double> b = tile["boundingVolume"]["box"];
  return {b[0] - b[3], b[1] - b[7], b[2] - b[11], b[0] + b[3], b[1] + b[7], b[2] + b[11]};
}

void grow(std::array<double, 6>& box, const Point<Scene>& p) {
  const double at[3] = {p.x, p.y, p.z};
  for (std::size_t c = 0; c < 3; ++c) {
    box[c] = std::min(box[c], at[c]);
    box[c + 3] = std::max(box[c + 3], at[c]);
  }
}

std::array<double, 6> bounds_of(const TileMesh& mesh) {
  std::array<double, 6> box{1e9, 1e9, 1e9, -1e9, -1e9, -1e9};
  for (const Instance& instance : mesh.instances) {
    const std::vector<float>& p = mesh.primitives[std::size_t(instance.primitive)].position;
    for (std::size_t i = 0; i < p.size(); i += 3) grow(box, instance.scene_from_local({p[i], p[i + 1], p[i + 2]}));
  }
  return box;
}

TEST(Sample, GivesEveryTileTheBoxOfItsVerticesAndTheRootABoxAroundThemAll) {
  const Folder f;
  write_sample(f.path, small());
  const auto root = nlohmann::json::parse(std::ifstream(f.path / "tileset.json"))["root"];
  EXPECT_EQ(root["refine"], "REPLACE");
  EXPECT_GT(root["geometricError"], 0);
  const auto whole = box_of(root);
  const SceneSources s = open_sources(f.path / "tileset.json", {});
  for (const auto& child : root["children"]) {
    const auto source = std::find_if(s.tiles.begin(), s.tiles.end(), [&](const TileRef& t) {
      return t.name == child["content"]["uri"].get<std::string>();
    });
    ASSERT_NE(source, s.tiles.end());
    const auto box = box_of(child), vertices = bounds_of(read_tile(*source, s.root, ReadScope::positions_only));
    for (std::size_t c = 0; c < 6; ++c) {
      EXPECT_NEAR(box[c], vertices[c], 1e-3) << source->name << " " << c;
      EXPECT_LE((c < 3 ? 1 : -1) * whole[c], (c < 3 ? 1 : -1) * box[c]) << source->name << " " << c;
    }
  }
}

/// Expects `inner` to lie inside of `outer`, to a millimetre.
void expect_inside(const std::array<double, 6>& inner, const std::array<double, 6>& outer) {
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_GE(inner[c], outer[c] - 1e-3);
    EXPECT_LE(inner[c + 3], outer[c + 3] + 1e-3);
  }
}

/// The sample has 17 × 17 tiles: one block of 16 × 16 tiles, and three blocks at the rim that are one tile wide.
TEST(Sample, PutsManyTilesIntoBlocksThatAreTilesetsOfTheirOwn) {
  const Folder f;
  SampleOptions o = small(2);
  o.tiles = 17;
  o.ground_step_m = 4;
  o.texel_m = 4;
  const SampleReport report = write_sample(f.path, o);
  EXPECT_EQ(report.tiles, 17u * 17u);
  const SceneSources s = open_sources(f.path / "tileset.json", {});
  EXPECT_EQ(s.tiles.size(), 17u * 17u) << "the finest tiles, without a coarser mesh";
  EXPECT_TRUE(s.skipped.empty());
  std::uint64_t triangles = 0;
  for (const TileRef& t : s.tiles) triangles += read_tile(t, s.root, ReadScope::positions_only).counts.triangles;
  EXPECT_EQ(triangles, report.triangles);
  const auto root = nlohmann::json::parse(std::ifstream(f.path / "tileset.json"))["root"];
  ASSERT_EQ(root["children"].size(), 4u);
  std::size_t tiles = 0;
  for (const auto& child : root["children"]) {
    expect_inside(box_of(child), box_of(root));
    EXPECT_LT(child["geometricError"], root["geometricError"]);
    const std::string uri = child["content"]["uri"];
    const auto block = nlohmann::json::parse(std::ifstream(f.path / uri))["root"];
    EXPECT_FALSE(block.contains("transform")) << "only the outermost tileset states the place on the earth";
    EXPECT_EQ(box_of(block), box_of(child));
    EXPECT_TRUE(fs::exists(f.path / "tiles" / std::string(block["content"]["uri"])));
    for (const auto& tile : block["children"]) expect_inside(box_of(tile), box_of(block));
    tiles += block["children"].size();
  }
  EXPECT_EQ(tiles, 17u * 17u);
  EXPECT_EQ(open_sources(f.path / "local", {}).tiles.size(), 17u * 17u);
}

TEST(Sample, KeepsWhatHousesShowOnceForAllTiles) {
  const Folder f;
  write_sample(f.path, small());
  const SceneSources s = open_sources(f.path / "tileset.json", {});
  std::size_t shared = 0;
  for (const TileRef& t : s.tiles) {
    std::ifstream in(f.path / t.name, std::ios::binary);
    const std::string glb(std::istreambuf_iterator<char>(in), {});
    for (const char* name : {"textures/facade.jpg", "textures/roof.jpg", "textures/foliage.png"}) {
      if (glb.find(name) == std::string::npos) continue;
      ++shared;
      EXPECT_TRUE(fs::exists(f.path / "tiles" / name)) << name;
    }
  }
  EXPECT_GT(shared, 3u);
}

// 2026-11-25: a sample replaced an existing sample without confirmation.
TEST(Sample, RefusesAFolderThatHoldsASample) {
  const Folder f;
  const fs::path dir = f.path / "sample";
  SampleOptions fine = small();
  fine.tiles = 3;
  write_sample(dir, fine);
  const auto files = files_in(dir);
  EXPECT_TRUE(files.contains("local/tile_2_2.glb"));
  EXPECT_THROW(write_sample(dir, small()), InputError);
  EXPECT_EQ(files_in(dir), files) << "the former sample is unchanged";
}

TEST(Sample, TakesOverTheFolderOfARunThatWasKilled) {
  const Folder f, fresh;
  fs::create_directories(f.path / ".unfinished-gigabake-sample/tiles");
  fs::create_directories(f.path / "local");
  std::ofstream(f.path / "local/tile_7_7.glb") << "old";
  write_sample(f.path, small());
  write_sample(fresh.path, small());
  EXPECT_EQ(files_in(f.path), files_in(fresh.path));
}

TEST(Sample, RefusesOptionsAndFoldersThatItShouldNotTouch) {
  const Folder f;
  SampleOptions o = small();
  o.size_m = 3;
  EXPECT_THROW(write_sample(f.path / "new", o), UsageError);
  EXPECT_FALSE(fs::exists(f.path / "new"));
  std::ofstream(f.path / "tileset.json") << R"({"asset": {"version": "1.1", "generator": "another program"}})";
  EXPECT_THROW(write_sample(f.path, small()), InputError);
  EXPECT_THROW(write_sample(f.path / "tileset.json", small()), InputError);
  EXPECT_THROW(write_sample(f.path / "tileset.json/below", small()), InputError);
  EXPECT_EQ(files_in(f.path).size(), 1u);
}

}  // namespace
}  // namespace gigabake::sample
