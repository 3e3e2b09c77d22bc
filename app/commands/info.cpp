#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>

#include "app/commands.h"
#include "app/messages/json_text.h"
#include "app/messages/missing_json.h"
#include "app/messages/status_text.h"
#include "app/messages/with_progress.h"
#include "app/options/flags.h"
#include "app/options/scene_argument.h"
#include "core/base/pluralize.h"
#include "format/scene/scene_level.h"
#include "format/scene/stored_bytes.h"

namespace gigabake::app {
namespace {

using Json = nlohmann::ordered_json;

struct Extent {
  std::array<double, 3> min_m, max_m;
};

/// The scene-wide values of scene.xml that `info` prints.
struct Info {
  SceneHeader scene;
  SceneTotals totals;
  StoredBytes stored;
  /// Voxels that describe lod 0: stored voxels, and voxels of expanded leaves. 0 without leaves.
  std::uint64_t described = 0;
};

/// Reads the scene. If scene.xml does not store the byte sizes of the shards' columns (before version 3), or if voxels
/// of coarser levels describe lod 0, reads shards.
Info read_info(const std::filesystem::path& scene_xml, const Progress& progress) {
  progress.step("reading the scene");
  const PagedScene scene(scene_xml);
  const SceneTotals& totals = scene.totals();
  return {scene.header(), totals,
          totals.has_stored() ? StoredBytes{totals.level_bytes, totals.node_bytes} : stored_bytes(scene, progress),
          scene.header().leaf_lod == 0 ? 0 : described_voxels(scene, 0)};
}

/// Returns the bounds of the cells in scene metres.
Extent extent_of(const Info& info) {
  Extent e{};
  const auto place_m = [&](std::int64_t voxel, std::size_t k) {
    return info.scene.lattice_origin_m[k] + double(voxel) * info.scene.voxel_size_m;
  };
  for (std::size_t k = 0; k < 3; ++k) {
    e.min_m[k] = place_m(info.totals.window.min[k], k);
    e.max_m[k] = place_m(info.totals.window.end[k], k);
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

Json to_json(const Info& info) {
  const auto& [scene, totals, stored, described] = info;
  Json j;
  j["generator"] = scene.generator;
  j["voxel_size_m"] = scene.voxel_size_m;
  j["lattice_origin_m"] = scene.lattice_origin_m;
  j["origin"] = scene.origin ? to_json(*scene.origin) : Json();
  j["normals"] = scene.has_normals;
  j["facing"] = scene.has_directional_coverage;
  if (scene.has_classes) j["classes"] = true;
  j["parameters"] = Json::parse(scene.parameters, nullptr, false);
  j["content_hash"] = totals.all_content().hex();
  j["lods"] = levels_to_json(totals, stored);
  j["cells"] = totals.cells;
  j["triangles"] = scene.triangles;
  j["skipped"] = {{"points", scene.skipped_points},
                  {"lines", scene.skipped_lines},
                  {"non_finite", scene.non_finite},
                  {"zero_area", scene.zero_area}};
  j["voxels"] = std::accumulate(totals.voxels.begin(), totals.voxels.end(), std::uint64_t(0));
  if (scene.leaf_lod != 0) {
    j["leaf_lod"] = scene.leaf_lod;
    j["described_voxels"] = described;
  }
  j["bytes"] = totals.bytes;
  j["node_bytes"] = stored.of_nodes;
  if (totals.cells != 0) {
    const Extent e = extent_of(info);
    j["cells_min_m"] = e.min_m;
    j["cells_max_m"] = e.max_m;
  }
  j["missing"] = json_of_missing(missing_data(scene, totals.cells));
  j["losses"] = Json::array();
  for (const SceneLoss& l : scene.losses) j["losses"].push_back({{"name", l.name}, {"reason", l.reason}});
  return j;
}

void print_place(const Info& info) {
  const SceneHeader& scene = info.scene;
  if (scene.origin)
    fmt::print("scene origin latitude {:.9f}°, longitude {:.9f}°, height {:.3f} m\n", scene.origin->latitude_deg,
               scene.origin->longitude_deg, scene.origin->height_m);
  if (info.totals.cells == 0) return;
  const Extent e = extent_of(info);
  fmt::print("cells span {} {} {} to {} {} {} m\n", e.min_m[0], e.min_m[1], e.min_m[2], e.max_m[0], e.max_m[1],
             e.max_m[2]);
}

void print_text(const Info& info) {
  const auto& [scene, totals, stored, described] = info;
  fmt::print("{} of {} m voxels, {}, {}\n", pluralize(totals.cells, "cell"), scene.voxel_size_m,
             pluralize(scene.triangles, "triangle"), readable_bytes(totals.bytes));
  print_place(info);
  for (std::size_t lod = 0; lod < totals.voxels.size(); ++lod)
    fmt::print("  lod {:<2} {:>14} voxels {:>10}  {}\n", lod, totals.voxels[lod], readable_bytes(stored.of_lod.at(lod)),
               totals.content_hash[lod].hex());
  if (scene.leaf_lod != 0)
    fmt::print("{} describe lod 0; levels up to {} store a part of them as coarser voxels\n",
               pluralize(described, "voxel"), scene.leaf_lod);
  if (scene.has_classes) fmt::print("voxels have classes\n");
  fmt::print("content hash {}\n", totals.all_content().hex());
  const std::uint64_t dropped = scene.non_finite + scene.zero_area;
  if (dropped + scene.skipped_points + scene.skipped_lines != 0)
    fmt::print("skipped {}, {}, {} not finite, {} without area\n", pluralize(scene.skipped_points, "point"),
               pluralize(scene.skipped_lines, "line"),
               pluralize(scene.non_finite, "triangle that is", "triangles that are"), scene.zero_area);
  for (const SceneLoss& l : scene.losses) fmt::print("missing {}: {}\n", l.name, with_flags(l.reason));
}

}  // namespace

void add_info(CLI::App& app, int&) {
  auto* command = app.add_subcommand("info", "Print levels, voxels, bytes, extents and content hash of a baked scene");
  auto scene = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false);
  command->add_option("SCENE", *scene, "folder of a bake, or its scene.xml")->required();
  command->add_flag("--json", *json, "print the answer as JSON");
  command->callback([scene, json] {
    const std::filesystem::path file = scene_argument(*scene);
    const Info info = while_reading([&](const Progress& progress) { return read_info(file, progress); });
    *json ? fmt::print("{}\n", json_text(to_json(info))) : print_text(info);
  });
}

}  // namespace gigabake::app
