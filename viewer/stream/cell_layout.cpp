#include "viewer/stream/cell_layout.h"

#include <algorithm>
#include <bit>
#include <iterator>
#include <map>
#include <utility>

#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "core/octree/morton.h"
#include "kernels/marching/locate.h"

namespace gigabake {
namespace {

constexpr std::size_t max_cells = std::size_t(1) << 28;

/// A fault of a scene, without the file that it was read from.
struct LayoutRefusal {
  std::string key, what;
};

[[noreturn]] void refuse(const SceneCell& cell, const std::string& what) {
  throw LayoutRefusal{"cell " + cell.name, what + "; bake the scene again"};
}

void check_cell(const SceneCell& cell, const SceneCell& first) {
  const std::uint32_t edge = cell.cell_voxels;
  if (!std::has_single_bit(edge) || edge < brick_edge || edge > 8192)
    refuse(cell, "an edge of " + std::to_string(edge) + " voxels; expected a power of two, 8 to 8192");
  if (edge != first.cell_voxels)
    refuse(cell, "an edge of " + std::to_string(edge) + " voxels where cell " + first.name + " has " +
                     std::to_string(first.cell_voxels));
  if (cell.lods != std::uint32_t(std::bit_width(edge / brick_edge)))
    refuse(cell, pluralize(cell.lods, "level") + "; expected " + std::to_string(std::bit_width(edge / brick_edge)));
  for (const std::int64_t low : cell.lattice_min)
    if (low < -kernels::far_voxel / 4 || low > kernels::far_voxel / 4) refuse(cell, "it lies beyond 2^50 voxels");
  if (cell.lattice_min[0] % edge != 0 || cell.lattice_min[1] % edge != 0 || cell.lattice_min[2] % brick_edge != 0)
    refuse(cell, "its lowest corner is off the lattice of cells");
}

constexpr std::uint32_t rim_cell = 0xffffffffu;

/// The index of each cell, or rim_cell, by column coordinates and then by lowest z.
using Columns = std::map<std::pair<std::int64_t, std::int64_t>, std::map<std::int64_t, std::uint32_t>>;

Columns columns_of(const std::vector<SceneCell>& cells) {
  Columns columns;
  for (std::uint32_t c = 0; c < cells.size(); ++c) {
    const SceneCell& cell = cells[c];
    const std::int64_t edge = cell.cell_voxels, low = cell.lattice_min[2];
    auto& column = columns[{cell.lattice_min[0] / edge, cell.lattice_min[1] / edge}];
    const auto above = column.lower_bound(low);
    if (above != column.end() && above->first < low + edge)
      refuse(cell, "it overlaps cell " + cells[above->second].name);
    if (above != column.begin() && std::prev(above)->first + edge > low)
      refuse(cell, "it overlaps cell " + cells[std::prev(above)->second].name);
    column.emplace(low, c);
  }
  return columns;
}

/// Adds rim cells to a column where no cell covers the interval [low, high) of z. Rim cells are aligned to the cells of
/// the column.
void add_rims(std::int64_t low, std::int64_t high, std::int64_t edge, std::map<std::int64_t, std::uint32_t>& column) {
  const std::int64_t phase = column.empty() ? low : column.begin()->first;
  const auto floor_to_grid = [&](std::int64_t z) {
    const std::int64_t over = (z - phase) % edge;
    return z - (over < 0 ? over + edge : over);
  };
  for (std::int64_t z = floor_to_grid(low); z < high; z += edge) {
    const auto above = column.lower_bound(z);
    const bool free_above = above == column.end() || above->first >= z + edge;
    const bool free_below = above == column.begin() || std::prev(above)->first + edge <= z;
    if (free_above && free_below) column.emplace(z, rim_cell);
  }
}

/// Returns the columns with added rim cells. They cover a margin below each cell and to its west, south and south-west.
/// The margin is as wide as a voxel of the coarsest level.
Columns with_rims(const Columns& columns, std::int64_t edge) {
  Columns all = columns;
  const std::int64_t coarsest_voxel = edge / brick_edge;
  for (const auto& [at, column] : columns)
    for (const auto& [low, cell] : column)
      for (int side = 0; side < 4; ++side)
        add_rims(low - coarsest_voxel, low + edge, edge, all[{at.first - (side & 1), at.second - (side >> 1)}]);
  return all;
}

Box3i64 window_of(const std::vector<SceneCell>& cells) {
  Box3i64 window;
  for (const SceneCell& cell : cells) window = hull(window, window_of(cell));
  return window;
}

/// Sets the scene's bounds and the range of the column coordinates.
void measure(const Box3i64& window, const Columns& columns, kernels::CastScene& scene) {
  for (std::size_t a = 0; a < 3; ++a) {
    scene.min[a] = double(window.min[a]);
    scene.max[a] = double(window.end[a]);
    if (window.end[a] - window.min[a] > kernels::max_scene_edge)
      throw LayoutRefusal{"cells", "they are more than 2^33 voxels apart; bake fewer sources at once"};
  }
  scene.set_corner();
  for (int a = 0; a < 2; ++a) {
    std::int64_t low = kernels::far_voxel, high = -kernels::far_voxel;
    for (const auto& [at, column] : columns) {
      low = std::min(low, a == 0 ? at.first : at.second);
      high = std::max(high, a == 0 ? at.first : at.second);
    }
    scene.column_min[a] = low;
    scene.column_count[a] = high - low + 1;
  }
}

void add_column(const std::pair<std::int64_t, std::int64_t>& at, const std::map<std::int64_t, std::uint32_t>& column,
                CellLayout& layout) {
  layout.column_first.push_back(std::uint32_t(layout.cells.size()));
  for (const auto& [low, cell] : column) {
    const std::int64_t edge = std::int64_t(1) << layout.scene.cell_bits;
    layout.cells.push_back({{at.first * edge, at.second * edge, low}});
  }
}

CellLayout lay_out_columns(const Columns& columns, int cell_bits, const Box3i64& window) {
  CellLayout layout;
  kernels::CastScene& scene = layout.scene;
  scene.cell_bits = cell_bits;
  scene.lods = cell_bits - std::countr_zero(unsigned(brick_edge)) + 1;
  measure(window, columns, scene);

  std::map<std::uint64_t, Columns::const_iterator> by_key;
  for (auto it = columns.begin(); it != columns.end(); ++it)
    by_key[morton(std::uint32_t(it->first.first - scene.column_min[0]),
                  std::uint32_t(it->first.second - scene.column_min[1]))] = it;
  for (const auto& [key, it] : by_key) {
    layout.column_key.push_back(key);
    add_column(it->first, it->second, layout);
  }
  layout.column_first.push_back(std::uint32_t(layout.cells.size()));
  scene.cells = {layout.cells.data(), layout.cells.size()};
  scene.column_key = {layout.column_key.data(), layout.column_key.size()};
  scene.column_first = {layout.column_first.data(), layout.column_first.size()};
  return layout;
}

CellLayout lay_out(const std::vector<SceneCell>& cells) {
  if (cells.empty()) throw LayoutRefusal{"", "the scene has no cells: there is nothing to show"};
  if (cells.size() > max_cells)
    throw LayoutRefusal{"cells", "more than an image can address; use a larger `cell_voxels`"};
  for (const SceneCell& cell : cells) check_cell(cell, cells[0]);
  const Columns columns = with_rims(columns_of(cells), cells[0].cell_voxels);
  return lay_out_columns(columns, std::countr_zero(cells[0].cell_voxels), window_of(cells));
}

}  // namespace

CellLayout lay_out_cells(const std::vector<SceneCell>& cells, const std::filesystem::path& scene_path) {
  try {
    return lay_out(cells);
  } catch (const LayoutRefusal& refusal) {
    throw InputError(scene_path, refusal.key, refusal.what);
  }
}

CellLayout lay_out_root(const SceneCell& root, const Box3i64& window) {
  const int bits = std::countr_zero(root.cell_voxels);
  const std::int64_t edge = root.cell_voxels, coarsest_voxel = edge / brick_edge;
  const Vec3i64 low = (root.lattice_min - Vec3i64::all(coarsest_voxel)) >> bits;
  Columns columns;
  for (std::int64_t y = 0; y < 2; ++y)
    for (std::int64_t x = 0; x < 2; ++x)
      for (std::int64_t z = 0; z < 2; ++z) columns[{low[0] + x, low[1] + y}][(low[2] + z) * edge] = 0;
  return lay_out_columns(columns, bits, window);
}

}  // namespace gigabake
