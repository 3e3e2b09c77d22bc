#include "sample/sample.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/thread_pool.h"
#include "format/system/publish.h"
#include "sample/sample_folder.h"
#include "sample/sample_tileset.h"
#include "sample/terrain/terrain_tile.h"

namespace gigabake::sample {
namespace {

constexpr int coarse_quads = 64, coarse_texels = 1024;  // max numbers along an edge of a coarse tile
/// The number of tiles along an edge of a block. Viewers have difficulties with more than block_tiles² children per
/// tile.
constexpr int block_tiles = 16;

std::string place_name(const char* what, std::size_t x, std::size_t y) {
  return what + ("_" + std::to_string(x)) + "_" + std::to_string(y);
}

void check(const SampleOptions& o) {
  if (!(o.size_m >= 64 && o.size_m <= 1e5)) throw UsageError("size_m", "expected 64 to 100000 metres");
  if (o.tiles < 1 || o.tiles > max_sample_tiles)
    throw UsageError("tiles", "expected 1 to " + std::to_string(max_sample_tiles) + " per edge");
  const double tile_m = o.size_m / o.tiles;
  if (!(o.ground_step_m > 0) || tile_m / o.ground_step_m > 4096)
    throw UsageError("ground_step_m", "expected at most 4096 steps per tile edge");
  if (!(o.texel_m > 0) || tile_m / o.texel_m > 16384)
    throw UsageError("texel_m", "expected at most 16384 texels per tile edge");
  if (!(std::fabs(o.origin.latitude_deg) <= 85 && std::fabs(o.origin.longitude_deg) <= 360 &&
        std::fabs(o.origin.height_m) < 9000))
    throw UsageError("origin", "expected a latitude within ±85°, a longitude and a height in metres");
}

class Writer {
 public:
  Writer(const std::filesystem::path& dir, const SampleOptions& o)
      : dir_(dir),
        o_(o),
        pool_(o.threads),
        landscape_(o.size_m, o.seed),
        earth_(o.origin),
        tiles_(std::size_t(o.tiles)) {}

  SampleReport write_all() {
    write_kit();
    std::vector<TilesetEntry> tiles(tiles_ * tiles_);
    pool_.parallel_for(tiles.size(), 1, [&](std::size_t i, std::size_t, int) { tiles[i] = write_fine(i); });
    write_whole(o_.tiles <= block_tiles ? std::move(tiles) : write_blocks(tiles));
    return report_;
  }

 private:
  /// Writes a file without flushing to disk, because a sample can be generated again after a power loss.
  void write(const std::string& name, std::span<const std::uint8_t> bytes) {
    publish_file(dir_ / name, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, Durability::while_up);
    const std::scoped_lock lock(mutex_);
    report_.bytes += bytes.size();
  }

  /// Writes the images of houses and trees for the tiles of both frames.
  void write_kit() {
    const KitImages& kit = landscape_.kit;
    for (const std::string folder : {"tiles/", "local/"})
      for (const GlbImage* image : {&kit.facade, &kit.roof, &kit.foliage}) write(folder + image->uri, image->bytes);
  }

  TerrainTile write_mesh(const TilePlan& plan, const TileFrame& frame, const GlbImage& ground,
                         const std::string& name) {
    TerrainTile tile = make_tile(landscape_, frame, plan, ground);
    tile.model.name = std::filesystem::path(name).stem().string();
    write(name, to_glb(tile.model));
    return tile;
  }

  TilesetEntry write_fine(std::size_t i) {
    const std::string name = place_name("tile", i % tiles_, i / tiles_) + ".glb";
    const TilePlan plan = plan_of(i);
    const GlbImage ground = paint_tile(landscape_, plan);
    const TerrainTile tile = write_mesh(plan, TileFrame{&earth_}, ground, "tiles/" + name);
    write_mesh(plan, TileFrame{}, ground, "local/" + name);
    const std::scoped_lock lock(mutex_);
    report_.triangles += tile.triangles;
    report_.houses += tile.houses;
    report_.trees += tile.trees;
    ++report_.tiles;
    return {"tiles/" + name, tile.min_m, tile.max_m, 0};
  }

  TilePlan plan_of(std::size_t i) const { return plan_of(i % tiles_, i / tiles_, {1, 1}); }

