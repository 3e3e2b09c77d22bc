#include "format/export/voxel_tiles/tileset_json.h"

#include <nlohmann/json.hpp>
#include <vector>

#include "core/math/georeference.h"
#include "format/export/voxel_tiles/tile_writer.h"
#include "format/export/voxel_tiles/voxel_tile.h"

namespace gigabake {
namespace {

using Json = nlohmann::ordered_json;

template <std::size_t n>
Json scaled(const std::array<std::uint8_t, n>& bytes, double zero, double step) {
  Json values = Json::array();
  for (const std::uint8_t b : bytes) values.push_back((b - zero) / step);
  return values;
}

/// Returns the statistics in the units of the schema: bytes are converted as its `normalized`, `offset` and `scale`
/// define.
Json statistics_of(const VoxelStatistics& voxels) {
  if (voxels.voxels == 0) return Json::object();
  Json minimum = scaled(voxels.min_normal, 128, 127), greatest = scaled(voxels.max_normal, 128, 127);
  minimum.push_back(1.0);
  greatest.push_back(1.0);
  Json properties = {{"color", {{"min", scaled(voxels.min_rgba, 0, 255)}, {"max", scaled(voxels.max_rgba, 0, 255)}}},
                     {"normal", {{"min", minimum}, {"max", greatest}}}};
  if (voxels.min_class <= voxels.max_class)
    properties["voxel_class"] = {{"min", voxels.min_class}, {"max", voxels.max_class}};
  return {{"classes", {{"voxel", {{"count", voxels.voxels}, {"properties", properties}}}}}};
}

Json metres(const SceneHeader& scene, const Vec3i64& voxel) {
  const Vec3d point = scene.lattice_origin_m + Vec3d(voxel) * scene.voxel_size_m;
  return {point[0], point[1], point[2]};
}

Json schema(bool has_classes) {
  Json schema = voxel_schema(has_classes);
  const Json corner = {{"type", "VEC3"}, {"componentType", "FLOAT64"}};
  schema["classes"]["tileset"]["properties"] = {
      {"tileCount", {{"type", "SCALAR"}, {"componentType", "UINT32"}, {"semantic", "TILESET_TILE_COUNT"}}},
      {"lowest", corner},
      {"highest", corner}};
  return schema;
}

/// Returns the properties `dimensions`, `padding` and `class`, which are equal in both forms of tilesets.
Json grid_of_tiles(const VoxelTiling& tiling) {
  const Json edge = {tiling.edge, tiling.edge, tiling.edge};
  return {{"dimensions", edge}, {"padding", {{"before", {1, 1, 1}}, {"after", {1, 1, 1}}}}, {"class", "voxel"}};
}

Json root_tile(const SceneHeader& scene, const VoxelTiling& tiling) {
  const TileBox box = box_of(tiling, scene, {0, 0});
  const double half = box.edge_m / 2;
  const Vec3d& centre = box.centre_m;
  Json root = {
      {"boundingVolume", {{"box", {centre[0], centre[1], centre[2], half, 0, 0, 0, half, 0, 0, 0, half}}}},
      {"geometricError", box.edge_m / tiling.edge},
      {"refine", "REPLACE"},
      {"content",
       {{"uri", "tiles/{level}/{x}/{y}/{z}.glb"}, {"extensions", {{"3DTILES_content_voxels", grid_of_tiles(tiling)}}}}},
      {"implicitTiling",
       {{"subdivisionScheme", "OCTREE"},
        {"subtreeLevels", subtree_levels(tiling.levels)},
        {"availableLevels", tiling.levels},
        {"subtrees", {{"uri", "subtrees/{level}/{x}/{y}/{z}.subtree"}}}}}};
  if (scene.origin) {
    const Affine<Ecef, Scene> ecef = ecef_from_enu(*scene.origin);
    Json columns = Json::array();
    for (std::size_t column = 0; column < 4; ++column) {
      for (std::size_t row = 0; row < 3; ++row) columns.push_back(ecef.m[row][column]);
      columns.push_back(column == 3 ? 1.0 : 0.0);
    }
    root["transform"] = columns;
  }
  return root;
}

Json summary_of(const SceneHeader& scene, const TilesetSummary& summary) {
  return {{"tileCount", summary.tiles},
          {"lowest", metres(scene, summary.bounds.min)},
          {"highest", metres(scene, summary.bounds.end)}};
}

Json root_node(const VoxelTiling& tiling, const TileBox& box) {
  return {{"translation", in_gltf_2_1(box.centre_m)},
          {"boundingVolume", {{"shape", 0}}},
          {"extensions",
           {{"3DTILES_tileset", {{"geometricError", box.edge_m / tiling.edge}, {"refine", "REPLACE"}}},
            {"3DTILES_implicit_tiling",
             {{"contentUri", "tiles/{level}/{right}/{forward}/{up}.glb"},
              {"subtreeUri", "subtrees/{level}/{right}/{forward}/{up}.subtree.glb"},
              {"subdivisionScheme", "OCTREE"},
              {"availableLevels", tiling.levels},
              {"subtreeLevels", subtree_levels(tiling.levels)}}}}}};
}

}  // namespace

std::string tileset_gltf(const SceneHeader& scene, const VoxelTiling& tiling, const TilesetSummary& summary) {
  const TileBox box = box_of(tiling, scene, {0, 0});
  const std::vector<std::string> extensions{"3DTILES_tileset", "3DTILES_implicit_tiling", "3DTILES_tileset_voxels",
                                            "EXT_structural_metadata"};
  Json extras = summary_of(scene, summary);
  extras["statistics"] = statistics_of(summary.voxels);
  if (scene.origin)
    extras["origin"] = {scene.origin->latitude_deg, scene.origin->longitude_deg, scene.origin->height_m};
  Json voxels = grid_of_tiles(tiling);
  voxels["shape"] = 0;
  const Json shape = {{"type", "box"}, {"box", {{"size", {box.edge_m, box.edge_m, box.edge_m}}}}};
  const Json document = {{"asset", {{"version", "2.1"}, {"generator", scene.generator}, {"extras", extras}}},
                         {"extensionsUsed", extensions},
                         {"extensionsRequired", extensions},
                         {"shapes", Json::array({shape})},
                         {"extensions",
                          {{"EXT_structural_metadata", {{"schema", voxel_schema(scene.has_classes)}}},
                           {"3DTILES_tileset", {{"geometricError", 2 * box.edge_m / tiling.edge}}},
                           {"3DTILES_tileset_voxels", voxels}}},
                         {"scene", 0},
                         {"scenes", Json::array({{{"nodes", {0}}}})},
                         {"nodes", Json::array({root_node(tiling, box)})}};
  return document.dump(2) + "\n";
}

std::string tileset_json(const SceneHeader& scene, const VoxelTiling& tiling, const TilesetSummary& summary) {
  const Json root = root_tile(scene, tiling);
  const double error_m = 2 * root["geometricError"].get<double>();
  const Json document = {{"asset", {{"version", "1.1"}, {"generator", scene.generator}}},
                         {"extensionsUsed", {"3DTILES_content_voxels"}},
                         {"extensionsRequired", {"3DTILES_content_voxels"}},
                         {"schema", schema(scene.has_classes)},
                         {"statistics", statistics_of(summary.voxels)},
                         {"metadata", {{"class", "tileset"}, {"properties", summary_of(scene, summary)}}},
                         {"geometricError", error_m},
                         {"root", root}};
  return document.dump(2) + "\n";
}

}  // namespace gigabake
