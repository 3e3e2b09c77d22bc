/// Images and meshes of houses and trees.
#pragma once

#include "sample/glb_writer.h"
#include "sample/settlement/picture.h"
#include "sample/settlement/settlement.h"

namespace gigabake::sample {

/// Paints twelve by twelve metres of wall: two rows of windows below, plaster with one window in the middle above.
Picture paint_facade(std::uint32_t seed);
/// Paints fourteen by nine metres of roof tiles, with rows along x.
Picture paint_roof(std::uint32_t seed);
/// Paints leaves in the left half and needles in the right half. Alpha is 255 where there is foliage, else 0.
Picture paint_foliage(std::uint32_t seed);

/// The three encoded images, as files next to the tiles. All tiles with houses or trees refer to them.
struct KitImages {
  GlbImage facade, roof, foliage;
};
KitImages paint_kit(std::uint32_t seed);

/// The sizes that the images depict. Walls and roofs use the images at these sizes.
inline constexpr double facade_m = 12, roof_width_m = 14, roof_height_m = 9;

constexpr int jpeg_quality = 88;

/// A corner of a mesh in the tile's frame: metres east, north, up.
struct Corner {
  double e_m, n_m, u_m;
};

/// Converts corners from east-north-up to glTF's axes and appends one quad with the uv of each corner. The corners are
/// counter-clockwise seen from outside.
void add_quad(GlbMesh& mesh, const Corner corners[4], const double uv[4][2]);
void add_triangle(GlbMesh& mesh, const Corner corners[3], const double uv[3][2]);

/// Appends the house's walls and gables to `walls`, and its roof to `roof`. The walls' lower edge is at height base_m,
/// below ground. The floor is at height floor_m.
void add_house(const House& house, MapPoint local_centre, double base_m, double floor_m, GlbMesh& walls, GlbMesh& roof);

/// Appends the trunk to `bark`. Appends the leaves to `foliage` as cards around the crown that face outward. `foot` is
/// the tree's position in the tile's frame.
void add_tree(const Tree& tree, Corner foot, GlbMesh& bark, GlbMesh& foliage);

}  // namespace gigabake::sample
