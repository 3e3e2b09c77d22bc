#include <algorithm>

#include "format/scene/scene_page.h"

namespace gigabake {

namespace {

template <class T>
void add_each(const std::vector<T>& of, std::vector<T>& to) {
  to.resize(std::max(to.size(), of.size()));
  for (std::size_t lod = 0; lod < of.size(); ++lod) to[lod] += of[lod];
}

/// Converts a shard's values per level to values per lod of the lattice. Duplicated levels get zeros, because the
/// children's voxels are counted instead.
template <class T>
std::vector<T> on_lattice(const std::vector<T>& of_levels, const SceneCell& shard) {
  std::vector<T> out(shard.own_lod());
  for (std::size_t l = shard.copied_lods; l < of_levels.size(); ++l) out.push_back(of_levels[l]);
  return out;
}

}  // namespace

SceneTotals::SceneTotals(const std::vector<SceneCell>& all) {
  for (const SceneCell& cell : all) add(cell);
}

SceneTotals::SceneTotals(const SceneDescription& scene) : SceneTotals(scene.cells) {
  for (const SceneCell& overview : scene.overviews) add(overview);
}

void SceneTotals::add(const SceneCell& cell) {
  SceneTotals one;
  one.bytes = cell.bytes;
  one.voxels = on_lattice(cell.voxels, cell);
  one.content_hash = on_lattice(cell.content_hash, cell);
  if (!cell.level_bytes.empty()) one.level_bytes = on_lattice(cell.level_bytes, cell);
  one.node_bytes = cell.node_bytes;
  if (cell.first_lod != 0) {
    one.overviews = 1;
  } else {
    one.cells = 1;
    one.cell_voxels = cell.cell_voxels;
    one.window = window_of(cell);
  }
  add(one);
}

void SceneTotals::add(const SceneTotals& part) {
  if (part.cells + part.overviews == 0) return;
  const bool stored = has_stored() && part.has_stored();
  if (part.cells != 0) cell_voxels = cells == 0 || cell_voxels == part.cell_voxels ? part.cell_voxels : 0;
  cells += part.cells;
  overviews += part.overviews;
  bytes += part.bytes;
  add_each(part.voxels, voxels);
  add_each(part.content_hash, content_hash);
  add_each(part.level_bytes, level_bytes);
  node_bytes += part.node_bytes;
  if (!stored) level_bytes.clear(), node_bytes = 0;
  window = hull(window, part.window);
}

Hash128 SceneTotals::all_content() const {
  Hash128 all;
  for (const Hash128& hash : content_hash) all += hash;
  return all;
}

}  // namespace gigabake
