/// Contribution of a triangle to one slab of a brick: the data that the slab's fragments share, and the contribution of
/// each fragment.
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/math/rounding.h"
#include "core/math/vec3.h"
#include "core/octree/brick.h"
#include "kernels/body/voxelize/accumulate.h"
#include "kernels/body/voxelize/coverage.h"
#include "kernels/body/voxelize/normal_maps.h"
#include "kernels/body/voxelize/part.h"
#include "kernels/body/voxelize/plane_offset.h"
#include "kernels/body/voxelize/surface.h"
#include "kernels/body/voxelize/triangle_bricks.h"
#include "kernels/body/voxelize/vertex_normals.h"
#include "kernels/cuda/device/input.cuh"

namespace gigabake::kernels {

/// Type of the vertices of the triangle's plane, in sub-voxels. Both types are exact; int32, for narrow triangles, is
/// half as large.
template <bool is_hard>
using PlaneCoordinate = std::conditional_t<is_hard, double, std::int32_t>;

/// An item whose polygon is cut, so that the areas and moments of its cells can be measured.
struct CutItem {
  double u[5], v[5];  ///< the slab's polygon
  Line line[4];
  double weight_scale;
  PlaneOffset offset;
  std::uint64_t cells;
  std::uint64_t edges_of_row;  ///< one byte per row v of the brick: the polygon's edges that reach into it
  std::int32_t anchor_u, anchor_v;
  Vec3<std::int16_t> normal;
  std::uint16_t edge_lines;  ///< SlabPolygon::line, two bits each
  std::uint8_t corners, axis, slab, brick;
  ShadingRate look;  ///< is flat only if all_visible(materials)
};

/// Vertices of a triangle in its plane, from which plane_of() restores the plane.
template <bool is_hard>
struct TrianglePoints {
  PlaneCoordinate<is_hard> u[3], v[3];
  double inverse_twice_area;
};

/// Data that only textured fragments need.
template <bool is_hard>
struct TexturedLook {
  TrianglePoints<is_hard> points;
  TextureMap map;
  const TextureView* texture;
  MaterialView material;
};

/// Data that shade() needs for any material, textured or not.
template <bool is_hard>
struct VaryingLook : TexturedLook<is_hard> {
  std::uint16_t vertex_rgba[3][4];
  bool has_vertex_rgba;
};

/// Vertices and vertex normals of a triangle, in cells with vertex normals. A triangle without
/// them has its geometric normal at each vertex.
template <bool is_hard>
struct SmoothLook {
  TrianglePoints<is_hard> points;
  Vec3<std::int16_t> vertex_normal[3];
};

/// SmoothLook in cells with normal maps.
template <bool is_hard>
struct MappedLook : SmoothLook<is_hard> {
  TriangleMap normal_map;
};

/// Base of items in cells without vertex normals.
struct FlatLook {};

template <bool is_hard, CellMaterials materials>
using NormalLook = std::conditional_t<has_normal_maps(materials), MappedLook<is_hard>,
                                      std::conditional_t<has_vertex_normals(materials), SmoothLook<is_hard>, FlatLook>>;

template <bool is_hard, CellMaterials materials>
struct SlabFragment : CutItem, NormalLook<is_hard, materials> {
  using Varying = std::conditional_t<all_visible(materials), TexturedLook<is_hard>, VaryingLook<is_hard>>;
  union {
    LinearColour colour;  ///< if look is flat, only `low` is set
    Varying varying;
  };
};
template <bool is_hard>
struct SlabFragment<is_hard, CellMaterials::plain> : CutItem {
  LinearColour colour;
};

template <bool is_hard>
__device__ TrianglePoints<is_hard> points_of(const TrianglePlane& plane) {
  TrianglePoints<is_hard> points;
  for (int c = 0; c < 3; ++c) {
    points.u[c] = PlaneCoordinate<is_hard>(plane.u[c] * double(subvoxels));
    points.v[c] = PlaneCoordinate<is_hard>(plane.v[c] * double(subvoxels));
  }
  points.inverse_twice_area = plane.inverse_twice_area;
  return points;
}

/// Sets vertices and texture of a triangle whose fragments are shaded individually.
template <bool is_hard>
__device__ void set_varying(const Surface& surface, const TrianglePlane& plane, TexturedLook<is_hard>& out) {
  out.points = points_of<is_hard>(plane);
  out.material = surface.material;
  out.texture = surface.texture;
}

template <bool is_hard, CellMaterials materials>
__device__ void set_look(const InputView& in, const WindowTriangle& w, const TrianglePlane& plane,
                         SlabFragment<is_hard, materials>& out) {
  const DevicePart& part = in.parts[w.part];
  Surface surface = surface_of(part, in.materials, in.textures);
  if (surface.has_vertex_rgba) load_vertex_rgba(part, w.index, surface.vertex_rgba);
  out.look = surface.look();
  if (out.look == ShadingRate::linear) {
    out.colour = make_linear_colour(surface, plane);
  } else if (all_visible(materials) && (materials == CellMaterials::plain || out.look == ShadingRate::flat)) {
    for (int c = 0; c < 3; ++c) out.colour.low[c] = surface.material.base_rgba[c];
  } else if constexpr (materials != CellMaterials::plain) {
    out.look = ShadingRate::varying;
    set_varying(surface, plane, out.varying);
    if (surface.texture != nullptr) out.varying.map = texture_map(part, w.index, plane, *surface.texture);
    if constexpr (!all_visible(materials)) {
      out.varying.has_vertex_rgba = surface.has_vertex_rgba;
      if (surface.has_vertex_rgba)
        for (int c = 0; c < 3; ++c)
          for (int k = 0; k < 4; ++k) out.varying.vertex_rgba[c][k] = surface.vertex_rgba[c][k];
    }
  }
}

/// Returns a word whose byte r is 1 for the rows r in [first, last] of the brick.
__device__ inline std::uint64_t row_bytes(int first, int last) {
  first = larger(first, 0);
  last = smaller(last, brick_edge - 1);
  return first > last ? 0 : 0x0101010101010101ull << 8 * first & 0x0101010101010101ull >> 8 * (brick_edge - 1 - last);
}

__device__ inline void cut_polygon(const TrianglePlane& plane, double slab, CutItem& out) {
  int corners = 0;
  unsigned lines = 0;
  cut_slab(plane, slab, [&](double u, double v, int line) {
    out.u[corners] = u;
    out.v[corners] = v;
    lines |= unsigned(line) << 2 * corners;
    ++corners;
  });
  out.corners = std::uint8_t(corners);
  out.edge_lines = std::uint16_t(lines);
  int row[5];  // row of each corner
#pragma unroll
  for (int e = 0; e < 5; ++e) row[e] = floor_to_int32(out.v[e]) + out.anchor_v;
  std::uint64_t edges = 0;
#pragma unroll
  for (int e = 0; e < 5; ++e) {  // all lanes iterate over all five: a loop over `corners` would diverge
    const bool is_last = e + 1 >= corners;
    const int next = is_last ? row[0] : row[(e + 1) % 5];
    if (e < corners && out.v[e] != (is_last ? out.v[0] : out.v[(e + 1) % 5]))
      edges |= row_bytes(smaller(row[e], next), larger(row[e], next)) << e;
  }
  out.edges_of_row = edges;
}

/// Sets the vertices and their normals. Returns the result of load_vertex_normals(), or 1 without vertex normals.
template <bool is_hard>
__device__ double set_smooth(const DevicePart& part, std::uint32_t triangle, const TrianglePlane& plane,
                             const Vec3<std::int16_t>& normal, SmoothLook<is_hard>& out) {
  out.points = points_of<is_hard>(plane);
  for (Vec3<std::int16_t>& n : out.vertex_normal) n = normal;
  return part.normal != nullptr ? load_vertex_normals(part, triangle, normal, out.vertex_normal) : 1;
}

template <class I, class N, bool is_hard, CellMaterials materials>
__device__ void cut_triangle(const InputView& in, const WindowTriangle& w, const Vec3<std::int32_t>& corner,
                             std::uint32_t where, SlabFragment<is_hard, materials>& out) {
  const BrickTriangle<I, N> t = make_brick_triangle<I, N>(w, corner);
  out.normal = triangle_normal(in.parts[w.part], w.index, t);
  const TrianglePlane plane = make_plane(t);
  for (int i = 0; i < 4; ++i) out.line[i] = plane.line[i];
  out.anchor_u = std::int32_t(plane.anchor[0]);
  out.anchor_v = std::int32_t(plane.anchor[1]);
  out.weight_scale = plane.weight_scale;
  const double slab = double(std::int64_t(where & 7) - plane.anchor[2]);
  out.offset = make_plane_offset(plane, out.normal, out.axis, slab);
  cut_polygon(plane, slab, out);
  set_look(in, w, plane, out);
  if constexpr (has_vertex_normals(materials)) {
    const DevicePart& part = in.parts[w.part];
    const double side = set_smooth<is_hard>(part, w.index, plane, out.normal, out);
    if constexpr (has_normal_maps(materials)) out.normal_map = triangle_map(part, in.textures, w.index, plane, side);
  }
}

/// Cuts an item from the triangle of a pair. `corner` is the brick's lowest corner, and `where` is an element of
/// ItemView::where.
template <bool is_hard, CellMaterials materials>
__device__ void cut_item(const InputView& in, const WindowTriangle& w, const Vec3<std::int32_t>& corner,
                         std::uint32_t where, SlabFragment<is_hard, materials>& out) {
  out.axis = std::uint8_t(where >> 3 & 3);
  out.slab = std::uint8_t(where & 7);
  if constexpr (is_hard)
    if (!is_narrow(w)) return cut_triangle<__int128, __int128>(in, w, corner, where, out);
  cut_triangle<std::int32_t, double>(in, w, corner, where, out);
}

/// Returns area and moments of the cell in `row` of the brick, summed over the edges in the same order as
/// kernels/cpu/voxelize/cell_lanes.h. Skips edges that do not reach into the row, because they would add only zeros.
template <Moments wanted>
__device__ CellMoments measure(const CutItem& item, double u, double v, int row) {
  CellMoments m{};
  for (unsigned edges = unsigned(item.edges_of_row >> 8 * row) & 31; edges != 0; edges &= edges - 1) {
    const int e = __ffs(int(edges)) - 1, f = e + 1 == item.corners ? 0 : e + 1;
    add_edge<wanted>(item.u[e] - u, item.v[e] - v, item.v[f] - v, item.line[item.edge_lines >> 2 * e & 3], m);
  }
  return m;
}

template <bool is_hard>
__device__ TrianglePlane plane_of(const TrianglePoints<is_hard>& points) {
  TrianglePlane plane;
  for (int c = 0; c < 3; ++c) {
    plane.u[c] = double(points.u[c]) / double(subvoxels);
    plane.v[c] = double(points.v[c]) / double(subvoxels);
  }
  plane.inverse_twice_area = points.inverse_twice_area;
  return plane;
}

/// Shades an item of an opaque textured material without vertex colours.
template <bool is_hard>
__device__ Rgba16 shade_item(const Tables& tables, const CutItem& item, const TexturedLook<is_hard>& look,
                             const CellMoments& m, double u, double v) {
  return shade_textured<true>(*look.texture, look.material, look.map, base_factor(look.material),
                              fragment_shape(plane_of(look.points), m, u, v, item.u, item.v, item.corners), tables);
}

template <bool is_hard>
__device__ Rgba16 shade_item(const Tables& tables, const CutItem& item, const VaryingLook<is_hard>& look,
                             const CellMoments& m, double u, double v) {
  Surface s;
  s.material = look.material;
  s.has_vertex_rgba = look.has_vertex_rgba;
  if (look.has_vertex_rgba)
    for (int i = 0; i < 3; ++i)
      for (int c = 0; c < 4; ++c) s.vertex_rgba[i][c] = look.vertex_rgba[i][c];
  s.texture = look.texture;
  if (look.texture != nullptr) s.map = look.map;
  if (s.look() == ShadingRate::flat) return shade<false>(s, {}, {}, tables);
  const TrianglePlane plane = plane_of(look.points);
  return shade<false>(s, plane, fragment_shape(plane, m, u, v, item.u, item.v, item.corners), tables);
}

/// Returns the normal of a fragment. `m` includes first moments, and second moments if the cell has normal maps.
template <bool is_hard, CellMaterials materials>
__device__ Vec3<std::int16_t> normal_of(const Tables& tables, const SlabFragment<is_hard, materials>& item,
                                        const CellMoments& m, double u, double v) {
  if constexpr (has_vertex_normals(materials)) {
    const TrianglePlane plane = plane_of(item.SmoothLook<is_hard>::points);
    const Vec3<std::int16_t> smooth = mean_normal(item.vertex_normal, plane, m, u, v);
    if constexpr (has_normal_maps(materials))
      if (item.normal_map.texture != nullptr)
        return mapped_normal(item.normal_map, smooth, item.normal, plane,
                             fragment_shape(plane, m, u, v, item.u, item.v, item.corners), tables);
    return smooth;
  } else {
    return item.normal;
  }
}

template <bool is_hard, CellMaterials materials>
__device__ Fragment fragment_of(const Tables& tables, const SlabFragment<is_hard, materials>& item, int cell) {
  const double u = double((cell & 7) - item.anchor_u), v = double((cell >> 3) - item.anchor_v);
  constexpr Moments wanted = materials == CellMaterials::plain ? Moments::first : Moments::second;
  const CellMoments m = measure<wanted>(item, u, v, cell >> 3);
  if (item.look == ShadingRate::linear)
    return linear_fragment(item.colour, u, v, m, item.weight_scale, normal_of(tables, item, m, u, v),
                           offset_in(item.offset, u, v));
  Rgba16 rgba;
  if (materials == CellMaterials::plain || item.look == ShadingRate::flat)
    rgba = opaque_colour({{item.colour.low[0], item.colour.low[1], item.colour.low[2], 0}});
  else if constexpr (materials != CellMaterials::plain)
    rgba = shade_item(tables, item, item.varying, m, u, v);
  return fragment_of_colour(weight_of(m.area, item.weight_scale), rgba.c, normal_of(tables, item, m, u, v),
                            offset_in(item.offset, u, v));
}

}  // namespace gigabake::kernels
