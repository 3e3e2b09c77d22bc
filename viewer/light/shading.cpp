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

/// Returns the normal's x, y and z, mapped from [-1, 1] to 0 … 255.
Vec3<std::uint8_t> colour_of_normal(const std::int8_t* normal) {
  const std::size_t code = std::size_t(std::uint8_t(normal[0])) | std::size_t(std::uint8_t(normal[1])) << 8;
  const std::int16_t* n = kernels::TableStore::host().view().unit_normal + 4 * code;
  Vec3<std::uint8_t> colour;
  for (int c = 0; c < 3; ++c) colour[c] = std::uint8_t((n[c] + 32767) * 255 / 65534);
  return colour;
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

/// Returns the coverages along x, y and z. If a voxel's whole surface lies on its plane, the ray caster derives the
/// coverage from the plane. Alpha is then the coverage along all axes; it matters only in a brick that replaces missing
/// finer bricks.
Vec3<std::uint8_t> Shading::coverage_of(int lod, std::uint8_t alpha, const std::uint8_t* directional_coverage) const {
  if (directional_coverage == nullptr || lod == 0) return Vec3<std::uint8_t>::all(coverage_[std::size_t(lod)][alpha]);
  if (is_fully_planar(directional_coverage[directional_coverage_plane])) return Vec3<std::uint8_t>::all(alpha);
  const auto at_least_one = [](std::uint8_t c) { return std::max<std::uint8_t>(c, 1); };
  return {at_least_one(directional_coverage[0]), at_least_one(directional_coverage[1]),
          at_least_one(directional_coverage[2])};
}

Vec3<std::uint8_t> Shading::colour_of(const std::uint8_t rgba[4], const std::int8_t* normal,
                                      VoxelClass voxel_class) const {
  if (surface_ == Surface::coverage) return Vec3<std::uint8_t>::all(rgba[3]);
  if (surface_ == Surface::normal && has_normals_) return colour_of_normal(normal);
  if (surface_ != Surface::voxel_class) return {rgba[0], rgba[1], rgba[2]};
  const auto [red, green, blue] = class_colour(voxel_class);
  return {red, green, blue};
}

kernels::PackedVoxel Shading::operator()(int lod, const std::uint8_t rgba[4], const std::int8_t* normal,
                                         const std::uint8_t* directional_coverage, VoxelClass voxel_class) const {
  const Vec3<std::uint8_t> coverage = coverage_of(lod, rgba[3], directional_coverage);
  const Vec3<std::uint16_t> radiance = kernels::shaded_radiance(
      colour_of(rgba, normal, voxel_class), has_normals_ && surface_ == Surface::colour ? normal : nullptr, light_,
      tables_, coverage[0] + coverage[1] + coverage[2]);
  if (!has_normals_) return kernels::pack_voxel(radiance, coverage, {kernels::no_normal, 0, 0}, 0);
  std::uint8_t plane = directional_coverage != nullptr ? directional_coverage[directional_coverage_plane] : 0;
  if (lod == 0 && rgba[3] < 255) plane = kernels::clear_plane;
  return kernels::pack_voxel(radiance, coverage, octahedron_point(normal).c, plane);
}

}  // namespace gigabake
