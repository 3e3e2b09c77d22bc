#include "viewer/light/shading.h"

#include <cmath>

#include "core/octree/parameters.h"

namespace gigabake {
namespace {

/// Returns the coverage a of a flat layer from `mean`, the value that the next coarser level stores.
/// `mean` is the mean over the three axes: (a + 2(a - a²/2)) / 3.
double directional_coverage_below(double mean) { return mean >= 2.0 / 3 ? 1 : (3 - std::sqrt(9 - 12 * mean)) / 2; }

/// The table StoredVoxelShading::class_colour. Content without a class is dark grey. The other colours differ in hue
/// and lightness, after the usual colours of LAS classes: class 2 (ground) is brown, 3 to 5 (vegetation) are green,
/// 6 (building) is red, 9 (water) is blue.
constexpr std::uint8_t class_colours[1 + kernels::class_colour_count][3] = {
    {96, 96, 96},   {187, 187, 187}, {170, 120, 70}, {187, 204, 51},  {100, 180, 60}, {20, 110, 50},  {210, 60, 50},
    {238, 119, 51}, {170, 51, 119},  {51, 119, 200}, {238, 204, 102}, {90, 90, 140},  {102, 204, 238}};

}  // namespace

std::array<std::uint8_t, 3> class_colour(VoxelClass voxel_class) {
  const std::uint8_t* colour = kernels::colour_of_class(class_colours[0], voxel_class);
  return {colour[0], colour[1], colour[2]};
}

Shading::Shading(const kernels::CastLight& light, const SceneHeader& scene, Surface surface) {
  // Only version 1 scenes store the mean over the three axes. Bakes without `directional_coverage` store the maximum.
  const bool averaged =
      has_directional_coverage(parameters_from_json(scene.parameters)) && !scene.has_directional_coverage;
  for (int lod = 0; lod < kernels::max_cast_lods; ++lod)
    for (int stored = 0; stored < 256; ++stored) {
      double coverage = stored / 255.0;
      for (int l = 0; l < lod && averaged; ++l) coverage = directional_coverage_below(coverage);
      coverage_[std::size_t(lod)][std::size_t(stored)] = std::uint8_t(coverage * 255 + 0.5);
    }
  parameters_ = {surface == Surface::colour ? light : kernels::unlit(),
                 kernels::TableStore::host().view(),
                 coverage_[0].data(),
                 class_colours[0],
                 surface,
                 scene.has_normals};
}

}  // namespace gigabake
