/// A reference for first hits that steps from voxel to voxel in double precision, without tree and tables.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/math/vec3.h"
#include "query/first_hit/first_hit.h"

namespace gigabake::bench {

/// A ray in voxels of the tree, relative to its lowest corner.
struct ReferenceRay {
  Vec3d origin, direction;
  double end;  ///< in lengths of `direction`
};

inline ReferenceRay reference_ray(const kernels::FirstHitRay& ray, const kernels::FirstHitTree& tree) {
  const double voxels = double(1 << tree.bits), scale = voxels * tree.per_edge;
  const Vec3d from_centre = Vec3d::from(ray.origin) - Vec3d::from(tree.centre);
  return {from_centre * scale + Vec3d::all(voxels / 2), Vec3d::from(ray.direction), double(ray.end) * scale};
}

/// The interval of a ray inside a box.
struct Chord {
  double enter, leave;
  bool empty() const { return !(enter <= leave); }
};

using Voxel = Vec3i64;

inline Chord chord(const ReferenceRay& ray, const Vec3d& low, const Vec3d& high) {
  Chord c{0, ray.end};
  for (std::size_t a = 0; a < 3; ++a) {
    const double o = ray.origin[a], d = ray.direction[a];
    if (d == 0) {
      if (o < low[a] || o > high[a]) return {1, 0};
      continue;
    }
    const double from = ((d > 0 ? low[a] : high[a]) - o) / d, to = ((d > 0 ? high[a] : low[a]) - o) / d;
    c = {std::fmax(c.enter, from), std::fmin(c.leave, to)};
  }
  return c;
}

/// Returns the chord of a voxel whose cube is expanded by `rim` on all sides.
inline Chord chord(const ReferenceRay& ray, const Voxel& v, double rim) {
  const auto low = Vec3d(v);
  return chord(ray, low - Vec3d::all(rim), low + Vec3d::all(1) + Vec3d::all(rim));
}

/// Calls visit(voxel, distance) for every voxel of the cube [0, edge)³ along the ray, until it returns true.
template <class Visit>
void step_through(const ReferenceRay& ray, std::int64_t edge, const Visit& visit) {
  const Chord inside = chord(ray, Vec3d{}, Vec3d::all(double(edge)));
  if (inside.empty()) return;
  const Vec3d at = ray.origin + ray.direction * inside.enter;
  Voxel v{};
  for (std::size_t a = 0; a < 3; ++a) {
    v[a] = std::int64_t(std::floor(at[a]));
    if (ray.direction[a] < 0 && at[a] == std::floor(at[a])) --v[a];
    v[a] = std::clamp(v[a], std::int64_t(0), edge - 1);
  }
  for (double t = inside.enter; !visit(v, t);) {
    std::size_t axis = 0;
    double next[3];
    for (std::size_t a = 0; a < 3; ++a) {
      const double d = ray.direction[a];
      next[a] = d == 0 ? HUGE_VAL : (double(v[a]) + (d > 0 ? 1 : 0) - ray.origin[a]) / d;
      if (next[a] < next[axis]) axis = a;
    }
    t = std::fmax(t, next[axis]);
    v[axis] += ray.direction[axis] > 0 ? 1 : -1;
    if (t > ray.end || v[axis] < 0 || v[axis] >= edge) return;
  }
}

enum class Agreement { same, within_rounding, wrong };

/// Compares a hit with the reference. exists(voxel) returns true if the scene has the voxel. `rounding` is a distance
/// in voxels. A hit whose voxel lies within this distance of the ray is accepted if the ray penetrates no earlier voxel
/// deeper than this distance.
template <class Exists>
Agreement compare(const kernels::FirstHitTree& tree, const kernels::FirstHitRay& lattice_ray,
                  const kernels::FirstHit& hit, double rounding, const Exists& exists) {
  const ReferenceRay ray = reference_ray(lattice_ray, tree);
  const bool met = hit.attributes_index != kernels::no_attributes;
  const double to_voxels = double(1 << tree.bits) * tree.per_edge, distance = double(hit.distance) * to_voxels;
  const double blur = rounding + (met ? distance * 0x1p-23 : 0);  // because a distance is a float
  const auto found = Voxel::by_axis([&](int a) { return std::int64_t(hit.voxel >> 21 * a & 0x1fffff); });
  if (met) {
    const Chord wide = chord(ray, found, rounding);
    if (!exists(found) || wide.empty()) return Agreement::wrong;
    bool near_face = distance <= blur;
    for (const double at : ray.origin + ray.direction * distance - Vec3d(found)) {
      if (at < -2 * blur || at > 1 + 2 * blur) return Agreement::wrong;
      near_face = near_face || std::fabs(at) <= 2 * blur || std::fabs(at - 1) <= 2 * blur;
    }
    if (!near_face) return Agreement::wrong;
  }
  Agreement answer = met ? Agreement::within_rounding : Agreement::same;
  bool passed_any = false;
  step_through(ray, std::int64_t(1) << tree.bits, [&](const Voxel& v, double t) {
    if (met && v == found) {
      answer = passed_any ? Agreement::within_rounding : Agreement::same;
      return true;
    }
    if (met && t > distance + 2 * blur) return true;
    if (!exists(v)) return false;
    passed_any = true;
    answer = Agreement::within_rounding;
    const Chord deep = chord(ray, v, -rounding);
    if (!deep.empty() && deep.enter < deep.leave && (!met || deep.enter < distance - 2 * blur)) {
      answer = Agreement::wrong;
      return true;
    }
    return false;
  });
  return answer;
}

}  // namespace gigabake::bench
