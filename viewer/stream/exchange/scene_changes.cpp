#include "viewer/stream/exchange/scene_changes.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/base/error.h"
#include "core/octree/parameters.h"
#include "viewer/stream/overview_levels.h"

namespace gigabake {
namespace {

bool are_equal(const std::optional<OverviewLevels>& a, const std::optional<OverviewLevels>& b) {
  if (!a || !b) return !a && !b;
  return a->levels == b->levels;
}

/// Returns whether the bake stores every voxel exactly, so that a voxel does not depend on others of its level.
bool is_exact(const SceneHeader& scene) {
  try {
    return parameters_from_json(scene.parameters).max_error == 0;
  } catch (const InputError&) {
    return false;
  }
}

using Key = std::pair<std::uint32_t, Vec3i64>;  ///< finest native level and position

Key key_of(const SceneCell& shard) { return {shard.own_lod(), shard.lattice_min}; }

struct KnownShard {
  const SceneCell* shard;
  std::uint32_t number;
};

class Comparison {
 public:
  Comparison(const PagedScene& previous, const PagedScene& next, ShardTable& table)
      : same_parameters_(previous.header().parameters == next.header().parameters), table_(table) {}

  /// Returns the numbers of the next shards, and appends the windows of changed shards to `windows`.
  std::vector<std::uint32_t> compare(const std::vector<SceneCell>& previous, const std::vector<std::uint32_t>& numbers,
                                     const std::vector<SceneCell>& next, std::vector<Box3i64>& windows) const {
    std::map<Key, KnownShard> known;
    for (std::size_t i = 0; i < previous.size(); ++i) known[key_of(previous[i])] = {&previous[i], numbers.at(i)};
    std::vector<std::uint32_t> of_next;
    for (const SceneCell& shard : next) {
      const auto found = known.find(key_of(shard));
      const bool is_equal = found != known.end() && found->second.shard->content_hash == shard.content_hash;
      of_next.push_back(is_equal && same_parameters_ ? kept(found->second, shard) : table_.add(shard));
      if (!is_equal) windows.push_back(window_of(shard));
      if (found != known.end()) known.erase(found);
    }
    for (const auto& [key, gone] : known) windows.push_back(window_of(*gone.shard));
    return of_next;
  }

 private:
  std::uint32_t kept(const KnownShard& known, const SceneCell& shard) const {
    const bool is_same_file = known.shard->file == shard.file && known.shard->fingerprint == shard.fingerprint;
    if (!is_same_file) table_.replace(known.number, shard);
    return known.number;
  }

  const bool same_parameters_;
  ShardTable& table_;
};

}  // namespace

bool are_exchangeable(const PagedScene& a, const PagedScene& b) {
  const SceneHeader &h = a.header(), &g = b.header();
  return a.root().pages.empty() && b.root().pages.empty() && a.folder() == b.folder() &&
         h.voxel_size_m == g.voxel_size_m && h.lattice_origin_m == g.lattice_origin_m && h.origin == g.origin &&
         h.has_normals == g.has_normals && h.has_directional_coverage == g.has_directional_coverage &&
         a.totals().cell_voxels == b.totals().cell_voxels && a.totals().cell_voxels != 0 &&
         are_equal(overview_levels(a), overview_levels(b));
}

SceneChanges changes_between(const PagedScene& previous, const ShardNumbers& numbers, const PagedScene& next,
                             ShardTable& table) {
  SceneChanges changes;
  const Comparison comparison(previous, next, table);
  const ScenePage &before = previous.root(), &after = next.root();
  changes.numbers.cells = comparison.compare(before.cells, numbers.cells, after.cells, changes.boxes);
  const std::size_t cells = changes.boxes.size();
  std::vector<Box3i64> windows;
  changes.numbers.overviews = comparison.compare(before.overviews, numbers.overviews, after.overviews, windows);
  const bool are_exact = is_exact(previous.header()) && is_exact(next.header());
  for (const Box3i64& window : windows) {
    const bool has_changed_cell = std::any_of(changes.boxes.begin(), changes.boxes.begin() + std::ptrdiff_t(cells),
                                              [&](const Box3i64& cell) { return cell.overlaps(window); });
    if (!are_exact || !has_changed_cell) changes.boxes.push_back(window);
  }
  return changes;
}

}  // namespace gigabake
