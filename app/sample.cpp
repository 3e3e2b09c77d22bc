#include "format/sample/sample.h"

#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/commands.h"
#include "app/progress.h"
#include "app/text_values.h"

namespace gigabake::app {
namespace {

struct Options {
  std::string dir, origin;
  sample::SampleOptions sample;
  bool json = false;
};

void run(Options& o) {
  if (!o.origin.empty()) o.sample.origin = geodetic("--origin", o.origin);
  o.sample.threads = int(std::thread::hardware_concurrency());
  const sample::SampleReport r = sample::write_sample(o.dir, o.sample);
  if (o.json) {
    const nlohmann::ordered_json j{{"tileset", o.dir + "/tileset.json"},
                                   {"local", o.dir + "/local"},
                                   {"tiles", r.tiles},
                                   {"triangles", r.triangles},
                                   {"houses", r.houses},
                                   {"trees", r.trees},
                                   {"bytes", r.bytes}};
    fmt::print("{}\n", j.dump(2));
    return;
  }
  fmt::print("{} tiles, {} triangles, {} houses, {} trees, {}\n", r.tiles, r.triangles, r.houses, r.trees,
             readable_bytes(r.bytes));
  fmt::print("bake it:  gigabake bake {}/tileset.json --voxel-size 0.25 -o OUT\n", o.dir);
}

}  // namespace

void add_sample(CLI::App& app, int&) {
  auto* command =
      app.add_subcommand("sample", "Write a procedural georeferenced terrain: glTF tiles with a 3D Tiles tileset");
  auto o = std::make_shared<Options>();
  command->add_option("DIR", o->dir, "folder to write")->required();
  command->add_option("--size", o->sample.size_m, "edge of the square map, metres")->capture_default_str();
  command->add_option("--tiles", o->sample.tiles, "tiles along an edge")->capture_default_str();
  command->add_option("--ground-step", o->sample.ground_step_m, "edge of the ground's quads, about, metres")
      ->capture_default_str();
  command->add_option("--texel", o->sample.texel_m, "texel of the ground's pictures, about, metres")
      ->capture_default_str();
  command->add_option("--seed", o->sample.seed, "another seed, another landscape")->capture_default_str();
  command->add_option("--origin", o->origin, "LAT,LON,HEIGHT of the map's middle (46.9312,8.3017,610)");
  command->add_flag("--json", o->json, "print the answer as JSON");
  command->callback([o] { run(*o); });
}

}  // namespace gigabake::app
