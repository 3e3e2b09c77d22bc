/// Pictures and meshes of what stands on the ground.
#pragma once

#include "format/sample/glb_writer.h"
#include "format/sample/picture.h"
#include "format/sample/settlement.h"

namespace gigabake::sample {

/// Twelve by twelve metres of wall: two rows of windows below, plaster with one window in the middle above.
Picture paint_facade(std::uint32_t seed);
/// Fourteen by nine metres of roof tiles, rows along x.
Picture paint_roof(std::uint32_t seed);
/// Left half leaves, right half needles, with alpha: 255 where there is foliage, 0 between.
Picture paint_foliage(std::uint32_t seed);

/// The three, encoded, as files beside the tiles: whatever tile builds or plants refers to the same ones.
struct KitImages {
  GlbImage facade, roof, foliage;
};
KitImages paint_kit(std::uint32_t seed);

/// What the pictures show, which walls and roofs repeat.
inline constexpr double facade_m = 12, roof_width_m = 14, roof_height_m = 9;

constexpr int jpeg_quality = 88;

/// A corner of a mesh in the tile's frame: metres east, north, up.
struct Corner {
  double e_m, n_m, u_m;
};

/// Turns east-north-up into glTF's axes and appends one quad, counter-clockwise from outside; uv of the four corners.
void add_quad(GlbMesh& mesh, const Corner corners[4], const double uv[4][2]);
void add_triangle(GlbMesh& mesh, const Corner corners[3], const double uv[3][2]);

/// The house's walls and gables, and its roof; base_m is the height where its walls begin, below ground.
void add_house(const House& house, MapPoint local_centre, double base_m, double floor_m, GlbMesh& walls, GlbMesh& roof);

/// Trunk and foliage: cards around the crown, facing outward. foot: local map position and height.
void add_tree(const Tree& tree, Corner foot, GlbMesh& bark, GlbMesh& foliage);

}  // namespace gigabake::sample
