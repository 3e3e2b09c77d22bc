#include "format/sample/sample.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <nlohmann/json.hpp>

#include "format/sample/sample_folder.h"
#include "format/sample/terrain_tile.h"
#include "format/system/publish.h"
#include "lattice/error.h"
#include "lattice/thread_pool.h"

namespace gigabake::sample {
namespace {

using Json = nlohmann::ordered_json;

constexpr int overview_quads = 64, overview_texels = 1024;  // at most, along the map's edge

void check(const SampleOptions& o) {
  if (!(o.size_m >= 64 && o.size_m <= 1e5)) throw UsageError("size_m", "expected 64 to 100000 metres");
  if (o.tiles < 1 || o.tiles > 256) throw UsageError("tiles", "expected 1 to 256 along an edge");
  const double tile_m = o.size_m / o.tiles;
  if (!(o.ground_step_m > 0) || tile_m / o.ground_step_m > 4096)
    throw UsageError("ground_step_m", "expected at most 4096 steps along a tile");
  if (!(o.texel_m > 0) || tile_m / o.texel_m > 16384)
    throw UsageError("texel_m", "expected at most 16384 texels along a tile");
  if (!(std::fabs(o.origin.latitude_deg) <= 85 && std::fabs(o.origin.longitude_deg) <= 360 &&
        std::fabs(o.origin.height_m) < 9000))
    throw UsageError("origin", "expected a latitude within ±85°, a longitude and a height in metres");
}

Json box_of(const TerrainTile& t) {
  Json box = Json::array();
  for (std::size_t c = 0; c < 3; ++c) box.push_back((t.min_m[c] + t.max_m[c]) / 2);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t c = 0; c < 3; ++c) box.push_back(c == axis ? (t.max_m[c] - t.min_m[c]) / 2 : 0.0);
  return Json{{"box", box}};
}

class Writer {
 public:
  Writer(const std::filesystem::path& dir, const SampleOptions& o)
      : dir_(dir), o_(o), landscape_(o.size_m, o.seed), earth_(o.origin) {}

  SampleReport write_all() {
    const std::size_t count = std::size_t(o_.tiles) * std::size_t(o_.tiles);
    std::vector<Json> children(count);
    std::mutex mutex;
    ThreadPool(o_.threads).parallel_for(count, 1, [&](std::size_t i, std::size_t, int) {
      const TilePlan plan = plan_of(i);
      const GlbImage ground = paint_tile(landscape_, plan);
      const TerrainTile tile = write_tile(plan, TileFrame{&earth_}, ground, "tiles/" + name_of(i));
      write_tile(plan, TileFrame{}, ground, "local/" + name_of(i));
      children[i] = {
          {"boundingVolume", box_of(tile)}, {"geometricError", 0}, {"content", {{"uri", "tiles/" + name_of(i)}}}};
      const std::scoped_lock lock(mutex);
      report_.triangles += tile.triangles;
      report_.houses += tile.houses;
      report_.trees += tile.trees;
      ++report_.tiles;
    });
    write_tileset(children);
    return report_;
  }

 private:
  std::string name_of(std::size_t i) const {
    return "tile_" + std::to_string(i % std::size_t(o_.tiles)) + "_" + std::to_string(i / std::size_t(o_.tiles)) +
           ".glb";
  }

  void count_bytes(std::uint64_t bytes) {
    const std::scoped_lock lock(bytes_mutex_);
    report_.bytes += bytes;
  }

  TilePlan plan_of(std::size_t i) const {
    TilePlan plan;
    plan.edge_m = o_.size_m / o_.tiles;
    plan.min = {-o_.size_m / 2 + double(i % std::size_t(o_.tiles)) * plan.edge_m,
                -o_.size_m / 2 + double(i / std::size_t(o_.tiles)) * plan.edge_m};
    plan.quads = std::max(1, int(plan.edge_m / o_.ground_step_m + 0.5));
    plan.texels = std::max(16, int(plan.edge_m / o_.texel_m + 0.5));
    return plan;
  }

  /// The coarser level: the whole map without what stands on it, with at most a quarter of the tiles' steps.
  TilePlan plan_of_overview() const {
    const TilePlan fine = plan_of(0);
    return {{-o_.size_m / 2, -o_.size_m / 2},
            o_.size_m,
            std::clamp(fine.quads * o_.tiles / 4, 1, overview_quads),
            std::clamp(fine.texels * o_.tiles / 4, 16, overview_texels),
            false};
  }

  TerrainTile write_tile(const TilePlan& plan, const TileFrame& frame, const GlbImage& ground,
                         const std::string& name) {
    TerrainTile tile = make_tile(landscape_, frame, plan, ground);
    tile.model.name = std::filesystem::path(name).stem().string();
    const std::vector<std::uint8_t> glb = to_glb(tile.model);
    publish_file(dir_ / name, {reinterpret_cast<const char*>(glb.data()), glb.size()});
    count_bytes(glb.size());
    return tile;
  }

  void write_tileset(const std::vector<Json>& children) {
    const TilePlan plan = plan_of_overview();
    TerrainTile overview = write_tile(plan, TileFrame{&earth_}, paint_tile(landscape_, plan), "tiles/overview.glb");
    for (std::size_t c = 0; c < 3; ++c)  // the parent's volume holds its children's: roofs and crowns included
      for (const Json& child : children) {
        const Json& box = child["boundingVolume"]["box"];
        const double centre = box[c], half = box[3 + 4 * c];
        overview.min_m[c] = std::min(overview.min_m[c], centre - half);
        overview.max_m[c] = std::max(overview.max_m[c], centre + half);
      }
    report_.min_m = overview.min_m;
    report_.max_m = overview.max_m;
    const auto& m = earth_.ecef_from_enu().m;
    Json transform = Json::array();
    for (std::size_t column = 0; column < 4; ++column)
      for (std::size_t row = 0; row < 4; ++row)
        transform.push_back(row < 3 ? m[row][column] : (column == 3 ? 1.0 : 0.0));
    const double error_m = o_.size_m / plan.quads;
    const Json tileset{{"asset", {{"version", "1.1"}, {"generator", sample_generator}}},
                       {"geometricError", 4 * error_m},
                       {"root",
                        {{"transform", transform},
                         {"boundingVolume", box_of(overview)},
                         {"geometricError", error_m},
                         {"refine", "REPLACE"},
                         {"content", {{"uri", "tiles/overview.glb"}}},
                         {"children", children}}}};
    const std::string text = tileset.dump(1);
    publish_file(dir_ / "tileset.json", text);
    count_bytes(text.size());
  }

  const std::filesystem::path& dir_;
  const SampleOptions& o_;
  Landscape landscape_;
  Earth earth_;
  SampleReport report_;
  std::mutex bytes_mutex_;
};

}  // namespace

SampleReport write_sample(const std::filesystem::path& dir, const SampleOptions& options) {
  check(options);
  SampleFolder folder(dir);
  const SampleReport report = Writer(folder.aside(), options).write_all();
  folder.publish();
  return report;
}

}  // namespace gigabake::sample
