#include "worker/position_spacing.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gigabake {

double position_spacing_m(const Primitive& primitive, const Instance& instance, const LocalReach& reach) {
  const auto& m = instance.scene_from_local.m;
  double largest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double step = primitive.position_step > 0
                            ? double(primitive.position_step)
                            : double(std::nextafter(reach[axis], std::numeric_limits<float>::infinity())) - reach[axis];
    largest = std::max(largest, step * std::hypot(m[0][axis], m[1][axis], m[2][axis]));
  }
  return largest;
}

}  // namespace gigabake
