/// Distance of a triangle's plane from the centres of voxels.
///
/// Exact   IEEE double, rounded to integers: host and device return the same bits.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/math/rounding.h"
#include "core/math/vec3.h"
#include "kernels/body/voxelize/coverage.h"

namespace gigabake::kernels {

inline constexpr double offset_unit = 128;     ///< one voxel
inline constexpr double max_offset_128 = 127;  ///< a plane through a voxel is at most √3/2 voxel from its centre

/// Distance from the centre of cell (u, v) to a triangle's plane in one slab, along the triangle's normal. It is linear
/// in u and v, which count voxels from the triangle's anchor.
struct PlaneOffset {
  double at_anchor, per_u, per_v;  ///< 1/128 voxel
};

/// Returns the offsets in slab `slab`, in voxels from the triangle's anchor. `normal` is the triangle's unit normal in
/// scene axes, and `w` is the slabs' axis.
GB_HD PlaneOffset make_plane_offset(const TrianglePlane& t, const Vec3<std::int16_t>& normal, int w, double slab) {
  const std::int16_t along = w == 0 ? normal[0] : (w == 1 ? normal[1] : normal[2]);
  const double scale = double(along) * (offset_unit / 32767);
  const double height = t.w[0] + (t.dw_du * (0.5 - t.u[0]) + t.dw_dv * (0.5 - t.v[0]));
  return {(height - (slab + 0.5)) * scale, t.dw_du * scale, t.dw_dv * scale};
}

/// Returns Fragment::offset of the fragment in cell (u, v).
GB_HD std::int16_t offset_in(const PlaneOffset& plane, double u, double v) {
  const double offset = (plane.at_anchor + plane.per_u * u) + plane.per_v * v;
  const double limited =
      offset < -max_offset_128 ? -max_offset_128 : (offset > max_offset_128 ? max_offset_128 : offset);
  return std::int16_t(floor_to_int32(limited + 0.5));
}

}  // namespace gigabake::kernels
