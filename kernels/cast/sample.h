/// The field that rays integrate: the eight voxels around a point of one level, interpolated.
///
/// Where two columns of cells are not aligned at a level (z above lod 3), a voxel of the other cell stands for the
/// centre that lies in it; so it was put into the brick's border.
#pragma once

#include <cstdint>

#include "kernels/cast/locate.h"
#include "kernels/cast/scene.h"
#include "lattice/brick.h"
#include "lattice/host_device.h"

namespace gigabake::kernels {

struct CastSample {
  float c[cast_channels] = {};  ///< as CastVoxel, 1 = 1

  GB_HD float mean_coverage() const { return ((c[3] + c[4]) + c[5]) * (1.0f / 3); }
};

/// A point of a brick, in its voxels: between the centres of `base` and base + 1.
struct CastPoint {
  int base[3];       ///< 0…7
  float between[3];  ///< 0…1
};

GB_HD CastPoint point_in_brick(const CastPlace& place, const double p[3]) {
  const double per_edge = power_of_two(-place.lod);
  CastPoint r;
  for (int a = 0; a < 3; ++a) {
    const float u = float((p[a] - place.half - place.corner[a]) * per_edge);
    const int whole = int(u);
    r.base[a] = whole < brick_edge - 1 ? whole : brick_edge - 1;
    r.between[a] = u - float(r.base[a]);
  }
  return r;
}

/// The eight voxels around a point, x | y<<1 | z<<2, and where it lies between them.
struct CastCorners {
  const PackedVoxel* parts;
  LayerWindow low, high;
  float between[3];

  /// Bit c: there is a voxel at corner c. Sums over voxels go over these bits, upwards: fewer than half of the eight
  /// are there, and lanes of a warp that have each its own next voxel are all at work.
  GB_HD std::uint32_t there() const { return low.two_by_two() | high.two_by_two() << 4; }

  /// Range  corner: one of there().
  GB_HD CastVoxel stored(int corner) const {
    const LayerWindow layer = corner < 4 ? low : high;
    return unpack_voxel(load_packed(parts + layer.place((corner & 1) + slot_edge * (corner >> 1 & 1))));
  }

  GB_HD CastVoxel voxel(int corner) const { return (there() >> corner & 1) != 0 ? stored(corner) : CastVoxel{}; }

  /// Of the interpolation between them.
  GB_HD float weight(int corner) const {
    const float x = (corner & 1) != 0 ? between[0] : 1 - between[0];
    const float y = (corner & 2) != 0 ? between[1] : 1 - between[1];
    return x * y * ((corner & 4) != 0 ? between[2] : 1 - between[2]);
  }
};

GB_HD CastCorners corners_of(const BrickView& brick, const CastPoint& point) {
  const int at = point.base[0] + slot_edge * point.base[1];
  return {brick.parts,
          window_of(load_layer(brick, point.base[2]), at),
          window_of(load_layer(brick, point.base[2] + 1), at),
          {point.between[0], point.between[1], point.between[2]}};
}

/// blocks: the brick's. Where one of them is zero no layer is looked at.
GB_HD bool is_zero(std::uint64_t blocks, const BrickView& brick, const CastPoint& point) {
  return is_empty_block(blocks, point.base) || corners_of(brick, point).there() == 0;
}

/// x first, then y, then z.
GB_HD CastSample interpolate(const CastCorners& corners) {
  CastVoxel voxel[8];
  GB_UNROLL
  for (int c = 0; c < 8; ++c) voxel[c] = corners.voxel(c);
  CastSample r;
  GB_UNROLL
  for (int k = 0; k < cast_channels; ++k) {
    float row[4];
    GB_UNROLL
    for (int i = 0; i < 4; ++i) {
      const float low = voxel[2 * i].c[k], high = voxel[2 * i + 1].c[k];
      row[i] = low + (high - low) * corners.between[0];
    }
    const float near = row[0] + (row[1] - row[0]) * corners.between[1];
    const float far = row[2] + (row[3] - row[2]) * corners.between[1];
    r.c[k] = (near + (far - near) * corners.between[2]) * (1.0f / 65535);
  }
  return r;
}

}  // namespace gigabake::kernels
