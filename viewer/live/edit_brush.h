/// A brush: a shape at a place that edits a scene.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "core/math/frames.h"

namespace gigabake {

/// The names of effects and shapes in lists of edits (docs/editing.md).
inline constexpr std::array<const char*, 3> brush_types{"carve", "fill", "paint"};
inline constexpr std::array<const char*, 3> brush_shapes{"sphere", "box", "cylinder"};

struct EditBrush {
  std::size_t type = 0;   ///< index in brush_types
  std::size_t shape = 0;  ///< index in brush_shapes
  double radius_m = 1;    ///< of a box: half of its edge
  double height_m = 2;    ///< of a box or cylinder; its middle is at the place
  std::array<std::uint8_t, 3> rgb{220, 40, 40};
};

/// Returns a list of one edit, the brush at a place, as SceneEditor requires it.
std::string edits_of(const EditBrush& brush, const Point<Scene>& at);

}  // namespace gigabake
