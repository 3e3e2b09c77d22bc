/// One tile of the sample as a mesh.
#pragma once

#include <array>
#include <cstdint>

#include "format/sample/building_kit.h"
#include "format/sample/glb_writer.h"
#include "format/sample/settlement.h"

namespace gigabake::sample {

/// What every tile of one sample shares: a pure function of the map's size and the seed.
struct Landscape {
  Landscape(double size_m, std::uint32_t seed_);
  Landscape(const Landscape&) = delete;
  Landscape& operator=(const Landscape&) = delete;

  std::uint32_t seed;
  Relief relief;
  Settlement settlement;
  KitImages kit;
};

/// Where a tile's coordinates live.
struct TileFrame {
  const Earth* earth = nullptr;  ///< none: the flat map itself
  /// East, north, up in metres. A multiple of 1/1024 m, so that the same point is the same number in every tile.
  std::array<double, 3> place(MapPoint p, double height_m) const;
};

/// A rectangle of the map.
struct TilePlan {
  MapPoint min;
  MapPoint size_m{100, 100};
  GridSize quads{100, 100};
  GridSize texels{512, 512};  ///< of the ground's picture
  bool with_objects = true;
};

struct TerrainTile {
  GlbModel model;                          ///< y up; its node's translation puts it into the frame
  std::array<double, 3> min_m{}, max_m{};  ///< east, north, up: of every vertex
  std::uint64_t triangles = 0;
  std::uint32_t houses = 0, trees = 0;
};

/// The ground's picture, the same in every frame.
GlbImage paint_tile(const Landscape& landscape, const TilePlan& plan);

/// Neighbouring tiles of one size share their border vertices exactly. `ground`: what paint_tile() gave.
TerrainTile make_tile(const Landscape& landscape, const TileFrame& frame, const TilePlan& plan, const GlbImage& ground);

}  // namespace gigabake::sample
