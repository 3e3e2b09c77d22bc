#include "format/shard/octahedral.h"

#include <cmath>

namespace gigabake {

std::array<float, 3> unit_normal(const std::int8_t oct[2]) {
  double x = oct[0] / 127.0, y = oct[1] / 127.0;
  const double z = 1 - std::fabs(x) - std::fabs(y);
  if (z < 0) {
    const double folded = (1 - std::fabs(y)) * (x < 0 ? -1 : 1);
    y = (1 - std::fabs(x)) * (y < 0 ? -1 : 1);
    x = folded;
  }
  const double length = std::sqrt(x * x + y * y + z * z);
  return {float(x / length), float(y / length), float(z / length)};
}

}  // namespace gigabake
