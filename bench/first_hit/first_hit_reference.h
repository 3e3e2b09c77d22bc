/// A reference for first hits that steps from voxel to voxel in double precision, without tree and tables.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "query/first_hit/first_hit.h"

namespace gigabake::bench {

/// A ray in voxels of the tree, relative to its lowest corner.
struct ReferenceRay {
  std::array<double, 3> origin, direction;
  double end;  ///< in lengths of `direction`
};

inline ReferenceRay reference_ray(const kernels::FirstHitRay& ray, const kernels::FirstHitTree& tree) {
  const double voxels = double(1 << tree.bits), scale = voxels * tree.per_edge;
  ReferenceRay r{};
  for (std::size_t a = 0; a < 3; ++a) {
    r.origin[a] = (ray.origin[a] - tree.centre[a]) * scale + voxels / 2;
    r.direction[a] = ray.direction[a];
  }
  r.end = double(ray.end) * scale;
  return r;
}

/// The interval of a ray inside a box.
struct Chord {
  double enter, leave;
  bool empty() const { return !(enter <= leave); }
};

inline Chord chord(const ReferenceRay& ray, const std::array<double, 3>& low, const std::array<double, 3>& high) {
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

using Voxel = std::array<std::int64_t, 3>;

/// Returns the chord of a voxel whose cube is expanded by `rim` on all sides.
inline Chord chord(const ReferenceRay& ray, const Voxel& v, double rim) {
  std::array<double, 3> low{}, high{};
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = double(v[a]) - rim;
    high[a] = double(v[a]) + 1 + rim;
  }
  return chord(ray, low, high);
}

/// Calls visit(voxel, distance) for every voxel of the cube [0, edge)³ along the ray, until it returns true.
template <class Visit>
void step_through(const ReferenceRay& ray, std::int64_t edge, const Visit& visit) {
  const Chord inside = chord(ray, {0, 0, 0}, {double(edge), double(edge), double(edge)});
  if (inside.empty()) return;
  Voxel v{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double at = ray.origin[a] + ray.direction[a] * inside.enter;
    v[a] = std::int64_t(std::floor(at));
    if (ray.direction[a] < 0 && at == std::floor(at)) --v[a];
    v[a] = std::min(std::max(v[a], std::int64_t(0)), edge - 1);
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
  Voxel found{};
  for (std::size_t a = 0; a < 3; ++a) found[a] = std::int64_t(hit.voxel >> 21 * a & 0x1fffff);
  if (met) {
    const Chord wide = chord(ray, found, rounding);
    if (!exists(found) || wide.empty()) return Agreement::wrong;
    bool near_face = distance <= blur;
    for (std::size_t a = 0; a < 3; ++a) {
      const double at = ray.origin[a] + ray.direction[a] * distance - double(found[a]);
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
