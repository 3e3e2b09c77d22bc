#include "format/scene/scene_totals.h"

#include <algorithm>

namespace gigabake {

namespace {

template <class T>
void add_each(const std::vector<T>& of, std::vector<T>& to) {
  to.resize(std::max(to.size(), of.size()));
  for (std::size_t lod = 0; lod < of.size(); ++lod) to[lod] += of[lod];
}

}  // namespace

SceneTotals::SceneTotals(const std::vector<SceneCell>& all) {
  for (const SceneCell& cell : all) add(cell);
}

void SceneTotals::add(const SceneCell& cell) {
  SceneTotals one;
  one.cells = 1;
  one.bytes = cell.bytes;
  one.voxels = cell.voxels;
  one.content_hash = cell.content_hash;
  one.level_bytes = cell.level_bytes;
  one.node_bytes = cell.node_bytes;
  one.cell_voxels = cell.cell_voxels;
  one.window = window_of(cell);
  add(one);
}

void SceneTotals::add(const SceneTotals& part) {
  if (part.cells == 0) return;
  const bool stored = has_stored() && part.has_stored();
  cell_voxels = cells == 0 || cell_voxels == part.cell_voxels ? part.cell_voxels : 0;
  cells += part.cells;
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
