/// The cube of the lattice that a cell covers.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "format/scene/xml/scene_xml.h"

namespace gigabake {

/// Half-open box in lod-0 voxels.
struct LatticeBox {
  std::array<std::int64_t, 3> min{}, end{};

  bool is_empty() const { return min[0] >= end[0] || min[1] >= end[1] || min[2] >= end[2]; }
  bool holds(const std::array<std::int64_t, 3>& p) const {
    for (std::size_t c = 0; c < 3; ++c)
      if (p[c] < min[c] || p[c] >= end[c]) return false;
    return true;
  }
  friend bool operator==(const LatticeBox&, const LatticeBox&) = default;
};

/// Returns the smallest box that contains both boxes. An empty box contributes nothing.
inline LatticeBox hull(const LatticeBox& a, const LatticeBox& b) {
  if (a.is_empty()) return b;
  if (b.is_empty()) return a;
  LatticeBox r;
  for (std::size_t c = 0; c < 3; ++c) {
    r.min[c] = std::min(a.min[c], b.min[c]);
    r.end[c] = std::max(a.end[c], b.end[c]);
  }
  return r;
}

inline LatticeBox window_of(const SceneCell& cell) {
  const std::int64_t edge = cell.cell_voxels;
  return {cell.lattice_min, {cell.lattice_min[0] + edge, cell.lattice_min[1] + edge, cell.lattice_min[2] + edge}};
}

inline LatticeBox intersection(const LatticeBox& a, const LatticeBox& b) {
  LatticeBox r;
  for (std::size_t c = 0; c < 3; ++c) {
    r.min[c] = std::max(a.min[c], b.min[c]);
    r.end[c] = std::min(a.end[c], b.end[c]);
  }
  return r;
}

/// Finds the cells of a scene that overlap a box. Borrows the cells.
/// Cost    A binary search, then a test of every cell in the same x range.
class CellFinder {
 public:
  explicit CellFinder(const std::vector<SceneCell>& cells);
  /// Returns indices into the scene's cells, in ascending order.
  std::vector<std::size_t> overlapping(const LatticeBox& box) const;

 private:
  const std::vector<SceneCell>& cells_;
  std::vector<std::size_t> by_x_;
  std::int64_t max_edge_ = 0;
};

}  // namespace gigabake
