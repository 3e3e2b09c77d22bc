#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>

#include "app/commands.h"
#include "app/messages/status_text.h"
#include "app/messages/with_progress.h"
#include "app/options/flags.h"
#include "app/options/scene_argument.h"
#include "format/scene/scene_totals.h"
#include "lattice/counted.h"

namespace gigabake::app {
namespace {

using Json = nlohmann::ordered_json;

struct Extent {
  std::array<double, 3> min_m, max_m;
};

/// Of the cells, scene metres.
Extent extent_of(const SceneDescription& scene) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  Extent e{{inf, inf, inf}, {-inf, -inf, -inf}};
  for (const SceneCell& c : scene.cells)
    for (std::size_t k = 0; k < 3; ++k) {
      const double low = scene.lattice_origin_m[k] + double(c.lattice_min[k]) * scene.voxel_size_m;
      e.min_m[k] = std::min(e.min_m[k], low);
      e.max_m[k] = std::max(e.max_m[k], low + c.cell_voxels * scene.voxel_size_m);
    }
  return e;
}

Json to_json(const Geodetic& origin) {
  return {
      {"latitude_deg", origin.latitude_deg}, {"longitude_deg", origin.longitude_deg}, {"height_m", origin.height_m}};
}

Json levels_to_json(const SceneTotals& totals, const StoredBytes& stored) {
  Json levels = Json::array();
  for (std::size_t lod = 0; lod < totals.voxels.size(); ++lod)
    levels.push_back({{"lod", lod},
                      {"voxels", totals.voxels[lod]},
                      {"bytes", stored.of_lod.at(lod)},
                      {"content_hash", totals.content_hash[lod].hex()}});
  return levels;
}

Json to_json(const SceneDescription& scene, const StoredBytes& stored) {
  const SceneTotals totals(scene);
  Json j;
  j["generator"] = scene.generator;
  j["voxel_size_m"] = scene.voxel_size_m;
  j["lattice_origin_m"] = scene.lattice_origin_m;
  j["origin"] = scene.origin ? to_json(*scene.origin) : Json();
  j["normals"] = scene.has_normals;
  j["facing"] = scene.has_facing;
  j["parameters"] = Json::parse(scene.parameters, nullptr, false);
  j["content_hash"] = totals.all_content.hex();
  j["lods"] = levels_to_json(totals, stored);
  j["cells"] = scene.cells.size();
  j["triangles"] = scene.triangles;
  j["skipped"] = {{"points", scene.skipped_points},
                  {"lines", scene.skipped_lines},
                  {"non_finite", scene.non_finite},
                  {"zero_area", scene.zero_area}};
  j["voxels"] = std::accumulate(totals.voxels.begin(), totals.voxels.end(), std::uint64_t(0));
  j["bytes"] = totals.bytes;
  j["node_bytes"] = stored.of_nodes;
  if (!scene.cells.empty()) {
    const Extent e = extent_of(scene);
    j["cells_min_m"] = e.min_m;
    j["cells_max_m"] = e.max_m;
  }
  j["losses"] = Json::array();
  for (const SceneLoss& l : scene.losses) j["losses"].push_back({{"name", l.name}, {"reason", l.reason}});
  return j;
}

void print_place(const SceneDescription& scene) {
  if (scene.origin)
    fmt::print("scene origin {:.9f}° {:.9f}° {:.3f} m\n", scene.origin->latitude_deg, scene.origin->longitude_deg,
               scene.origin->height_m);
  if (scene.cells.empty()) return;
  const Extent e = extent_of(scene);
  fmt::print("cells span {} {} {} to {} {} {} m\n", e.min_m[0], e.min_m[1], e.min_m[2], e.max_m[0], e.max_m[1],
             e.max_m[2]);
}

void print_text(const SceneDescription& scene, const StoredBytes& stored) {
  const SceneTotals totals(scene);
  fmt::print("{} of {} m voxels, {}, {}\n", counted(scene.cells.size(), "cell"), scene.voxel_size_m,
             counted(scene.triangles, "triangle"), readable_bytes(totals.bytes));
  print_place(scene);
  for (std::size_t lod = 0; lod < totals.voxels.size(); ++lod)
    fmt::print("  lod {:<2} {:>14} voxels {:>10}  {}\n", lod, totals.voxels[lod], readable_bytes(stored.of_lod.at(lod)),
               totals.content_hash[lod].hex());
  fmt::print("content hash {}\n", totals.all_content.hex());
  const std::uint64_t dropped = scene.non_finite + scene.zero_area;
  if (dropped + scene.skipped_points + scene.skipped_lines != 0)
    fmt::print("skipped {}, {}, {} not finite, {} without area\n", counted(scene.skipped_points, "point"),
               counted(scene.skipped_lines, "line"),
               counted(scene.non_finite, "triangle that is", "triangles that are"), scene.zero_area);
  for (const SceneLoss& l : scene.losses) fmt::print("missing {}: {}\n", l.name, with_flags(l.reason));
}

}  // namespace

void add_info(CLI::App& app, int&) {
  auto* command = app.add_subcommand("info", "Levels, voxels, bytes, extents and content hash of a baked scene");
  auto scene = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false);
  command->add_option("SCENE", *scene, "OUT of a bake, or OUT/scene.xml")->required();
  command->add_flag("--json", *json, "print the answer as JSON");
  command->callback([scene, json] {
    const std::filesystem::path file = scene_argument(*scene);
    const SceneDescription description = while_reading([&](const Progress& progress) {
      progress.step("reading the scene");
      return read_scene(file);
    });
    const StoredBytes stored =
        while_reading([&](const Progress& progress) { return stored_bytes(file, description, progress); });
    *json ? fmt::print("{}\n", to_json(description, stored).dump(2, ' ', false, Json::error_handler_t::replace))
          : print_text(description, stored);
  });
}

}  // namespace gigabake::app
