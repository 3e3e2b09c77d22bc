#include "worker/scan/instance_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/octree/brick.h"

namespace gigabake {

LocalBounds bounds_of(const Primitive& primitive) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  LocalBounds b{Vec3d::all(infinite), Vec3d::all(-infinite)};
  for (std::size_t i = 0; i + 2 < primitive.position.size(); i += 3)
    for (std::size_t c = 0; c < 3; ++c) {
      const double x = primitive.position[i + c];
      if (!std::isfinite(x)) continue;
      b.low[c] = std::min(b.low[c], x);
      b.high[c] = std::max(b.high[c], x);
    }
  return b;
}

SceneBox scene_box(const LocalBounds& bounds, const Instance& instance, const BakeParameters& parameters) {
  SceneBox box;
  const double snapped_m = parameters.voxel_size_m * std::ldexp(1.0, int(parameters.coarsest_lod) - subvoxel_bits);
  if (bounds.low[0] > bounds.high[0] || bounds.low[1] > bounds.high[1] || bounds.low[2] > bounds.high[2]) return box;
  for (std::size_t r = 0; r < 3; ++r) {
    const auto& row = instance.scene_from_local.m[r];
    double low = row[3], high = row[3], terms = std::fabs(row[3]) + std::fabs(parameters.lattice_origin_m[r]);
    for (std::size_t c = 0; c < 3; ++c) {
      const double a = row[c] * bounds.low[c], b = row[c] * bounds.high[c];
      low += std::min(a, b);
      high += std::max(a, b);
      terms += std::max(std::fabs(a), std::fabs(b));
    }
    const double margin_m = parameters.voxel_size_m + snapped_m + 1e-12 * terms;
    box.low_m[r] = low - margin_m;
    box.high_m[r] = high + margin_m;
  }
  return box;
}

bool may_overlap(const SceneBox& box, const BakeParameters& parameters, const Box3i64& cell) {
  if (box.is_empty()) return false;
  for (std::size_t r = 0; r < 3; ++r) {
    const auto plane_m = [&](double voxel) { return parameters.lattice_origin_m[r] + voxel * parameters.voxel_size_m; };
    if (box.high_m[r] < plane_m(double(cell.min[r]))) return false;
    if (box.low_m[r] > plane_m(double(cell.end[r]))) return false;
  }
  return true;
}

}  // namespace gigabake
