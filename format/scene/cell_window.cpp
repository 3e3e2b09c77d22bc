#include "format/scene/cell_window.h"

#include <numeric>

namespace gigabake {

CellFinder::CellFinder(const std::vector<SceneCell>& cells) : cells_(cells), by_x_(cells.size()) {
  std::iota(by_x_.begin(), by_x_.end(), std::size_t(0));
  std::stable_sort(by_x_.begin(), by_x_.end(),
                   [&](std::size_t a, std::size_t b) { return cells[a].lattice_min[0] < cells[b].lattice_min[0]; });
  for (const SceneCell& c : cells) max_edge_ = std::max<std::int64_t>(max_edge_, c.cell_voxels);
}

std::vector<std::size_t> CellFinder::overlapping(const Box3i64& box) const {
  std::vector<std::size_t> found;
  auto at = std::upper_bound(by_x_.begin(), by_x_.end(), box.min[0] - max_edge_,
                             [&](std::int64_t x, std::size_t i) { return x < cells_[i].lattice_min[0]; });
  for (; at != by_x_.end() && cells_[*at].lattice_min[0] < box.end[0]; ++at)
    if (!intersection(window_of(cells_[*at]), box).is_empty()) found.push_back(*at);
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace gigabake
