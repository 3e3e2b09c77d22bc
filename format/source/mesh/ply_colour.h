/// Colours of the vertices and faces of a PLY.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/source/mesh/ply_layout.h"

namespace gigabake {

/// The colour of an element. Colours in the file are sRGB; integers are divided by the max value of their type.
struct PlyColour {
  using Rgba = std::array<std::uint16_t, 4>;

  /// Converts the colour of an element. `value` has one value per property of the element.
  /// Range   layout.has_colour().
  PlyColour(const PlyElement& element, const VertexLayout& layout, const std::vector<double>& value);

  Rgba rgba{0, 0, 0, 65535};  ///< linear, 65535 = 1
  bool is_clamped = false;    ///< red, green or blue was outside 0 to 1
};

}  // namespace gigabake
