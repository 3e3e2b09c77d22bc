/// Shading normals of a triangle's fragments, from the normals of its vertices.
///
/// A shading normal is linear over a triangle, as a vertex colour is. Its value at a fragment's centroid is therefore
/// its exact mean over the fragment. It lies within max_turn of the triangle's own normal, on the same side. Voxels of
/// coarser levels derive their planes from it, and a plane remains a plane up to this angle (kernels/body/mip/patch.h).
///
/// Exact   IEEE double, rounded to integers: host and device return the same bits.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/base/host_device.h"
#include "core/math/octahedral.h"
#include "core/math/rounding.h"
#include "core/math/vec3.h"
#include "kernels/body/voxelize/part.h"

namespace gigabake::kernels {

/// Tangent of 22.5°. A surface that is turned by this angle against its voxel's plane has an RMS distance of 0.12 voxel
/// edges from it. Up to this distance, coherence_of() counts the surface as lying on the plane.
inline constexpr double max_turn = 0.41421356237309503;

/// Returns the unit normal of vertex `v` in scene axes, on either side; zero if the vertex has no usable normal. The
/// cofactors of the instance's matrix are its inverse transpose, except for length and sign.
/// Range   The part has vertex normals.
GB_HD Vec3d scene_normal(const PartArrays& part, std::uint32_t v) {
  const std::int16_t* code = part.normal + 2 * std::size_t(v);
  if (code[0] == no_vertex_normal) return {0, 0, 0};
  const double* m = part.scene_from_local;
  const Vec3d x{m[0], m[1], m[2]}, y{m[4], m[5], m[6]}, z{m[8], m[9], m[10]}, local = decode_vertex_normal(code);
  const Vec3d n{dot(cross(y, z), local), dot(cross(z, x), local), dot(cross(x, y), local)};
  constexpr double minimum = 1e-280, maximum = 1e280;
  const double squared = dot(n, n);
  if (!(squared > minimum && squared < maximum)) return {0, 0, 0};
  return n * (1 / std::sqrt(squared));
}

/// Returns the unit vector closest to `n` whose angle to the unit vector `geometric` is at most max_turn. Returns
/// `geometric` if the angle to `n` is at least 90°, or if `n` is zero.
GB_HD Vec3<std::int16_t> turned_toward(const Vec3d& n, const Vec3<std::int16_t>& geometric) {
  const Vec3d g = static_cast<Vec3d>(geometric) * (1.0 / 32767);
  const double along = dot(n, g);
  if (!(along > 0)) return geometric;
  const Vec3d across = n - g * along;
  const double squared = dot(across, across), maximum = max_turn * along;
  if (squared <= maximum * maximum) return scale_to_unit(n);
  return scale_to_unit(g * along + across * (maximum / std::sqrt(squared)));
}

/// Loads the shading normals of a triangle's vertices. `geometric` is the result of triangle_normal(). If the vertex
/// normals point to the other side of the triangle, all three are negated: the winding determines the side. Returns -1
/// if they are negated, otherwise 1.
/// Range   The part has vertex normals.
GB_HD double load_vertex_normals(const PartArrays& part, std::uint32_t triangle, const Vec3<std::int16_t>& geometric,
                                 Vec3<std::int16_t> normal[3]) {
  std::uint32_t v[3];
  triangle_vertices(part, triangle, v);
  const Vec3d a = scene_normal(part, v[0]), b = scene_normal(part, v[1]), c = scene_normal(part, v[2]);
  const double side = dot((a + b) + c, static_cast<Vec3d>(geometric)) < 0 ? -1 : 1;
  normal[0] = turned_toward(a * side, geometric);
  normal[1] = turned_toward(b * side, geometric);
  normal[2] = turned_toward(c * side, geometric);
  return side;
}

/// Returns the mean of the shading normal over the fragment in cell (u, v), whose moments are `m`. It is shorter than a
/// unit vector where the normals of the vertices differ.
GB_HD Vec3<std::int16_t> mean_normal(const Vec3<std::int16_t> normal[3], const TrianglePlane& t, const CellMoments& m,
                                     double u, double v) {
  const Barycentric w = barycentric(t, fragment_centroid(t, m, u, v));
  return Vec3<std::int16_t>::by_axis([&](int c) {
    return std::int16_t(floor_to_int32((w.a * normal[0][c] + w.b * normal[1][c]) + w.c * normal[2][c] + 0.5));
  });
}

}  // namespace gigabake::kernels
