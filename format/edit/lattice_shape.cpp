#include "format/edit/lattice_shape.h"

#include <algorithm>

#include "core/math/box3.h"

namespace gigabake {
namespace {

using Wide = __int128;

LatticeBox around(const LatticeBox& s) { return s; }
LatticeBox around(const LatticeSphere& s) {
  const Vec3i64 r = Vec3i64::all(s.radius);
  return {s.centre - r, s.centre + r};
}
LatticeBox around(const LatticeCylinder& s) {
  const Vec3i64 r = Vec3i64::all(s.radius), top = s.base + s.axis;
  return {min_by_axis(s.base, top) - r, max_by_axis(s.base, top) + r};
}
LatticeBox around(const LatticePrism& s) {
  const FixedBox& b = s.polygon.bounds();
  return {{b.low.x, b.low.y, s.low}, {b.high.x, b.high.y, s.high}};
}

LatticeBox around(const LatticeMesh& s) { return {s.low(), s.high()}; }

bool has(const LatticeBox& s, const Vec3i64& p) { return Box3i64{s.low, s.high}.contains(p); }
bool has(const LatticeSphere& s, const Vec3i64& p) {
  const Vec3i64 v = p - s.centre;
  return dot(v, v) <= s.radius * s.radius;
}
/// Returns whether the squared distance of `v` from the line through 0 along `axis` is at most the square of `radius`.
bool is_near_axis(const Vec3i64& v, const Vec3i64& axis, std::int64_t radius) {
  const std::int64_t along = dot(v, axis), squared = dot(axis, axis);
  return Wide(dot(v, v)) * squared - Wide(along) * along <= Wide(radius) * radius * squared;
}
bool has(const LatticeCylinder& s, const Vec3i64& p) {
  const Vec3i64 v = p - s.base;
  const std::int64_t along = dot(v, s.axis);
  return along >= 0 && along < dot(s.axis, s.axis) && is_near_axis(v, s.axis, s.radius);
}
bool has(const LatticePrism& s, const Vec3i64& p) {
  return p[2] >= s.low && p[2] < s.high && s.polygon.contains({p[0], p[1]});
}

bool has(const LatticeMesh& s, const Vec3i64& p) { return s.contains(p); }

Vec3i64 corner_of(const LatticeBox& box, int corner) {
  return {(corner & 1) != 0 ? box.high[0] : box.low[0], (corner & 2) != 0 ? box.high[1] : box.low[1],
          (corner & 4) != 0 ? box.high[2] : box.low[2]};
}

/// Returns whether a convex shape contains the box, which then contains all its corners.
template <class Shape>
bool has_corners(const Shape& s, const LatticeBox& box) {
  for (int corner = 0; corner < 8; ++corner)
    if (!has(s, corner_of(box, corner))) return false;
  return true;
}

bool is_outside(const LatticeBox&, const LatticeBox&) { return false; }
bool is_outside(const LatticeSphere& s, const LatticeBox& box) {
  return !has(s, max_by_axis(box.low, min_by_axis(s.centre, box.high)));
}
bool is_outside(const LatticeCylinder& s, const LatticeBox& box) {
  const std::int64_t squared = dot(s.axis, s.axis);
  std::int64_t min_along = squared, max_along = -1;
  for (int corner = 0; corner < 8; ++corner) {
    const std::int64_t along = dot(corner_of(box, corner) - s.base, s.axis);
    min_along = std::min(min_along, along), max_along = std::max(max_along, along);
  }
  if (max_along < 0 || min_along >= squared) return true;
  // The sum of half edges bounds the half diagonal; 2 is for the rounded middle.
  const Vec3i64 half = (box.high - box.low) >> 1;
  const std::int64_t reach = half[0] + half[1] + half[2] + 2;
  return !is_near_axis(box.low + half - s.base, s.axis, s.radius + reach);
}

AreaOverlap classified(const LatticePrism& s, const LatticeBox& box) {
  const AreaOverlap in_plane = s.polygon.overlap({{box.low[0], box.low[1]}, {box.high[0], box.high[1]}});
  const bool is_between = box.low[2] >= s.low && box.high[2] < s.high;
  return in_plane == AreaOverlap::inside && !is_between ? AreaOverlap::border : in_plane;
}
AreaOverlap classified(const LatticeMesh& s, const LatticeBox& box) { return s.overlap(box.low, box.high); }
template <class Shape>
AreaOverlap classified(const Shape& s, const LatticeBox& box) {
  if (is_outside(s, box)) return AreaOverlap::outside;
  return has_corners(s, box) ? AreaOverlap::inside : AreaOverlap::border;
}

bool are_apart(const LatticeBox& a, const LatticeBox& b) {
  for (std::size_t c = 0; c < 3; ++c)
    if (a.high[c] < b.low[c] || b.high[c] < a.low[c]) return true;
  return false;
}

}  // namespace

LatticeBox bounds_of(const LatticeShape& shape) {
  return std::visit([](const auto& s) { return around(s); }, shape);
}

bool contains(const LatticeShape& shape, const Vec3i64& p) {
  return std::visit([&](const auto& s) { return has(s, p); }, shape);
}

AreaOverlap overlap(const LatticeShape& shape, const LatticeBox& box) {
  if (are_apart(bounds_of(shape), box)) return AreaOverlap::outside;
  return std::visit([&](const auto& s) { return classified(s, box); }, shape);
}

}  // namespace gigabake
