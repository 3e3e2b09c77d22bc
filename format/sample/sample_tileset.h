/// The tilesets of a sample, as JSON (3D Tiles 1.1).
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "format/sample/earth.h"

namespace gigabake::sample {

/// One tile of a tileset: a mesh, or another tileset.
struct TilesetEntry {
  std::string uri;
  std::array<double, 3> min_m{}, max_m{};  ///< east, north, up in the tangent plane of the map's origin
  double error_m = 0;                      ///< how far its content is off, about; 0: the finest there is
};

/// `children` replace `coarse`, whose box is made to hold theirs: roofs and crowns included, which the coarser mesh
/// lacks.
void enclose(const std::vector<TilesetEntry>& children, TilesetEntry& coarse);

/// A tileset whose root is `coarse`. earth: its root then takes the tangent plane to the earth; null: the tileset that
/// names it does.
nlohmann::ordered_json tileset_of(const TilesetEntry& coarse, const std::vector<TilesetEntry>& children,
                                  const Earth* earth);

}  // namespace gigabake::sample
