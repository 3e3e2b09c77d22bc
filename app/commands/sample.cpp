#include "sample/sample.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/commands.h"
#include "app/messages/json_text.h"
#include "app/messages/status_text.h"
#include "app/options/text_values.h"
#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "format/system/host_limits.h"

namespace gigabake::app {
namespace {

struct Options {
  std::string dir, origin;
  std::optional<double> tile_size_m;
  sample::SampleOptions sample;
  bool json = false;
};

std::string bake_command(const Options& o, const char* source, const char* more) {
  return fmt::format("gigabake bake {}/{} --voxel-size {}{} -o SCENE", o.dir, source, o.sample.texel_m, more);
}

constexpr char render_command[] = "gigabake render SCENE/scene.xml -o IMAGE.png";

void print_json(const Options& o, const sample::SampleReport& r) {
  const Geodetic& at = o.sample.origin;
  const nlohmann::ordered_json j{{"tileset", o.dir + "/tileset.json"},
                                 {"local", o.dir + "/local"},
                                 {"tiles", r.tiles},
                                 {"triangles", r.triangles},
                                 {"houses", r.houses},
                                 {"trees", r.trees},
                                 {"bytes", r.bytes},
                                 {"origin_lat_lon_height", {at.latitude_deg, at.longitude_deg, at.height_m}},
                                 {"min_m", r.min_m},
                                 {"max_m", r.max_m},
                                 {"voxel_size_m", o.sample.texel_m},
                                 {"bake", bake_command(o, "tileset.json", "")},
                                 {"bake_local", bake_command(o, "local", " --local")},
                                 {"render", render_command}};
  fmt::print("{}\n", json_text(j));
}

void print_text(const Options& o, const sample::SampleReport& r) {
  fmt::print("{}, {}, {}, {}, {}; {:g} × {:g} m, {:.0f} m from lowest to highest\n", pluralize(r.tiles, "tile"),
             pluralize(r.triangles, "triangle"), pluralize(r.houses, "house"), pluralize(r.trees, "tree"),
             readable_bytes(r.bytes), o.sample.size_m, o.sample.size_m, r.max_m[2] - r.min_m[2]);
  fmt::print("bake it:        {}\n", bake_command(o, "tileset.json", ""));
  fmt::print("its flat twin:  {}\n", bake_command(o, "local", " --local"));
  fmt::print("see it:         {}\n", render_command);
}

int tiles_along(double size_m, double tile_size_m) {
  const double tiles = std::max(1.0, std::round(size_m / tile_size_m));
  if (!(tile_size_m > 0 && tiles <= sample::max_sample_tiles))
    throw UsageError("--tile-size", fmt::format("expected at least a {}th of --size", sample::max_sample_tiles));
  return int(tiles);
}

void run(Options& o) {
  if (!o.origin.empty()) o.sample.origin = geodetic("--origin", o.origin);
  if (o.tile_size_m) o.sample.tiles = tiles_along(o.sample.size_m, *o.tile_size_m);
  o.sample.threads = host_limits().cores();
  const sample::SampleReport report = sample::write_sample(o.dir, o.sample);
  o.json ? print_json(o, report) : print_text(o, report);
}

}  // namespace

void add_sample(CLI::App& app, int&) {
  auto* command =
      app.add_subcommand("sample", "Write a procedural georeferenced terrain: glTF tiles with a 3D Tiles tileset");
  auto o = std::make_shared<Options>();
  command->add_option("DIR", o->dir, "folder to write")->required();
  command->add_option("--size", o->sample.size_m, "edge of the square map, metres")->capture_default_str();
  auto* tiles = command->add_option("--tiles", o->sample.tiles, "tiles along an edge")->capture_default_str();
  command->add_option("--tile-size", o->tile_size_m, "edge of a tile, about, metres, instead of --tiles")
      ->excludes(tiles);
  command->add_option("--ground-step", o->sample.ground_step_m, "edge of the ground's quads, about, metres")
      ->capture_default_str();
  command->add_option("--texel", o->sample.texel_m, "texel of the ground's images, about, metres")
      ->capture_default_str();
  command->add_option("--seed", o->sample.seed, "seed of the terrain")->capture_default_str();
  command->add_option("--origin,--origin-lat-lon", o->origin,
                      "LAT,LON,HEIGHT of the map's middle (46.9312,8.3017,610)");
  command->add_flag("--json", o->json, "print the answer as JSON");
  command->callback([o] { run(*o); });
}

}  // namespace gigabake::app
