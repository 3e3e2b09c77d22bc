/// One tile of the sample as a mesh.
#pragma once

#include <array>
#include <cstdint>

#include "format/sample/glb_writer.h"
#include "format/sample/settlement.h"

namespace gigabake::sample {

/// Where a tile's coordinates live.
struct TileFrame {
  const Earth* earth = nullptr;  ///< none: the flat map itself
  /// East, north, up in metres. A multiple of 1/1024 m, so that the same point is the same number in every tile.
  std::array<double, 3> place(MapPoint p, double height_m) const;
};

struct TilePlan {
  MapPoint min;
  double edge_m = 100;
  int quads = 100;   ///< along an edge
  int texels = 512;  ///< of the ground's picture
  bool with_objects = true;
};

struct TerrainTile {
  GlbModel model;                          ///< y up; its node's translation puts it into the frame
  std::array<double, 3> min_m{}, max_m{};  ///< east, north, up: of every vertex
  std::uint64_t triangles = 0;
  std::uint32_t houses = 0, trees = 0;
};

/// Neighbouring tiles of one size share their border vertices exactly.
TerrainTile make_tile(const Relief& relief, const Settlement& settlement, std::uint32_t seed, const TileFrame& frame,
                      const TilePlan& plan);

}  // namespace gigabake::sample
