/// What a triangle contributes to one slab of a brick, in a form that fragments share, and each fragment's answer.
#pragma once

#include <cstdint>
#include <type_traits>

#include "kernels/accumulate.h"
#include "kernels/coverage.h"
#include "kernels/cuda_input.cuh"
#include "kernels/surface.h"
#include "kernels/triangle_bricks.h"

namespace gigabake::kernels {

/// Vertices of the triangle's plane, in sub-voxels: exact, and for narrow triangles half as long as in double.
template <bool is_hard>
using PlaneCoordinate = std::conditional_t<is_hard, double, std::int32_t>;

/// An item, ready to be measured.
template <bool is_hard>
struct CutItem {
  double u[5], v[5], slope[5];  ///< the slab's polygon
  double inverse_twice_area, area_scale;
  PlaneCoordinate<is_hard> plane_u[3], plane_v[3];
  std::uint64_t cells;
  std::int32_t anchor_u, anchor_v;
  std::uint32_t part;
  std::int16_t normal[3];
  std::uint16_t vertex_rgba[3][4];
  std::uint8_t corners, axis, slab, brick;
};

template <bool is_hard, bool textured>
struct FillItem : CutItem<is_hard> {};
template <bool is_hard>
struct FillItem<is_hard, true> : CutItem<is_hard> {
  TextureMap map;
};

template <bool is_hard, bool textured>
__device__ void read_attributes(const InputView& in, const DevicePart& part, std::uint32_t index,
                                const TrianglePlane& plane, FillItem<is_hard, textured>& out) {
  if (part.rgba == nullptr && !textured) return;
  std::uint32_t v[3];
  vertices_of(part, index, v);
  if (part.rgba != nullptr)
    for (int i = 0; i < 3; ++i)
      for (int c = 0; c < 4; ++c) out.vertex_rgba[i][c] = part.rgba[4 * std::size_t(v[i]) + c];
  if constexpr (textured) {
    if (!part.textured) return;
    float uv[6];
    for (int i = 0; i < 6; ++i) uv[i] = part.uv[2 * std::size_t(v[i / 2]) + i % 2];
    if (!usable_uv(uv))
      for (float& x : uv) x = 0;
    const TextureView& texture = in.textures[in.materials[part.material].texture];
    out.map = make_texture_map(plane, uv, texture.width, texture.height);
  }
}

template <class I, bool is_hard>
__device__ TrianglePlane plane_in(const WindowTriangle& w, const std::int32_t corner[3], CutItem<is_hard>& out) {
  const BrickTriangle<I> t = make_brick_triangle<I>(w, corner);
  geometric_normal(t, out.normal);
  return make_plane(t);
}

template <bool is_hard>
__device__ TrianglePlane plane_of(const WindowTriangle& w, const std::int32_t corner[3], CutItem<is_hard>& out) {
  if constexpr (is_hard)
    if (!is_narrow(w)) return plane_in<__int128>(w, corner, out);
  return plane_in<std::int64_t>(w, corner, out);
}

template <bool is_hard>
__device__ void cut_polygon(const TrianglePlane& plane, double slab, CutItem<is_hard>& out) {
  int corners = 0;
  cut_slab(plane, slab, [&](double u, double v) {
    out.u[corners] = u;
    out.v[corners] = v;
    ++corners;
  });
  out.corners = std::uint8_t(corners);
#pragma unroll
  for (int e = 0; e < 5; ++e) {  // all five by all lanes: a loop of as many as there are corners would part them
    const int f = e + 1 >= corners ? 0 : e + 1;
    const double dv = out.v[f] - out.v[e];
    out.slope[e] = dv != 0 ? (out.u[f] - out.u[e]) / dv : 0;  // as edge_slope()
  }
}

/// Cuts an item from the triangle of a pair. corner: the brick's; where: as in ItemView.
template <bool is_hard, bool textured>
__device__ void cut_item(const InputView& in, const WindowTriangle& w, const std::int32_t corner[3],
                         std::uint32_t where, FillItem<is_hard, textured>& out) {
  const TrianglePlane plane = plane_of(w, corner, static_cast<CutItem<is_hard>&>(out));
  out.axis = std::uint8_t(where >> 3 & 3);
  out.slab = std::uint8_t(where & 7);
  out.part = w.part;
  out.anchor_u = std::int32_t(plane.anchor[0]);
  out.anchor_v = std::int32_t(plane.anchor[1]);
  out.inverse_twice_area = plane.inverse_twice_area;
  out.area_scale = plane.area_scale;
  for (int c = 0; c < 3; ++c) {
    out.plane_u[c] = PlaneCoordinate<is_hard>(plane.u[c] * double(subvoxels));
    out.plane_v[c] = PlaneCoordinate<is_hard>(plane.v[c] * double(subvoxels));
  }
  cut_polygon(plane, double(std::int64_t(where & 7) - plane.anchor[2]), static_cast<CutItem<is_hard>&>(out));
  read_attributes(in, in.parts[w.part], w.index, plane, out);
}

/// Area and moments of a cell, edge after edge as kernels/cell_lanes.h does them. Edges beside the cell's range of v
/// add nothing but zeros; lanes skip their own, so that a warp makes as many steps as its busiest lane.
template <bool with_moments, bool is_hard>
__device__ CellMoments measure(const CutItem<is_hard>& item, double u, double v) {
  unsigned edges = 0;
  for (int e = 0; e < item.corners; ++e) {
    const int f = e + 1 == item.corners ? 0 : e + 1;
    if (clamp01(item.v[e] - v) != clamp01(item.v[f] - v)) edges |= 1u << e;
  }
  CellMoments m{0, 0, 0};
  for (; edges != 0; edges &= edges - 1) {
    const int e = __ffs(int(edges)) - 1, f = e + 1 == item.corners ? 0 : e + 1;
    add_edge<with_moments>(item.u[e] - u, item.v[e] - v, item.u[f] - u, item.v[f] - v, item.slope[e], m);
  }
  return m;
}

template <bool is_hard, bool textured>
__device__ Surface surface_of(const InputView& in, const FillItem<is_hard, textured>& item) {
  const DevicePart& part = in.parts[item.part];
  Surface s;
  s.material = in.materials[part.material];
  s.has_vertex_rgba = part.rgba != nullptr;
  for (int i = 0; i < 3; ++i) {
    s.normal[i] = item.normal[i];
    for (int c = 0; c < 4; ++c) s.vertex_rgba[i][c] = item.vertex_rgba[i][c];
  }
  s.texture = nullptr;
  if constexpr (textured) {
    if (part.textured) {
      s.texture = &in.textures[s.material.texture];
      s.map = item.map;
    }
  }
  if (s.texture == nullptr) s.material.texture = -1;
  return s;
}

template <bool is_hard, bool textured>
__device__ Fragment fragment_of(const InputView& in, const FillItem<is_hard, textured>& item, int cell) {
  const double u = double((cell & 7) - item.anchor_u), v = double((cell >> 3) - item.anchor_v);
  const Surface surface = surface_of(in, item);
  TrianglePlane plane;
  for (int c = 0; c < 3; ++c) {
    plane.u[c] = double(item.plane_u[c]) / double(subvoxels);
    plane.v[c] = double(item.plane_v[c]) / double(subvoxels);
  }
  plane.inverse_twice_area = item.inverse_twice_area;
  if (!surface.varies())
    return make_fragment(surface, shade(surface, plane, {0, 0}, 0, in.tables),
                         weight_of(measure<false>(item, u, v).area, item.area_scale));
  const CellMoments m = measure<true>(item, u, v);
  return make_fragment(surface, shade(surface, plane, fragment_centroid(plane, m, u, v), m.area, in.tables),
                       weight_of(m.area, item.area_scale));
}

}  // namespace gigabake::kernels
