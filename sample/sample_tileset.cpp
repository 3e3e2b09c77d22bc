#include "sample/sample_tileset.h"

#include <algorithm>

#include "sample/sample_folder.h"

namespace gigabake::sample {
namespace {

using Json = nlohmann::ordered_json;

Json volume_of(const TilesetEntry& tile) {
  Json box = Json::array();
  for (std::size_t c = 0; c < 3; ++c) box.push_back((tile.min_m[c] + tile.max_m[c]) / 2);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t c = 0; c < 3; ++c) box.push_back(c == axis ? (tile.max_m[c] - tile.min_m[c]) / 2 : 0.0);
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
  for (const TilesetEntry& child : children)
    for (std::size_t c = 0; c < 3; ++c) {
      coarse.min_m[c] = std::min(coarse.min_m[c], child.min_m[c]);
      coarse.max_m[c] = std::max(coarse.max_m[c], child.max_m[c]);
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
