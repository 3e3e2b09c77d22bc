#include "viewer/light/shading.h"

#include <algorithm>
#include <cmath>

#include "core/octree/parameters.h"
#include "core/octree/plane.h"
#include "kernels/body/tables.h"

namespace gigabake {
namespace {

/// Returns the coverage a of a flat layer from `mean`, the value that the next coarser level stores.
/// `mean` is the mean over the three axes: (a + 2(a - a²/2)) / 3.
double directional_coverage_below(double mean) { return mean >= 2.0 / 3 ? 1 : (3 - std::sqrt(9 - 12 * mean)) / 2; }

/// Sets red, green and blue to the normal's x, y and z, mapped from [-1, 1] to 0 … 255.
void paint_normal(const std::int8_t* normal, std::uint8_t rgba[4]) {
  const std::size_t code = std::size_t(std::uint8_t(normal[0])) | std::size_t(std::uint8_t(normal[1])) << 8;
  const std::int16_t* n = kernels::TableStore::host().view().unit_normal + 4 * code;
  for (int c = 0; c < 3; ++c) rgba[c] = std::uint8_t((n[c] + 32767) * 255 / 65534);
}

/// Colours that differ in hue and lightness, after the usual colours of LAS classes. Class 2 (ground) is brown, 3 to 5
/// (vegetation) are green, 6 (building) is red, 9 (water) is blue.
constexpr std::array<std::array<std::uint8_t, 3>, 12> class_colours{{{187, 187, 187},
                                                                     {170, 120, 70},
                                                                     {187, 204, 51},
                                                                     {100, 180, 60},
                                                                     {20, 110, 50},
                                                                     {210, 60, 50},
                                                                     {238, 119, 51},
                                                                     {170, 51, 119},
                                                                     {51, 119, 200},
                                                                     {238, 204, 102},
                                                                     {90, 90, 140},
                                                                     {102, 204, 238}}};

}  // namespace

std::array<std::uint8_t, 3> class_colour(VoxelClass voxel_class) {
  constexpr std::array<std::uint8_t, 3> without_class{96, 96, 96};
  if (voxel_class == no_class) return without_class;
  return class_colours[(std::size_t(voxel_class) - 1) % class_colours.size()];
}

Shading::Shading(const kernels::CastLight& light, const SceneHeader& scene, Surface surface)
    : light_(surface == Surface::colour ? light : kernels::unlit()),
      surface_(surface),
      has_normals_(scene.has_normals) {
  // Only version 1 scenes store the mean over the three axes. Bakes without `directional_coverage` store the maximum.
  const bool averaged =
      has_directional_coverage(parameters_from_json(scene.parameters)) && !scene.has_directional_coverage;
  for (int lod = 0; lod < kernels::max_cast_lods; ++lod)
    for (int stored = 0; stored < 256; ++stored) {
      double coverage = stored / 255.0;
      for (int l = 0; l < lod && averaged; ++l) coverage = directional_coverage_below(coverage);
      coverage_[std::size_t(lod)][std::size_t(stored)] = std::uint8_t(coverage * 255 + 0.5);
    }
}

kernels::CastVoxel Shading::operator()(int lod, const std::uint8_t rgba[4], const std::int8_t* normal,
                                       const std::uint8_t* directional_coverage, VoxelClass voxel_class) const {
  Vec3<std::uint16_t> coverage;
  // If a voxel's whole surface lies on its plane, the ray caster derives the coverage from the plane. Alpha is
  // then the coverage along all axes; it matters only in a brick that replaces missing finer bricks.
  const bool is_planar =
      directional_coverage != nullptr && is_fully_planar(directional_coverage[directional_coverage_plane]);
  for (int a = 0; a < 3; ++a)
    coverage[a] =
        std::uint16_t(257 * (directional_coverage == nullptr || lod == 0 ? coverage_[std::size_t(lod)][rgba[3]]
                             : is_planar                                 ? rgba[3]
                                         : std::max<std::uint8_t>(directional_coverage[a], 1)));
  std::uint8_t shown[4] = {rgba[0], rgba[1], rgba[2], rgba[3]};
  if (surface_ == Surface::coverage) std::fill_n(shown, 3, rgba[3]);
  if (surface_ == Surface::voxel_class) std::ranges::copy(class_colour(voxel_class), shown);
  if (surface_ == Surface::normal && has_normals_) paint_normal(normal, shown);
  kernels::CastVoxel voxel = kernels::shade_voxel(shown, has_normals_ && surface_ == Surface::colour ? normal : nullptr,
                                                  light_, kernels::TableStore::host().view(), coverage);
  if (!has_normals_) return voxel;
  if (directional_coverage != nullptr) voxel.plane = directional_coverage[directional_coverage_plane];
  if (lod == 0 && rgba[3] < 255) voxel.plane = kernels::clear_plane;
  const OctahedronPoint n = octahedron_point(normal);
  for (int a = 0; a < 3; ++a) voxel.normal[a] = std::int8_t(n.c[a]);
  return voxel;
}

}  // namespace gigabake
