/// The tilesets of a sample, as JSON (3D Tiles 1.1).
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/math/vec3.h"
#include "sample/terrain/earth.h"

namespace gigabake::sample {

/// One tile of a tileset: a mesh, or another tileset.
struct TilesetEntry {
  std::string uri;
  Vec3d min_m{}, max_m{};  ///< east, north, up in the tangent plane of the map's origin
  double error_m = 0;      ///< approximate geometric error of the content; 0: the finest level
};

/// Extends the box of `coarse` to contain the boxes of `children`, the finer tiles that replace `coarse`. The mesh of
/// `coarse` has no roofs and crowns, so its own box is too small.
void enclose(const std::vector<TilesetEntry>& children, TilesetEntry& coarse);

/// Returns a tileset whose root is `coarse`. If `earth` is not null, the root has the transform from the tangent plane
/// to the earth. Otherwise, the parent tileset has it.
nlohmann::ordered_json tileset_of(const TilesetEntry& coarse, const std::vector<TilesetEntry>& children,
                                  const Earth* earth);

}  // namespace gigabake::sample
