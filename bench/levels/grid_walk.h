/// Traversal of the cubes of a grid along a ray.
///
/// Source  Amanatides & Woo 1987.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "bench/levels/sight.h"

namespace gigabake::bench {

/// Calls visit(index, from, to) for the cubes of edge `edge` that the ray crosses between `begin` and `end`, in order.
/// from, to: distances along the ray. Ends when visit returns false.
template <class Visit>
void walk_grid(const SightRay& ray, double edge, double begin, double end, const Visit& visit) {
  BlockIndex cube;
  Vector3 next, step;
  for (std::size_t a = 0; a < 3; ++a) {
    const double d = ray.direction[a], p = ray.origin[a] + d * begin;
    cube[a] = std::int64_t(std::floor(p / edge));
    const bool rises = d > 0;
    step[a] = d == 0 ? std::numeric_limits<double>::infinity() : edge / std::abs(d);
    next[a] = d == 0 ? step[a] : begin + (double(cube[a] + rises) * edge - p) / d;
  }
  for (double from = begin; from < end;) {
    const std::size_t a = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
    const double to = next[a] < end ? next[a] : end;
    if (!visit(cube, from, to)) return;
    from = next[a];
    next[a] += step[a];
    cube[a] += ray.direction[a] > 0 ? 1 : -1;
  }
}

}  // namespace gigabake::bench
