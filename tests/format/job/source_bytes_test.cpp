#include "format/job/source_bytes.h"

#include <cmath>
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <random>

#include "core/base/error.h"
#include "format/edit/edit_json.h"
#include "format/edit/source_edit_json.h"
#include "format/source/levels/named_voxel_sizes.h"
#include "format/source/raster/dem.h"

namespace gigabake {
namespace {

using Random = std::mt19937_64;

constexpr std::uint64_t seed = 20261122;

std::string random_name(Random& random) {
  static const std::string letters = "ab/c.ä\\ ";
  std::string name;
  for (std::uint64_t n = random() % 40; n > 0; --n) name += letters[random() % letters.size()];
  return name;
}

template <class Place>
void make_random(Place& place, Random& random) {
  std::uniform_real_distribution<double> number(-1e7, 1e7);
  for (auto& row : place.m)
    for (double& v : row) v = random() % 8 == 0 ? -0.0 : number(random);
}

std::shared_ptr<const DemRaster> random_raster(Random& random) {
  auto raster = std::make_shared<DemRaster>();
  raster->columns = int(2 + random() % 1000), raster->rows = int(2 + random() % 1000);
  for (std::uint64_t parts = 1 + random() % 3; parts > 0; --parts) {
    DemPart part;
    DemOptions& o = part.options;
    o.dem = random_name(random);
    if (random() % 2 == 0) o.ortho = random_name(random);
    o.crs = random_name(random), o.ortho_crs = random_name(random);
    if (random() % 2 == 0) o.nodata = {-9999.5, 0};
    if (random() % 2 == 0) o.height_scale = 0.3048;
    o.geoid_offset_m = double(random() % 100) / 3;
    o.tile_cells = int(1 + random() % 100);
    for (std::uint64_t grids = random() % 3; grids > 0; --grids) part.grids.push_back(random_name(random));
    part.column = int(random() % std::uint64_t(raster->columns - 1));
    part.row = int(random() % std::uint64_t(raster->rows - 1));
    part.columns = 2 + int(random() % std::uint64_t(raster->columns - 1 - part.column));
    part.rows = 2 + int(random() % std::uint64_t(raster->rows - 1 - part.row));
    raster->parts.push_back(part);
  }
  raster->texels_per_cell = int(1 + random() % 100);
  raster->geotransform = {5e5, 2, 0.1, 5.1e6, 0.2, -2};
  raster->is_on_earth = random() % 2 == 0;
  raster->origin = {46.5, -8.25, 1e3 / 3};
  return raster;
}

std::shared_ptr<const DemTile> random_dem(const std::shared_ptr<const DemRaster>& raster, Random& random) {
  auto dem = std::make_shared<DemTile>();
  dem->raster = raster;
  dem->column = int(random() % std::uint64_t(raster->columns - 1));
  dem->row = int(random() % std::uint64_t(raster->rows - 1));
  dem->columns = 1 + int(random() % std::uint64_t(raster->columns - 1 - dem->column));
  dem->rows = 1 + int(random() % std::uint64_t(raster->rows - 1 - dem->row));
  dem->offset_m = {1, -2, 3e6};
  return dem;
}

/// Returns sources in which adjacent tiles mostly have the same folder and placement, as in a tileset.
SceneSources random_sources(Random& random, std::size_t tiles) {
  SceneSources s;
  s.root = random_name(random);
  if (random() % 2 == 0) s.origin = Geodetic{47.1, -8.25, 400.0 / 3};
  const auto raster = random_raster(random);
  const auto edits = std::make_shared<const SourceEdits>(
      SourceEdits{{{SourceEditType::flatten, EditFrame::degrees, {{{8, 47}, {8.5, 47}, {8.1, 47.3}}}, double(tiles)}}});
  Edit some_edit;
  some_edit.shape = SphereShape{{1, 2, 3}, 4};
  if (random() % 2 == 0) s.edits = std::make_shared<const EditList>(EditList{some_edit});
  NamedVoxelSizes sizes{{{"glass", {}, 3}}, {{"", {}, 10}, {"Tree_17", {}, 0}}, "scene.json", "sources[0]"};
  const auto named_sizes = std::make_shared<const NamedVoxelSizes>(sizes);
  TileRef tile;
  for (std::size_t i = 0; i < tiles; ++i) {
    tile.kind = ContentKind(random() % 8);
    tile.gltf_up = UpAxis(random() % 3);
    tile.path = random() % 4 == 0 ? random_name(random) : tile.path.string() + std::to_string(random() % 10);
    tile.name = random() % 4 == 0 ? random_name(random) : tile.name + "x";
    if (random() % 3 == 0) make_random(tile.scene_from_tile, random);
    if (random() % 3 == 0) make_random(tile.world_from_tile, random);
    tile.bytes = random();
    tile.range = random() % 4 == 0 ? ByteRange{random(), random()} : ByteRange{};
    tile.dem = tile.kind == ContentKind::dem ? random_dem(raster, random) : nullptr;
    if (random() % 3 == 0) tile.edits = edits;
    tile.lod = std::uint8_t(random() % 11);
    tile.named_sizes = random() % 3 == 0 ? named_sizes : nullptr;
    s.tiles.push_back(tile);
  }
  for (std::uint64_t n = random() % 4; n > 0; --n)
    s.skipped.push_back({random_name(random), random_name(random), random() % 2 == 0, random()});
  for (std::uint64_t n = random() % 4; n > 0; --n) s.notes.push_back(random_name(random));
  return s;
}

template <class Place>
bool same_bits(const Place& a, const Place& b) {
  return std::memcmp(&a.m, &b.m, sizeof a.m) == 0;
}

void expect_same(const DemTile& a, const DemTile& b) {
  ASSERT_EQ(a.raster->parts.size(), b.raster->parts.size());
  for (std::size_t i = 0; i < a.raster->parts.size(); ++i) {
    const DemPart &p = a.raster->parts[i], &q = b.raster->parts[i];
    EXPECT_EQ(p.options.dem, q.options.dem);
    EXPECT_EQ(p.options.ortho, q.options.ortho);
    EXPECT_EQ(p.options.crs, q.options.crs);
    EXPECT_EQ(p.options.ortho_crs, q.options.ortho_crs);
    EXPECT_EQ(p.options.nodata, q.options.nodata);
    EXPECT_EQ(p.options.height_scale, q.options.height_scale);
    EXPECT_EQ(p.options.geoid_offset_m, q.options.geoid_offset_m);
    EXPECT_EQ(p.options.tile_cells, q.options.tile_cells);
    EXPECT_EQ(p.grids, q.grids);
    EXPECT_EQ(std::tuple(p.column, p.row, p.columns, p.rows), std::tuple(q.column, q.row, q.columns, q.rows));
  }
  EXPECT_EQ(a.raster->texels_per_cell, b.raster->texels_per_cell);
  EXPECT_EQ(a.raster->geotransform, b.raster->geotransform);
  EXPECT_EQ(a.raster->is_on_earth, b.raster->is_on_earth);
  EXPECT_EQ(std::pair(a.raster->columns, a.raster->rows), std::pair(b.raster->columns, b.raster->rows));
  EXPECT_EQ(a.raster->origin, b.raster->origin);
  EXPECT_EQ(std::tuple(a.column, a.row, a.columns, a.rows), std::tuple(b.column, b.row, b.columns, b.rows));
  EXPECT_EQ(a.offset_m, b.offset_m);
}

void expect_same(const TileRef& a, const TileRef& b) {
  EXPECT_EQ(a.path, b.path);
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.gltf_up, b.gltf_up);
  EXPECT_TRUE(same_bits(a.scene_from_tile, b.scene_from_tile));
  EXPECT_TRUE(same_bits(a.world_from_tile, b.world_from_tile));
  EXPECT_EQ(a.bytes, b.bytes);
  EXPECT_EQ(a.range, b.range);
  EXPECT_EQ(a.archive == nullptr, b.archive == nullptr);
  ASSERT_EQ(a.dem == nullptr, b.dem == nullptr);
  if (a.dem) expect_same(*a.dem, *b.dem);
  ASSERT_EQ(a.edits == nullptr, b.edits == nullptr);
  EXPECT_EQ(a.edits ? to_json(*a.edits) : "", b.edits ? to_json(*b.edits) : "");
  EXPECT_EQ(a.lod, b.lod);
  ASSERT_EQ(a.named_sizes == nullptr, b.named_sizes == nullptr);
  if (!a.named_sizes) return;
  EXPECT_EQ(to_json(*a.named_sizes), to_json(*b.named_sizes));
  EXPECT_EQ(a.named_sizes->file, b.named_sizes->file);
  EXPECT_EQ(a.named_sizes->key, b.named_sizes->key);
}

TEST(SourceBytes, ComeBackAsTheSameSources) {
  Random random(seed);
  for (const std::size_t tiles : {0u, 1u, 2u, 50u, 500u}) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", tiles " + std::to_string(tiles));
    const SceneSources a = random_sources(random, tiles), b = sources_from_bytes(to_bytes(a));
    EXPECT_EQ(a.root, b.root);
    EXPECT_EQ(a.origin, b.origin);
    EXPECT_EQ(a.notes, b.notes);
    ASSERT_EQ(a.edits == nullptr, b.edits == nullptr);
    EXPECT_EQ(a.edits ? to_json(*a.edits) : "", b.edits ? to_json(*b.edits) : "");
    ASSERT_EQ(a.tiles.size(), b.tiles.size());
    for (std::size_t i = 0; i < tiles; ++i) expect_same(a.tiles[i], b.tiles[i]);
    ASSERT_EQ(a.skipped.size(), b.skipped.size());
    for (std::size_t i = 0; i < a.skipped.size(); ++i) {
      EXPECT_EQ(a.skipped[i].name, b.skipped[i].name);
      EXPECT_EQ(a.skipped[i].reason, b.skipped[i].reason);
      EXPECT_EQ(a.skipped[i].informative, b.skipped[i].informative);
      EXPECT_EQ(a.skipped[i].points, b.skipped[i].points);
    }
    EXPECT_EQ(to_bytes(b), to_bytes(a));
  }
}

