/// A part in the form that kernels read, and access to its triangles: vertices, texture coordinates, surface.
///
/// Exact   Copies, and one determinant in IEEE double: host and device return the same bits.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/math/vec3.h"
#include "kernels/body/cell.h"
#include "kernels/body/voxelize/surface.h"

namespace gigabake::kernels {

/// PartView without its sizes: borrowed arrays and values that all triangles of the part share.
struct PartArrays {
  const float* position;
  const std::uint32_t* index;
  const float* uv;             ///< null if the part has none
  const std::uint16_t* rgba;   ///< null if the part has none
  const std::int16_t* normal;  ///< two numbers of a VertexNormal per vertex; null if the part has none
  double scene_from_local[12];
  std::uint32_t material;
  bool mirrored;                          ///< the instance's transform mirrors its triangles
  bool textured;                          ///< the part's texture is read
  NormalMapView normal_map = {};          ///< without texture if the part has no `normal_uv`
  const float* normal_uv = nullptr;       ///< null if the part has none
  const std::int16_t* tangent = nullptr;  ///< two numbers of a VertexTangent per vertex; null if the part has none
};

/// Returns the determinant of the linear part of a 3x4 row-major matrix.
GB_HD double determinant(const double m[12]) {
  return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) + m[2] * (m[4] * m[9] - m[5] * m[8]);
}

/// Returns true if the part has a texture. Without texture coordinates, its material counts as untextured.
inline bool is_textured(const CellInput& input, const PartView& part) {
  return input.materials[part.material].texture >= 0 && !part.uv.empty();
}

inline PartArrays part_arrays(const CellInput& input, const PartView& part) {
  PartArrays a{part.position.data,
               part.index.data,
               part.uv.empty() ? nullptr : part.uv.data,
               part.rgba.empty() ? nullptr : part.rgba.data,
               part.normal.empty() ? nullptr : part.normal.data->data(),
               {},
               part.material,
               determinant(part.scene_from_local) < 0,
               is_textured(input, part),
               part.normal_uv.empty() ? NormalMapView() : part.normal_map,
               part.normal_uv.empty() ? nullptr : part.normal_uv.data,
               part.tangent.empty() ? nullptr : part.tangent.data->data()};
  for (int i = 0; i < 12; ++i) a.scene_from_local[i] = part.scene_from_local[i];
  return a;
}

/// Loads the vertex indices of a triangle, in the order of WindowTriangle::p. The order is counter-clockwise seen from
/// outside, also if the instance mirrors.
GB_HD void triangle_vertices(const PartArrays& part, std::uint32_t triangle, std::uint32_t v[3]) {
  const std::uint32_t* i = part.index + 3 * std::size_t(triangle);
  v[0] = i[0];
  v[1] = part.mirrored ? i[2] : i[1];
  v[2] = part.mirrored ? i[1] : i[2];
}

/// Returns the vector between two of the part's vertices, in scene axes.
GB_HD Vec3d scene_edge(const PartArrays& part, std::uint32_t from, std::uint32_t to) {
  const float *p = part.position + 3 * std::size_t(from), *q = part.position + 3 * std::size_t(to);
  const Vec3d local{double(q[0]) - double(p[0]), double(q[1]) - double(p[1]), double(q[2]) - double(p[2])};
  return Vec3d::by_axis([&](int r) {
    const double* m = part.scene_from_local + 4 * r;
    return dot(Vec3d{m[0], m[1], m[2]}, local);
  });
}

/// Min sine of the angle between a triangle's edges. Below it, the computed area is only rounding error.
inline constexpr double min_sine = 1.0 / (std::int64_t(1) << 40);

/// Returns the unit normal of a triangle in scene axes; its length is 32767 and its sign follows the winding. It is
/// computed from the unsnapped vertices. If their area is only rounding error, it is computed from the snapped triangle
/// `t`.
///
/// Exact   The error is at most 0.06 degrees, also for slivers, unless the part's matrix flattens the triangle by
///         shear.
template <class I, class N>
GB_HD Vec3<std::int16_t> triangle_normal(const PartArrays& part, std::uint32_t triangle, const BrickTriangle<I, N>& t) {
  std::uint32_t v[3];
  triangle_vertices(part, triangle, v);
  const Vec3d a = scene_edge(part, v[0], v[1]), b = scene_edge(part, v[0], v[2]), n = cross(a, b);
  constexpr double minimum = 1e-280, maximum = 1e280;  // squares in this range are finite and exceed rounding errors
  const double squared = dot(n, n);
  if (squared > minimum && squared < maximum && squared > min_sine * min_sine * (dot(a, a) * dot(b, b)))
    return scale_to_unit(n);
  return snapped_normal(t);
}

/// Loads coordinates of the triangle's vertices from `all`, the part's `uv` or `normal_uv`. If one of them is unusable,
/// returns false and zeros. The triangle is then baked with zeros or without normal map, and counted in
/// CellStats::bad_uv.
GB_HD bool load_uv(const float* all, const std::uint32_t v[3], float uv[6]) {
  for (int i = 0; i < 6; ++i) uv[i] = all[2 * std::size_t(v[i / 2]) + i % 2];
  if (usable_uv(uv)) return true;
  for (int i = 0; i < 6; ++i) uv[i] = 0;
  return false;
}

/// Returns the shading parameters that all triangles of the part share. Normal, vertex colours and texture map are not
/// set, because they differ per triangle.
GB_HD Surface surface_of(const PartArrays& part, const MaterialView* materials, const TextureView* textures) {
  Surface s;
  s.material = materials[part.material];
  s.has_vertex_rgba = part.rgba != nullptr;
  if (part.textured)
    s.texture = textures + s.material.texture;
  else
    s.material.texture = -1;
  return s;
}

/// Loads the vertex colours of a triangle.
/// Range   The part has vertex colours.
GB_HD void load_vertex_rgba(const PartArrays& part, std::uint32_t triangle, std::uint16_t rgba[3][4]) {
  std::uint32_t v[3];
  triangle_vertices(part, triangle, v);
  for (int i = 0; i < 3; ++i) copy_texel<8>(part.rgba + 4 * std::size_t(v[i]), rgba[i]);
}

/// Returns the map from the triangle's plane to the texture.
/// Range   The part is textured.
GB_HD TextureMap texture_map(const PartArrays& part, std::uint32_t triangle, const TrianglePlane& plane,
                             const TextureView& texture) {
  std::uint32_t v[3];
  triangle_vertices(part, triangle, v);
  float uv[6];
  load_uv(part.uv, v, uv);
  return make_texture_map(plane, uv, texture.width, texture.height);
}

}  // namespace gigabake::kernels
