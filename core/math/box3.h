/// Half-open boxes along the axes, for host and device.
#pragma once

#include "core/math/vec3.h"

namespace gigabake {

/// A box of the points p with min ≤ p < end along each axis. The default box is empty.
template <class T>
struct Box3 {
  Vec3<T> min{}, end{};

  GB_HD static constexpr Box3 cube(const Vec3<T>& min, T edge) { return {min, min + Vec3<T>::all(edge)}; }

  GB_HD constexpr bool is_empty() const { return min.v[0] >= end.v[0] || min.v[1] >= end.v[1] || min.v[2] >= end.v[2]; }
  GB_HD constexpr Vec3<T> size() const { return end - min; }
  GB_HD constexpr bool contains(const Vec3<T>& p) const {
    return p.v[0] >= min.v[0] && p.v[0] < end.v[0] && p.v[1] >= min.v[1] && p.v[1] < end.v[1] && p.v[2] >= min.v[2] &&
           p.v[2] < end.v[2];
  }
  /// Returns whether the intervals of both boxes overlap along each axis.
  /// Range   Neither box is empty.
  GB_HD constexpr bool overlaps(const Box3& b) const {
    return min.v[0] < b.end.v[0] && b.min.v[0] < end.v[0] && min.v[1] < b.end.v[1] && b.min.v[1] < end.v[1] &&
           min.v[2] < b.end.v[2] && b.min.v[2] < end.v[2];
  }
  friend constexpr bool operator==(const Box3&, const Box3&) = default;

  /// Returns the smallest box that contains both boxes. An empty box contributes nothing.
  friend GB_HD constexpr Box3 hull(const Box3& a, const Box3& b) {
    if (a.is_empty()) return b;
    if (b.is_empty()) return a;
    return {min_by_axis(a.min, b.min), max_by_axis(a.end, b.end)};
  }
  friend GB_HD constexpr Box3 intersection(const Box3& a, const Box3& b) {
    return {max_by_axis(a.min, b.min), min_by_axis(a.end, b.end)};
  }
};

using Box3i64 = Box3<std::int64_t>;

}  // namespace gigabake
