/// Search for the cells of a scene by position.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/math/box3.h"
#include "format/scene/xml/scene_xml.h"

namespace gigabake {

/// A finder of the cells of a scene that overlap a box. It stores a reference to the cells.
/// Cost    A binary search, then a test of every cell in the same x range.
class CellFinder {
 public:
  explicit CellFinder(const std::vector<SceneCell>& cells);
  /// Returns indices into the scene's cells, in ascending order.
  std::vector<std::size_t> overlapping(const Box3i64& box) const;

 private:
  const std::vector<SceneCell>& cells_;
  std::vector<std::size_t> by_x_;
  std::int64_t max_edge_ = 0;
};

}  // namespace gigabake
