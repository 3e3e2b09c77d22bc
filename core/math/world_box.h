/// A box in the frame of a tileset's root.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/math/frames.h"

namespace gigabake {

struct WorldBox {
  std::array<double, 3> low{}, high{};
  bool is_empty = true;

  /// Extends the box to `p`; ignores a point that is not finite.
  void add(const Point<World>& p) {
    const std::array<double, 3> v{p.x, p.y, p.z};
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return;
    for (std::size_t c = 0; c < 3; ++c) {
      low[c] = is_empty ? v[c] : std::min(low[c], v[c]);
      high[c] = is_empty ? v[c] : std::max(high[c], v[c]);
    }
    is_empty = false;
  }
  void join(const WorldBox& box) {
    if (box.is_empty) return;
    add({box.low[0], box.low[1], box.low[2]});
    add({box.high[0], box.high[1], box.high[2]});
  }

  Point<World> centre() const { return {low[0] / 2 + high[0] / 2, low[1] / 2 + high[1] / 2, low[2] / 2 + high[2] / 2}; }
  double half_diagonal() const {
    return std::hypot(high[0] / 2 - low[0] / 2, high[1] / 2 - low[1] / 2, high[2] / 2 - low[2] / 2);
  }
};

}  // namespace gigabake
