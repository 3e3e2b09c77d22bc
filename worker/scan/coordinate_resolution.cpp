#include "worker/scan/coordinate_resolution.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gigabake {

double coordinate_resolution_m(const Primitive& primitive, const Instance& instance, const CoordinateRange& extent) {
  const auto& m = instance.scene_from_local.m;
  double maximum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double step =
        primitive.position_step > 0
            ? double(primitive.position_step)
            : double(std::nextafter(extent[axis], std::numeric_limits<float>::infinity())) - extent[axis];
    maximum = std::max(maximum, step * std::hypot(m[0][axis], m[1][axis], m[2][axis]));
  }
  return maximum;
}

}  // namespace gigabake