TEST(SourceBytes, ShareTheRastersAgain) {
  Random random(seed);
  SceneSources a;
  TileRef tile;
  tile.kind = ContentKind::dem;
  const auto raster = random_raster(random);
  for (int i = 0; i < 3; ++i) {
    tile.dem = random_dem(raster, random);
    a.tiles.push_back(tile);
  }
  const SceneSources b = sources_from_bytes(to_bytes(a));
  EXPECT_EQ(b.tiles[0].dem->raster, b.tiles[2].dem->raster);
}

/// A tile takes few bytes if it has the folder and the placement of the previous tile.
TEST(SourceBytes, TakeLittleRoomForTilesOfOneFolder) {
  SceneSources s;
  TileRef tile;
  for (int i = 0; i < 1000; ++i) {
    tile.name = "tiles/17/123456/tile_" + std::to_string(i) + ".glb";
    tile.path = "/a/long/way/to/the/folder/of/a/tileset/" + tile.name;
    s.tiles.push_back(tile);
  }
  EXPECT_LT(to_bytes(s).size(), 60u * 1000);
}

TEST(SourceBytes, AreRefusedWhereTheyEndEarlyOrGoOn) {
  Random random(seed);
  std::vector<std::uint8_t> bytes = to_bytes(random_sources(random, 20));
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_THROW(sources_from_bytes(std::span(bytes).first(size)), InputError) << size << ", seed " << seed;
  bytes.push_back(0);
  EXPECT_THROW(sources_from_bytes(bytes), InputError);
}

