/// A part as bodies read it, and what it says of one of its triangles: vertices, texture coordinates, surface.
///
/// Exact   Copies, and one determinant in IEEE double: host and device return the same bits.
#pragma once

#include <cstdint>

#include "kernels/body/cell.h"
#include "kernels/body/surface.h"
#include "lattice/host_device.h"

namespace gigabake::kernels {

/// A PartView without its sizes: borrowed arrays, and what is the same for all triangles of the part.
struct PartArrays {
  const float* position;
  const std::uint32_t* index;
  const float* uv;            ///< or null
  const std::uint16_t* rgba;  ///< or null
  double scene_from_local[12];
  std::uint32_t material;
  bool mirrored;  ///< the instance shows its triangles from behind
  bool textured;  ///< its texture is read
};

/// Of the linear part of a 3x4 row-major matrix.
GB_HD double determinant(const double m[12]) {
  return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) + m[2] * (m[4] * m[9] - m[5] * m[8]);
}

/// Where there are no texture coordinates, the material is one without texture.
inline bool is_textured(const CellInput& input, const PartView& part) {
  return input.materials[part.material].texture >= 0 && !part.uv.empty();
}

inline PartArrays part_arrays(const CellInput& input, const PartView& part) {
  PartArrays a{part.position.data,
               part.index.data,
               part.uv.empty() ? nullptr : part.uv.data,
               part.rgba.empty() ? nullptr : part.rgba.data,
               {},
               part.material,
               determinant(part.scene_from_local) < 0,
               is_textured(input, part)};
  for (int i = 0; i < 12; ++i) a.scene_from_local[i] = part.scene_from_local[i];
  return a;
}

/// Vertices of a triangle, numbered within the part, in the order that WindowTriangle::p has them: counter-clockwise
/// from outside, also where the instance mirrors.
GB_HD void triangle_vertices(const PartArrays& part, std::uint32_t triangle, std::uint32_t v[3]) {
  const std::uint32_t* i = part.index + 3 * std::size_t(triangle);
  v[0] = i[0];
  v[1] = part.mirrored ? i[2] : i[1];
  v[2] = part.mirrored ? i[1] : i[2];
}

/// From one of the part's vertices to another, in the scene's axes.
GB_HD void scene_edge(const PartArrays& part, std::uint32_t from, std::uint32_t to, double edge[3]) {
  const float *p = part.position + 3 * std::size_t(from), *q = part.position + 3 * std::size_t(to);
  const double x = double(q[0]) - double(p[0]), y = double(q[1]) - double(p[1]), z = double(q[2]) - double(p[2]);
  for (int r = 0; r < 3; ++r) {
    const double* m = part.scene_from_local + 4 * r;
    edge[r] = (m[0] * x + m[1] * y) + m[2] * z;
  }
}

/// A triangle whose edges make an angle with a smaller sine has no area that rounding would leave alone.
inline constexpr double least_sine = 1.0 / (std::int64_t(1) << 40);

/// Unit normal (32767) by the winding, in scene axes: of the vertices as the scene has them, before they are snapped;
/// of the snapped ones, `t`, where the triangle has no area in the scene.
///
/// Exact   Within 0.06 degrees wherever the part's matrix shears nothing flat, of slivers too.
template <class I, class N>
GB_HD void triangle_normal(const PartArrays& part, std::uint32_t triangle, const BrickTriangle<I, N>& t,
                           std::int16_t normal[3]) {
  std::uint32_t v[3];
  triangle_vertices(part, triangle, v);
  double a[3], b[3];
  scene_edge(part, v[0], v[1], a);
  scene_edge(part, v[0], v[2], b);
  const double n[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  constexpr double least = 1e-280, most = 1e280;  // squares that are not all rounding, and finite
  const double squared = dot(n, n);
  if (squared > least && squared < most && squared > least_sine * least_sine * (dot(a, a) * dot(b, b)))
    scale_to_unit(n, normal);
  else
    snapped_normal(t, normal);
}

/// Texture coordinates of the triangle's vertices. False, and zeros, where one of them names no texel: the triangle is
/// baked so, and counted in CellStats::bad_uv.
GB_HD bool load_uv(const PartArrays& part, const std::uint32_t v[3], float uv[6]) {
  for (int i = 0; i < 6; ++i) uv[i] = part.uv[2 * std::size_t(v[i / 2]) + i % 2];
  if (usable_uv(uv)) return true;
  for (int i = 0; i < 6; ++i) uv[i] = 0;
  return false;
}

/// The surface of the part's triangles, but for what differs between them: normal, vertex colours, texture map.
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

/// Range  the part has vertex colours.
GB_HD void load_vertex_rgba(const PartArrays& part, std::uint32_t triangle, std::uint16_t rgba[3][4]) {
  std::uint32_t v[3];
  triangle_vertices(part, triangle, v);
  for (int i = 0; i < 3; ++i) copy_texel<8>(part.rgba + 4 * std::size_t(v[i]), rgba[i]);
}

/// Where the triangle's fragments lie on the texture. Range  the part is textured.
GB_HD TextureMap texture_map(const PartArrays& part, std::uint32_t triangle, const TrianglePlane& plane,
                             const TextureView& texture) {
  std::uint32_t v[3];
  triangle_vertices(part, triangle, v);
  float uv[6];
  load_uv(part, v, uv);
  return make_texture_map(plane, uv, texture.width, texture.height);
}

}  // namespace gigabake::kernels
