/// Conversion of accumulators to voxels.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/base/host_device.h"
#include "core/math/octahedral.h"
#include "kernels/body/tables.h"
#include "kernels/body/voxel.h"
#include "kernels/body/voxelize/accumulate.h"
#include "kernels/body/voxelize/finest_surface.h"

namespace gigabake::kernels {

/// Returns 65535 · part · inverse_whole, rounded to nearest; at most 65535.
GB_HD std::uint16_t ratio16(double part, double inverse_whole) {
  const double r = std::floor(part * inverse_whole * 65535 + 0.5);
  return std::uint16_t(r > 65535 ? 65535 : r);
}

/// A lod-0 voxel and the plane of its surface, packed by pack_plane().
struct FinestVoxel {
  Voxel voxel;
  std::uint8_t plane;
};

/// Computes the voxel of an accumulator. Returns false if alpha rounds to 0; such a voxel is not stored. A translucent
/// voxel has no plane.
/// Exact   Sums are exact integers; the means are IEEE double: host and device return the same bits.
template <class I>
GB_HD bool resolve(const I sums[sum_count], const Tables& tables, FinestVoxel& out) {
  const double weight = double(sums[sum_weight]), alpha = double(sums[sum_weight] * 65535 - sums[sum_clear]);
  const double coverage = sums[sum_opaque] != 0 ? 255 : std::floor(alpha / (weight * 65535) * 255 + 0.5);
  if (!(coverage >= 1)) return false;
  Voxel& voxel = out.voxel;
  const double inverse = 1 / alpha;
  for (int c = 0; c < 3; ++c) voxel.rgba[c] = tables.srgb_from_linear[ratio16(double(sums[sum_red + c]), inverse)];
  voxel.rgba[3] = std::uint8_t(coverage > 255 ? 255 : coverage);
  const double visible = alpha * (1 / 65535.0);
  const FinestSurface surface = finest_surface(sums, visible);
  encode_octahedral(surface.normal[0], surface.normal[1], surface.normal[2], voxel.normal);
  out.plane = has_plane(sums, visible) ? pack_plane(plane_of(surface, visible, voxel.normal)) : std::uint8_t(0);
  return true;
}

}  // namespace gigabake::kernels
