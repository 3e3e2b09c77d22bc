#include "viewer/cell_layout.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "format/error.h"
#include "kernels/cast_locate.h"

namespace gigabake {
namespace {

constexpr std::int64_t most_columns = std::int64_t(1) << 31;

/// What is wrong with a scene, without the file it was read from.
struct Refusal {
  std::string key, what;
};

[[noreturn]] void refuse(const SceneCell& cell, const std::string& what) {
  throw Refusal{"cell " + cell.name, what + "; bake the scene again"};
}

void check_cell(const SceneCell& cell, const SceneCell& first) {
  const std::uint32_t edge = cell.cell_voxels;
  if (!std::has_single_bit(edge) || edge < brick_edge || edge > 8192)
    refuse(cell, "an edge of " + std::to_string(edge) + " voxels; expected a power of two, 8 to 8192");
  if (edge != first.cell_voxels)
    refuse(cell, "an edge of " + std::to_string(edge) + " voxels where cell " + first.name + " has " +
                     std::to_string(first.cell_voxels));
  if (cell.lods != std::uint32_t(std::bit_width(edge / brick_edge)))
    refuse(cell, std::to_string(cell.lods) + " levels; expected " + std::to_string(std::bit_width(edge / brick_edge)));
  for (const std::int64_t low : cell.lattice_min)
    if (low < -kernels::far_voxel / 4 || low > kernels::far_voxel / 4) refuse(cell, "it lies beyond 2^50 voxels");
  if (cell.lattice_min[0] % edge != 0 || cell.lattice_min[1] % edge != 0 || cell.lattice_min[2] % brick_edge != 0)
    refuse(cell, "its lowest corner is off the lattice of cells");
}

/// Columns' coordinates start at 0.
void measure(const SceneDescription& description, kernels::CastScene& scene) {
  const std::int64_t edge = description.cells[0].cell_voxels;
  for (int a = 0; a < 3; ++a) {
    std::int64_t low = kernels::far_voxel, high = -kernels::far_voxel;
    for (const SceneCell& cell : description.cells) {
      low = std::min(low, cell.lattice_min[a]);
      high = std::max(high, cell.lattice_min[a] + edge);
    }
    scene.min[a] = double(low);
    scene.max[a] = double(high);
    if (a == 2) continue;
    scene.column_min[a] = low / edge;
    scene.column_count[a] = (high - low) / edge;
    if (scene.column_count[a] > most_columns)
      throw Refusal{"cells", "they are more than 2^31 columns apart; bake fewer sources at once"};
  }
}

std::uint64_t column_of(const SceneCell& cell, const kernels::CastScene& scene) {
  const auto coordinate = [&](int a) {
    return std::uint32_t(cell.lattice_min[a] / std::int64_t(cell.cell_voxels) - scene.column_min[a]);
  };
  return kernels::column_key(coordinate(0), coordinate(1));
}

void add_cell(const SceneDescription& description, std::uint32_t index, CellLayout& layout) {
  const SceneCell& cell = description.cells[index];
  const std::uint64_t key = column_of(cell, layout.scene);
  if (layout.column_key.empty() || layout.column_key.back() != key) {
    layout.column_key.push_back(key);
    layout.column_first.push_back(std::uint32_t(layout.cells.size()));
  } else if (layout.cells.back().min[2] + cell.cell_voxels > cell.lattice_min[2]) {
    refuse(cell, "it overlaps cell " + description.cells[layout.scene_cell.back()].name);
  }
  kernels::CastCell& added = layout.cells.emplace_back();
  std::copy(cell.lattice_min.begin(), cell.lattice_min.end(), added.min);
  layout.scene_cell.push_back(index);
}

CellLayout lay_out(const SceneDescription& description) {
  if (description.cells.empty()) throw Refusal{"", "the scene has no cells: there is nothing to show"};
  if (description.cells.size() >= kernels::cell_of_page(kernels::no_page))
    throw Refusal{"cells", "more than a picture can address; use a larger --cell-voxels"};
  for (const SceneCell& cell : description.cells) check_cell(cell, description.cells[0]);
  CellLayout layout;
  kernels::CastScene& scene = layout.scene;
  scene.cell_bits = std::countr_zero(description.cells[0].cell_voxels);
  scene.lods = std::int32_t(description.cells[0].lods);
  measure(description, scene);

  std::vector<std::uint32_t> order(description.cells.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const SceneCell &left = description.cells[a], &right = description.cells[b];
    const std::uint64_t left_key = column_of(left, scene), right_key = column_of(right, scene);
    return left_key != right_key ? left_key < right_key : left.lattice_min[2] < right.lattice_min[2];
  });
  for (const std::uint32_t index : order) add_cell(description, index, layout);
  layout.column_first.push_back(std::uint32_t(layout.cells.size()));
  scene.cells = {layout.cells.data(), layout.cells.size()};
  scene.column_key = {layout.column_key.data(), layout.column_key.size()};
  scene.column_first = {layout.column_first.data(), layout.column_first.size()};
  return layout;
}

}  // namespace

CellLayout lay_out_cells(const SceneDescription& description, const std::filesystem::path& scene_path) {
  try {
    return lay_out(description);
  } catch (const Refusal& refusal) {
    throw InputError(scene_path, refusal.key, refusal.what);
  }
}

}  // namespace gigabake
