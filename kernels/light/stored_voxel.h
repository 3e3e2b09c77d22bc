/// Conversion of stored voxels to the packed voxels that rays composite, and copies of runs of them to bricks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/host_device.h"
#include "core/octree/octree.h"
#include "core/octree/plane.h"
#include "kernels/light/shade.h"
#include "kernels/pool/cast_brick.h"
#include "kernels/pool/pack_brick.h"
#include "kernels/pool/voxel_run.h"

namespace gigabake::kernels {

/// The property of voxels that an image shows.
enum class ShownProperty : std::uint8_t { colour, normal, coverage, voxel_class };

/// Columns of stored voxels. A column that does not exist is null.
struct StoredVoxels {
  const std::uint8_t* rgba = nullptr;                  ///< 4 per voxel
  const std::int8_t* normal = nullptr;                 ///< 2 per voxel, octahedral
  const std::uint8_t* directional_coverage = nullptr;  ///< directional_coverage_bytes per voxel
  const VoxelClass* voxel_class = nullptr;             ///< 1 per voxel
};

/// Colours of classes in images: an entry for content without a class, then entries that the other classes use in turn.
inline constexpr int class_colour_count = 12;

/// Parameters of the conversion. All pointers are borrowed.
struct StoredVoxelShading {
  CastLight light;
  Tables tables;
  const std::uint8_t* coverage = nullptr;      ///< [max_cast_lods][256]: by level and alpha, for voxels without
                                               ///< directional coverage
  const std::uint8_t* class_colour = nullptr;  ///< [1 + class_colour_count][3]
  ShownProperty shows = ShownProperty::colour;
  bool has_normals = false;  ///< otherwise normals are ignored
};

/// Returns the colour of a class from the table StoredVoxelShading::class_colour.
GB_HD const std::uint8_t* colour_of_class(const std::uint8_t* class_colour, VoxelClass voxel_class) {
  return class_colour + 3 * (voxel_class == no_class ? 0 : 1 + (voxel_class - 1) % class_colour_count);
}

/// Returns the normal's x, y and z, mapped from [-1, 1] to 0 … 255.
GB_HD Vec3<std::uint8_t> colour_of_normal(const Tables& tables, const std::int8_t* normal) {
  const std::int16_t* n = tables.unit_normal + 4 * (std::uint8_t(normal[0]) | std::uint8_t(normal[1]) << 8);
  return {std::uint8_t((n[0] + 32767) * 255 / 65534), std::uint8_t((n[1] + 32767) * 255 / 65534),
          std::uint8_t((n[2] + 32767) * 255 / 65534)};
}

/// Returns the coverages along x, y and z of voxel `i`. If a voxel's whole surface lies on its plane, the ray caster
/// derives the coverage from the plane. Alpha is then the coverage along all axes; it matters only in a brick that
/// replaces missing finer bricks.
GB_HD Vec3<std::uint8_t> stored_coverage(const StoredVoxelShading& shading, int lod, const StoredVoxels& voxels,
                                         std::size_t i) {
  const std::uint8_t alpha = voxels.rgba[4 * i + 3];
  if (voxels.directional_coverage == nullptr || lod == 0)
    return Vec3<std::uint8_t>::all(shading.coverage[256 * lod + alpha]);
  const std::uint8_t* c = voxels.directional_coverage + directional_coverage_bytes * i;
  if (is_fully_planar(c[directional_coverage_plane])) return Vec3<std::uint8_t>::all(alpha);
  return {std::uint8_t(c[0] > 1 ? c[0] : 1), std::uint8_t(c[1] > 1 ? c[1] : 1), std::uint8_t(c[2] > 1 ? c[2] : 1)};
}

/// Returns the 8-bit colour that voxel `i` shows.
GB_HD Vec3<std::uint8_t> stored_colour(const StoredVoxelShading& shading, const StoredVoxels& voxels, std::size_t i) {
  const std::uint8_t* rgba = voxels.rgba + 4 * i;
  if (shading.shows == ShownProperty::coverage) return Vec3<std::uint8_t>::all(rgba[3]);
  if (shading.shows == ShownProperty::normal && shading.has_normals)
    return colour_of_normal(shading.tables, voxels.normal + 2 * i);
  if (shading.shows != ShownProperty::voxel_class) return {rgba[0], rgba[1], rgba[2]};
  const std::uint8_t* colour =
      colour_of_class(shading.class_colour, voxels.voxel_class == nullptr ? no_class : voxels.voxel_class[i]);
  return {colour[0], colour[1], colour[2]};
}

/// Returns voxel `i`, a voxel of level `lod`, as rays composite it.
/// Exact   IEEE float: host and device return the same bits.
GB_HD PackedVoxel shaded_voxel(const StoredVoxelShading& shading, int lod, const StoredVoxels& voxels, std::size_t i) {
  const Vec3<std::uint8_t> coverage = stored_coverage(shading, lod, voxels, i);
  const std::int8_t* const normal = shading.has_normals ? voxels.normal + 2 * i : nullptr;
  const Vec3<std::uint16_t> radiance =
      shaded_radiance(stored_colour(shading, voxels, i), shading.shows == ShownProperty::colour ? normal : nullptr,
                      shading.light, shading.tables, coverage[0] + coverage[1] + coverage[2]);
  if (normal == nullptr) return pack_voxel(radiance, coverage, {no_normal, 0, 0}, 0);
  std::uint8_t plane = 0;
  if (voxels.directional_coverage != nullptr)
    plane = voxels.directional_coverage[directional_coverage_bytes * i + directional_coverage_plane];
  if (lod == 0 && voxels.rgba[4 * i + 3] < 255) plane = clear_plane;
  return pack_voxel(radiance, coverage, octahedron_point(normal).c, plane);
}

/// Returns the columns of a page in a page pool.
GB_HD StoredVoxels voxels_of(const StoredVoxels& pool, const PooledPage& page) {
  const std::size_t first = page.first;
  return {pool.rgba + 4 * first, pool.normal == nullptr ? nullptr : pool.normal + 2 * first,
          page.has_directional_coverage ? pool.directional_coverage + directional_coverage_bytes * first : nullptr,
          page.has_classes ? pool.voxel_class + first : nullptr};
}

/// Writes the voxels of a run to a brick's parts, which begin at parts[0]. `layers` has at least the brick's layers.
/// Exact   Host and device write the same bits.
GB_HD void write_run(const StoredVoxelShading& shading, int lod, const StoredVoxels& page, const VoxelRun& run,
                     const BrickView& layers, PackedVoxel* parts) {
  constexpr int per_layer = slot_edge * slot_edge;
  const CastLayer layer = load_layer(layers, run.place / per_layer);
  PackedVoxel* const to = parts + window_of(layer, run.place % per_layer).first;
  for (std::uint32_t k = 0; k < run.count; ++k) to[k] = shaded_voxel(shading, lod, page, std::size_t(run.from) + k);
}

/// Copies the voxels of the brick's runs to its parts, and removes the runs. `pages` has the columns of the pages that
/// the runs name.
void copy_runs(const StoredVoxelShading& shading, const std::array<StoredVoxels, max_brick_pages>& pages,
               CastBrick& brick);

/// Copies the voxels of the brick's runs out of a page pool to the parts that begin at parts[0]. The layers were copied
/// there before.
void copy_pooled_runs(const StoredVoxelShading& shading, const StoredVoxels& pool, const CastBrick& brick,
                      PackedVoxel* parts);

}  // namespace gigabake::kernels
