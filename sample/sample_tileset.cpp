#include "sample/sample_tileset.h"

#include "sample/sample_folder.h"

namespace gigabake::sample {
namespace {

using Json = nlohmann::ordered_json;

Json volume_of(const TilesetEntry& tile) {
  Json box = Json::array();
  const Vec3d half_m = (tile.max_m - tile.min_m) / 2;
  for (const double centre_m : (tile.min_m + tile.max_m) / 2) box.push_back(centre_m);
  for (const Vec3d& axis : {Vec3d{half_m[0], 0, 0}, Vec3d{0, half_m[1], 0}, Vec3d{0, 0, half_m[2]}})
    for (const double c : axis) box.push_back(c);
  return Json{{"box", box}};
}

Json leaf_of(const TilesetEntry& tile) {
  return {{"boundingVolume", volume_of(tile)}, {"geometricError", tile.error_m}, {"content", {{"uri", tile.uri}}}};
}

/// Returns the transform in column-major order, as 3D Tiles requires.
Json transform_of(const Earth& earth) {
  const auto& m = earth.ecef_from_enu().m;
  Json transform = Json::array();
  for (std::size_t column = 0; column < 4; ++column)
    for (std::size_t row = 0; row < 4; ++row) transform.push_back(row < 3 ? m[row][column] : (column == 3 ? 1.0 : 0.0));
  return transform;
}

}  // namespace

void enclose(const std::vector<TilesetEntry>& children, TilesetEntry& coarse) {
  for (const TilesetEntry& child : children) {
    coarse.min_m = min_by_axis(coarse.min_m, child.min_m);
    coarse.max_m = max_by_axis(coarse.max_m, child.max_m);
  }
}

Json tileset_of(const TilesetEntry& coarse, const std::vector<TilesetEntry>& children, const Earth* earth) {
  Json root;
  if (earth != nullptr) root["transform"] = transform_of(*earth);
  root.update(leaf_of(coarse));
  root["refine"] = "REPLACE";
  for (const TilesetEntry& child : children) root["children"].push_back(leaf_of(child));
  return {{"asset", {{"version", "1.1"}, {"generator", sample_generator}}},
          {"geometricError", 4 * coarse.error_m},
          {"root", root}};
}

}  // namespace gigabake::sample
