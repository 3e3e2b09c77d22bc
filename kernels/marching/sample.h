/// The field that rays integrate: trilinear interpolation of the eight voxels around a point of one level.
///
/// Above lod 3, the voxels of two neighbouring columns of cells may be offset along z. At the border between these
/// columns, interpolation uses the neighbour's voxel that contains the required voxel centre. The brick's border stores
/// that voxel.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/octree/brick.h"
#include "kernels/marching/locate.h"
#include "kernels/marching/scene.h"

namespace gigabake::kernels {

struct CastSample {
  float c[cast_channels] = {};  ///< the channels of CastVoxel::c, scaled so that 1 represents 1

  GB_HD float mean_coverage() const { return ((c[3] + c[4]) + c[5]) * (1.0f / 3); }
};

/// A point in a brick. On each axis it lies between the centres of voxels `base` and `base` + 1 of the brick.
struct CastPoint {
  Vec3<int> base;       ///< 0…7
  Vec3<float> between;  ///< 0…1, in voxels
};

/// Returns the position of a point in its brick.
/// Range   `lod` is the brick's level. The point is relative to the lowest voxel centre of that level.
GB_HD CastPoint point_in_brick(const FixedPoint& at, int lod) {
  CastPoint r;
  for (int a = 0; a < 3; ++a) {
    const std::uint32_t u = at.in_node(a, lod);
    r.base[a] = int(u >> fraction_bits);
    r.between[a] = float(u & (fixed_one - 1)) * (1.0f / fixed_one);
  }
  return r;
}

/// The interpolation taps of a point: the eight voxels around it. Tap x | y<<1 | z<<2 is the voxel at offset (x, y, z).
/// The member `between` is the point's position between the taps.
struct CastCorners {
  const PackedVoxel* voxels;  ///< the voxel pool, to which the indices of the windows refer
  LayerWindow low, high;
  Vec3<float> between;

  /// Returns a mask of the taps that have a voxel (bit c: tap c). Sums over voxels iterate over these bits in ascending
  /// order. Usually fewer than half of the bits are set, and lanes of a warp stay busy although each lane visits
  /// different voxels.
  GB_HD std::uint32_t there() const { return low.two_by_two() | high.two_by_two() << 4; }

  /// Returns the voxel of a tap.
  /// Range   corner: a bit of there().
  GB_HD CastVoxel stored(int corner) const { return unpack_voxel(packed(corner)); }

  /// Returns the packed voxel of a tap.
  /// Range   corner: a bit of there().
  GB_HD PackedVoxel packed(int corner) const {
    const std::uint32_t low_row = (corner & 2) != 0 ? low.second : low.first,
                        high_row = (corner & 2) != 0 ? high.second : high.first;
    const std::uint32_t before = there() >> (corner & 6) & std::uint32_t(corner) & 1;  // the row's other tap
    return load_packed(voxels + ((corner < 4 ? low_row : high_row) + before));
  }

  /// Returns the interpolation weight of a tap.
  GB_HD float weight(int corner) const {
    const float x = (corner & 1) != 0 ? between[0] : 1 - between[0];
    const float y = (corner & 2) != 0 ? between[1] : 1 - between[1];
    return x * y * ((corner & 4) != 0 ? between[2] : 1 - between[2]);
  }
};

GB_HD CastCorners corners_of(const BrickView& brick, const CastPoint& point) {
  const int at = point.base[0] + slot_edge * point.base[1];
  return {brick.voxels, load_window(brick, point.base[2], at), load_window(brick, point.base[2] + 1, at),
          point.between};
}

/// Tests whether the field is zero at the point. Reads no layer if the field is zero in the point's whole block.
/// `blocks` is the brick's CastHead::blocks.
GB_HD bool is_zero(std::uint64_t blocks, const BrickView& brick, const CastPoint& point) {
  const int at = point.base[0] + slot_edge * point.base[1];
  return is_empty_block(blocks, point.base.v) ||
         (load_two_by_two(brick, point.base[2], at) | load_two_by_two(brick, point.base[2] + 1, at)) == 0;
}

}  // namespace gigabake::kernels
