/// One tile of the sample as a mesh.
#pragma once

#include <cstdint>

#include "core/math/vec3.h"
#include "sample/glb_writer.h"
#include "sample/settlement/building_kit.h"
#include "sample/settlement/settlement.h"

namespace gigabake::sample {

/// State shared by all tiles of one sample: a pure function of the map's size and the seed.
struct Landscape {
  Landscape(double size_m, std::uint32_t seed_);
  Landscape(const Landscape&) = delete;
  Landscape& operator=(const Landscape&) = delete;

  std::uint32_t seed;
  Relief relief;
  Settlement settlement;
  KitImages kit;
};

/// The coordinate frame of a tile.
struct TileFrame {
  const Earth* earth = nullptr;  ///< null: the flat map itself
  /// Returns east, north, up in metres, rounded to 1/1024 m, so that a point has the same coordinates in every tile.
  Vec3d place(MapPoint p, double height_m) const;
};

/// A rectangle of the map.
struct TilePlan {
  MapPoint min;
  MapPoint size_m{100, 100};
  GridSize quads{100, 100};
  GridSize texels{512, 512};  ///< texels of the ground's image
  bool with_objects = true;
};

struct TerrainTile {
  GlbModel model;          ///< y up; the translation of its node places it in the tile's TileFrame
  Vec3d min_m{}, max_m{};  ///< east, north, up: bounds of all vertices
  std::uint64_t triangles = 0;
  std::uint32_t houses = 0, trees = 0;
};

/// Paints the ground's image, which is the same in every frame.
GlbImage paint_tile(const Landscape& landscape, const TilePlan& plan);

/// Builds a tile. Neighbouring tiles of the same size share their border vertices exactly. `ground` is the result of
/// paint_tile().
TerrainTile make_tile(const Landscape& landscape, const TileFrame& frame, const TilePlan& plan, const GlbImage& ground);

}  // namespace gigabake::sample
