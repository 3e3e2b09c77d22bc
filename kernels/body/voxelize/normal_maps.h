/// Shading normals of a triangle's fragments, from a normal map.
///
/// The map's x axis is the tangent: stored per vertex and interpolated, or the triangle's direction of growing s. The y
/// axis is the bitangent, normal × tangent times ±1. It points towards smaller t, also where the texture or the
/// instance is mirrored. The resulting normal lies within max_turn of the triangle's normal, as a vertex normal does.
///
/// Exact   IEEE double, rounded to integers: host and device return the same bits.
/// Source  glTF 2.0 (tangents, normalTextureInfo); docs/adr/0556-normal-maps.md.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/base/host_device.h"
#include "core/math/octahedral.h"
#include "core/math/rounding.h"
#include "core/math/vec3.h"
#include "kernels/body/texture/normal_map.h"
#include "kernels/body/voxelize/part.h"
#include "kernels/body/voxelize/vertex_normals.h"

namespace gigabake::kernels {

/// Tangents of a triangle's vertices in scene axes.
struct TriangleTangents {
  Vec3<std::int16_t> vertex[3];  ///< unit length 32767
  std::int8_t bitangent;         ///< sign of the bitangent against normal × tangent; 0: the triangle has no tangents
};

/// The normal map of a triangle.
struct TriangleMap {
  const TextureView* texture;  ///< null: the triangle has none
  NormalMapView view;
  TextureMap map;
  TriangleTangents tangents;
};

/// Sets `unit` to t, scaled to unit length. Returns false if t is too short or too long for this.
GB_HD bool set_unit(const Vec3d& t, Vec3<std::int16_t>& unit) {
  constexpr double minimum = 1e-280, maximum = 1e280;
  const double squared = dot(t, t);
  if (!(squared > minimum && squared < maximum)) return false;
  unit = scale_to_unit(t);
  return true;
}

/// Loads the part's stored tangents. `side` is the result of load_vertex_normals(), or 1 without vertex normals. The
/// result has no tangents if one of the three vertices has none.
///
/// A normal that is negated negates the whole frame. Its normal × tangent does not change, so the sign does. The
/// cofactors of a mirroring matrix already negate normals once, but not tangents.
GB_HD TriangleTangents stored_tangents(const PartArrays& part, const std::uint32_t v[3], double side) {
  TriangleTangents out{};
  const double mirror = part.mirrored ? -1 : 1, turn = part.normal != nullptr ? side * mirror : 1;
  int signs = 0;
  for (int i = 0; i < 3; ++i) {
    const std::int16_t* code = part.tangent + 2 * std::size_t(v[i]);
    if (code[0] == no_vertex_normal) return out;
    const Vec3d local = decode_vertex_normal(code), scene = Vec3d::by_axis([&](int r) {
                                                      const double* m = part.scene_from_local + 4 * r;
                                                      return dot(Vec3d{m[0], m[1], m[2]}, local);
                                                    });
    if (!set_unit(scene * turn, out.vertex[i])) return out;
    signs += has_mirrored_bitangent(code) ? -1 : 1;
  }
  out.bitangent = std::int8_t((signs < 0 ? -1 : 1) * (mirror * turn < 0 ? -1 : 1));
  return out;
}

/// Returns the tangents of a triangle that follow from its texture coordinates. The result has no tangents if the
/// triangle has no area on the texture.
GB_HD TriangleTangents tangents_of_uv(const PartArrays& part, const std::uint32_t v[3], const float uv[6]) {
  constexpr double min_area = 1e-12;  // below it, the area is mostly rounding error of the coordinates
  TriangleTangents out{};
  const double s1 = double(uv[2]) - uv[0], s2 = double(uv[4]) - uv[0], t1 = double(uv[3]) - uv[1],
               t2 = double(uv[5]) - uv[1];
  const double area = s1 * t2 - s2 * t1;
  if (!(std::fabs(area) > min_area * (std::fabs(s1 * t2) + std::fabs(s2 * t1)))) return out;
  const Vec3d along_s =
      (scene_edge(part, v[0], v[1]) * t2 - scene_edge(part, v[0], v[2]) * t1) * (area < 0 ? -1.0 : 1.0);
  if (!set_unit(along_s, out.vertex[0])) return out;
  out.vertex[1] = out.vertex[2] = out.vertex[0];
  // t grows downwards on the image: a triangle seen from outside has a negative area there, unless it is mirrored.
  out.bitangent = area < 0 ? 1 : -1;
  return out;
}

/// Returns the normal map of a triangle. `side` is the result of load_vertex_normals(), or 1 without vertex normals.
GB_HD TriangleMap triangle_map(const PartArrays& part, const TextureView* textures, std::uint32_t triangle,
                               const TrianglePlane& plane, double side) {
  TriangleMap out{};
  if (part.normal_map.texture < 0) return out;
  std::uint32_t v[3];
  triangle_vertices(part, triangle, v);
  float uv[6];
  if (!load_uv(part.normal_uv, v, uv)) return out;
  if (part.tangent != nullptr) out.tangents = stored_tangents(part, v, side);
  if (out.tangents.bitangent == 0) out.tangents = tangents_of_uv(part, v, uv);
  if (out.tangents.bitangent == 0) return out;
  const TextureView* texture = textures + part.normal_map.texture;
  out.texture = texture;
  out.view = part.normal_map;
  out.map = make_texture_map(plane, uv, texture->width, texture->height);
  return out;
}

/// Min length of the mean of a map over a fragment. A shorter mean has no reliable direction: the map is then not used.
inline constexpr double min_mapped_length = 1.0 / 16;

/// Returns the direction of the mapped normal. `smooth` is the unit normal before the map, `tangent` is not parallel to
/// it, and `texel` is the mean of the map.
GB_HD Vec3d in_tangent_frame(const Vec3d& smooth, const Vec3d& tangent, const TriangleMap& m, const Vec3d& texel) {
  const Vec3d across = cross(smooth, tangent) * double(m.tangents.bitangent);
  return (tangent * (texel[0] * m.view.scale) + across * (texel[1] * m.view.scale)) + smooth * texel[2];
}

/// Returns the shading normal of a fragment with normal map. `smooth` is the fragment's shading normal without the map:
/// mean_normal() or the triangle's normal `geometric`. The result is shorter than `smooth` where directions in the map
/// differ over the fragment.
/// Range   m.texture is not null.
GB_HD Vec3<std::int16_t> mapped_normal(const TriangleMap& m, const Vec3<std::int16_t>& smooth,
                                       const Vec3<std::int16_t>& geometric, const TrianglePlane& plane,
                                       const FragmentShape& f, const Tables& tables) {
  constexpr double minimum = 1.0 / 1024, unit = 32767;
  const Vec3d texel = normal_map_over(*m.texture, m.view, m.map, f, tables),
              n = static_cast<Vec3d>(smooth) * (1 / unit);
  const double squared = dot(texel, texel), smooth_squared = dot(n, n);
  if (!(squared >= min_mapped_length * min_mapped_length && smooth_squared > minimum)) return smooth;
  const double smooth_length = std::sqrt(smooth_squared);
  const Vec3d unit_n = n * (1 / smooth_length);
  const Barycentric w = barycentric(plane, f.centroid);
  const Vec3<std::int16_t>* t = m.tangents.vertex;
  const Vec3d along =
                  ((static_cast<Vec3d>(t[0]) * w.a + static_cast<Vec3d>(t[1]) * w.b) + static_cast<Vec3d>(t[2]) * w.c) *
                  (1 / unit),
              tangent = along - unit_n * dot(unit_n, along);
  const double tangent_squared = dot(tangent, tangent);
  if (!(tangent_squared > minimum)) return smooth;
  const Vec3d direction = in_tangent_frame(unit_n, tangent * (1 / std::sqrt(tangent_squared)), m, texel);
  const Vec3<std::int16_t> turned = turned_toward(direction, geometric);
  const double length = smooth_length * (squared < 1 ? std::sqrt(squared) : 1.0);
  return Vec3<std::int16_t>::by_axis(
      [&](int c) { return std::int16_t(floor_to_int32(turned[c] * smaller(length, 1.0) + 0.5)); });
}

}  // namespace gigabake::kernels
