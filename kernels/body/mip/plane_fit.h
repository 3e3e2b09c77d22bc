/// Fit of a plane to a patch that is a single surface.
///
/// Exact   32-bit integers: host and device return the same bits.
/// Source  docs/experiments/levels.md (blended planes).
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/math/vec3.h"
#include "core/octree/plane.h"
#include "kernels/body/mip/patch.h"

namespace gigabake::kernels {

/// Returns part / whole, rounded to nearest, half up.
/// Range   whole > 0, 2·|part| + whole < 2^31.
GB_HD std::int32_t rounded_ratio(std::int32_t part, std::int32_t whole) {
  const std::int32_t twice = 2 * part + whole, by = 2 * whole;
  return twice >= 0 ? twice / by : -((by - 1 - twice) / by);
}

/// Returns a linear ramp: 0 below `from`, 256 above `to`.
GB_HD std::int32_t ramp_256(std::int32_t x, std::int32_t from, std::int32_t to) {
  if (x <= from) return 0;
  return x >= to ? 256 : (x - from) * 256 / (to - from);
}

/// Returns the degree to which a patch is a single surface, 0 … 3. It rises from 0 while the length of the mean normal
/// grows from 0.65 to 0.8. It falls to 0 while the RMS distance from the plane grows from 0.12 to 0.2 voxel edges.
GB_HD int coherence_of(const SurfaceMoments& patch) {
  const std::int32_t alike = ramp_256(patch.normal_coherence, 165, 204);
  const std::int32_t far = ramp_256(patch.spread, 15, 41);
  return int((max_coherence * alike * (256 - far) + 32768) >> 16);
}

/// Returns the plane of a patch. At lod 1 (`is_finest`), every third offset is used, which takes fewer bytes of a
/// shard.
GB_HD Plane plane_of(const SurfaceMoments& patch, const std::int8_t normal[2], bool is_finest) {
  const int coherence = coherence_of(patch);
  if (coherence == 0) return {};
  const OctahedronPoint n = octahedron_point(normal);
  const std::int32_t above = dot(n.c, static_cast<Vec3<std::int32_t>>(patch.place));
  const std::int32_t step = is_finest ? 3 : 1, maximum = max_offset / step;
  const std::int32_t steps = rounded_ratio(above >> 4, 127 * (position_unit >> 4) * step / max_offset);
  return {step * (steps < -maximum ? -maximum : (steps > maximum ? maximum : steps)), coherence};
}

/// Returns the coverage to store: 0 if the whole surface lies on the plane, because the plane then determines it.
GB_HD std::uint32_t stored_coverage(const Plane& plane, std::uint32_t coverage) {
  return plane.coherence == max_coherence ? 0 : coverage;
}

}  // namespace gigabake::kernels
