#include <algorithm>
#include <cmath>

#include "core/math/srgb.h"
#include "format/source/mesh/ply_layout.h"

namespace gigabake {
namespace {

/// Returns the value of full intensity: the max value of an integer type, 1 for floats.
double full_of(PlyType type) {
  return is_integer(type)
             ? std::ldexp(1, int(8 * byte_count(type)) -
                                 (type == PlyType::int8 || type == PlyType::int16 || type == PlyType::int32 ? 1 : 0)) -
                   1
             : 1;
}

}  // namespace

PlyColour::PlyColour(const PlyElement& element, const VertexLayout& layout, const std::vector<double>& value) {
  const auto unit = [&](std::size_t c) {
    const std::size_t p = *layout.colour[c];
    return value[p] / full_of(element.properties[p].type);
  };
  for (std::size_t c = 0; c < 3; ++c) {
    rgba[c] = linear16(unit(c));
    is_clamped |= !(unit(c) >= 0 && unit(c) <= 1);
  }
  if (!layout.colour[3]) return;
  const double alpha = unit(3);
  rgba[3] = std::uint16_t(std::lround((alpha >= 0 ? std::min(alpha, 1.0) : 0.0) * 65535));
}

}  // namespace gigabake