  /// Returns the plan, at the finest resolution, of one rectangle. It covers `tiles` tiles, the first of which is (x,
  /// y).
  TilePlan plan_of(std::size_t x, std::size_t y, GridSize tiles) const {
    const double edge_m = o_.size_m / o_.tiles;
    const int quads = std::max(1, int(edge_m / o_.ground_step_m + 0.5));
    const int texels = std::max(16, int(edge_m / o_.texel_m + 0.5));
    return {{-o_.size_m / 2 + double(x) * edge_m, -o_.size_m / 2 + double(y) * edge_m},
            {edge_m * tiles.e, edge_m * tiles.n},
            {quads * tiles.e, quads * tiles.n},
            {texels * tiles.e, texels * tiles.n}};
  }

  /// Writes a coarse tile. It has about a quarter of the plan's resolution, at most the maximum, and no houses or
  /// trees.
  TilesetEntry write_coarse(TilePlan plan, const std::string& name) {
    const auto coarser = [](GridSize fine, int minimum, int maximum) {
      return GridSize{std::clamp(fine.e / 4, minimum, maximum), std::clamp(fine.n / 4, minimum, maximum)};
    };
    plan.quads = coarser(plan.quads, 1, coarse_quads);
    plan.texels = coarser(plan.texels, 16, coarse_texels);
    plan.with_objects = false;
    const TerrainTile mesh = write_mesh(plan, TileFrame{&earth_}, paint_tile(landscape_, plan), name);
    return {name, mesh.min_m, mesh.max_m, std::max(plan.size_m.e_m / plan.quads.e, plan.size_m.n_m / plan.quads.n)};
  }

  std::vector<TilesetEntry> write_blocks(const std::vector<TilesetEntry>& tiles) {
    const std::size_t along = (tiles_ + block_tiles - 1) / block_tiles;
    std::vector<TilesetEntry> blocks(along * along);
    pool_.parallel_for(blocks.size(), 1,
                       [&](std::size_t i, std::size_t, int) { blocks[i] = write_block(tiles, i % along, i / along); });
    return blocks;
  }

  /// Writes a block's tileset. At the map's border, a block has fewer tiles.
  TilesetEntry write_block(const std::vector<TilesetEntry>& tiles, std::size_t block_x, std::size_t block_y) {
    const std::string name = "tiles/" + place_name("block", block_x, block_y);
    const std::size_t x0 = block_x * block_tiles, y0 = block_y * block_tiles;
    const std::size_t x1 = std::min(tiles_, x0 + block_tiles), y1 = std::min(tiles_, y0 + block_tiles);
    std::vector<TilesetEntry> children;
    for (std::size_t y = y0; y < y1; ++y)
      for (std::size_t x = x0; x < x1; ++x) children.push_back(beside(tiles[y * tiles_ + x]));
    TilesetEntry block = write_coarse(plan_of(x0, y0, {int(x1 - x0), int(y1 - y0)}), name + ".glb");
    enclose(children, block);
    write_json(name + ".json", tileset_of(beside(block), children, nullptr));
    block.uri = name + ".json";
    return block;
  }

  /// Returns the tile with a URI relative to the folder tiles/, for tilesets in that folder.
  static TilesetEntry beside(TilesetEntry tile) {
    tile.uri = std::filesystem::path(tile.uri).filename().string();
    return tile;
  }

  void write_whole(std::vector<TilesetEntry> children) {
    TilesetEntry overview = write_coarse(plan_of(0, 0, {o_.tiles, o_.tiles}), "tiles/overview.glb");
    enclose(children, overview);
    report_.min_m = overview.min_m;
    report_.max_m = overview.max_m;
    write_json("tileset.json", tileset_of(overview, children, &earth_));
  }

  void write_json(const std::string& name, const nlohmann::ordered_json& json) {
    const std::string text = json.dump(1);
    write(name, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }

  const std::filesystem::path& dir_;
  const SampleOptions& o_;
  const ThreadPool pool_;
  const Landscape landscape_;
  const Earth earth_;
  const std::size_t tiles_;  ///< along an edge
  SampleReport report_;
  std::mutex mutex_;  ///< guards report_
};

}  // namespace

SampleReport write_sample(const std::filesystem::path& dir, const SampleOptions& options) {
  check(options);
  SampleFolder folder(dir);
  const SampleReport report = Writer(folder.temporary(), options).write_all();
  folder.publish();
  return report;
}

}  // namespace gigabake::sample