TEST(SourceBytes, ThatAreDamagedAreAnErrorOrOtherSourcesButNeverACrash) {
  Random random(seed);
  const std::vector<std::uint8_t> whole = to_bytes(random_sources(random, 20));
  for (int round = 0; round < 20000; ++round) {
    std::vector<std::uint8_t> bytes = whole;
    for (std::uint64_t i = 1 + random() % 8; i > 0; --i) bytes[random() % bytes.size()] = std::uint8_t(random());
    try {
      for (const TileRef& tile : sources_from_bytes(bytes).tiles) {
        ASSERT_TRUE(tile.scene_from_tile.is_finite()) << "round " << round << ", seed " << seed;
        ASSERT_EQ(tile.kind == ContentKind::dem, tile.dem != nullptr) << "round " << round << ", seed " << seed;
      }
    } catch (const InputError&) {
      continue;
    }
  }
}

TEST(SourceBytes, NameAnUnknownKindAndAPlaceThatIsNotFinite) {
  SceneSources s;
  s.tiles.emplace_back();
  s.tiles[0].kind = ContentKind(8);
  EXPECT_THROW(sources_from_bytes(to_bytes(s)), InputError);
  s.tiles[0].kind = ContentKind::glb;
  EXPECT_NO_THROW(sources_from_bytes(to_bytes(s)));
  s.tiles[0].scene_from_tile.m[1][2] = std::nan("");
  EXPECT_THROW(sources_from_bytes(to_bytes(s)), InputError);
}

}  // namespace
}  // namespace gigabake
