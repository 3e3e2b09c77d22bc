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
  const std::optional<BakeParameters> parameters = parameters_of(scene);
  return parameters && parameters->max_error == 0 && parameters->depth_error == 0;
}

using Key = std::pair<std::uint32_t, Vec3i64>;  ///< finest native level and position

Key key_of(const SceneCell& shard) { return {shard.own_lod(), shard.lattice_min}; }

void append(const std::vector<Box3i64>& boxes, std::vector<Box3i64>& to) {
  to.insert(to.end(), boxes.begin(), boxes.end());
}

struct KnownShard {
  const SceneCell* shard;
  std::uint32_t number;
};

class Comparison {
 public:
  Comparison(const PagedScene& previous, const PagedScene& next, ShardTable& table)
      : same_parameters_(previous.header().parameters == next.header().parameters), table_(table) {}

  /// Returns the numbers of the next shards, and appends to `windows` the windows of changed shards, or their parts
  /// that `edits` changed. null: overviews.
  std::vector<std::uint32_t> compare(const std::vector<SceneCell>& previous, const std::vector<std::uint32_t>& numbers,
                                     const std::vector<SceneCell>& next, const EditedBoxes* edits,
                                     std::vector<Box3i64>& windows) const {
    std::map<Key, KnownShard> known;
    for (std::size_t i = 0; i < previous.size(); ++i) known[key_of(previous[i])] = {&previous[i], numbers.at(i)};
    std::vector<std::uint32_t> of_next;
    for (const SceneCell& shard : next) {
      const auto found = known.find(key_of(shard));
      const bool is_equal = found != known.end() && found->second.shard->content_hash == shard.content_hash;
      of_next.push_back(is_equal && same_parameters_ ? kept(found->second, shard) : table_.add(shard));
      if (!is_equal && found != known.end() && edits != nullptr)
        append(edits->of_cell(*found->second.shard, shard), windows);
      else if (!is_equal)
        windows.push_back(window_of(shard));
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

/// A comparison of scenes with pages, page by page.
class PagedComparison {
 public:
  PagedComparison(const PagedScene& previous, const PagedScene& next)
      : previous_(previous), next_(next), cells_(std::uint32_t(next.totals().cells)) {
    try {
      has_equal_places_ = previous.totals().cells == next.totals().cells &&
                          previous.totals().overviews == next.totals().overviews &&
                          compare(previous.root(), next.root(), 0, 0);
    } catch (const InputError&) {
      has_equal_places_ = false;
    }
  }

  bool has_equal_places() const { return has_equal_places_; }
  struct Changed {
    std::uint32_t number;  ///< in both scenes
    SceneCell before, after;
  };
  const std::vector<Changed>& changed() const { return changed_; }

 private:
  /// `cell` and `overview` count the cells and overviews before these pages.
  bool compare(const ScenePage& a, const ScenePage& b, std::uint32_t cell, std::uint32_t overview) {
    if (!compare(a.cells, b.cells, cell) || !compare(a.overviews, b.overviews, cells_ + overview)) return false;
    if (a.pages.size() != b.pages.size()) return false;
    overview += std::uint32_t(a.overviews.size());
    for (std::size_t i = 0; i < a.pages.size(); ++i) {
      if (!compare(a.pages[i], b.pages[i], cell, overview)) return false;
      cell += std::uint32_t(a.pages[i].totals.cells);
      overview += std::uint32_t(a.pages[i].totals.overviews);
    }
    return true;
  }

  bool compare(const PageReference& a, const PageReference& b, std::uint32_t cell, std::uint32_t overview) {
    if (a.block != b.block || a.groups != b.groups || a.totals.cells != b.totals.cells ||
        a.totals.overviews != b.totals.overviews)
      return false;
    if (a.checksum == b.checksum) return true;
    return compare(read_page(previous_.file(), previous_.header(), a), read_page(next_.file(), next_.header(), b), cell,
                   overview);
  }

  bool compare(const std::vector<SceneCell>& a, const std::vector<SceneCell>& b, std::uint32_t first) {
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (key_of(a[i]) != key_of(b[i])) return false;
      if (a[i].content_hash != b[i].content_hash) changed_.push_back({first + std::uint32_t(i), a[i], b[i]});
    }
    return changed_.size() <= max_changed_shards;
  }

  const PagedScene &previous_, &next_;
  const std::uint32_t cells_;
  bool has_equal_places_ = false;
  std::vector<Changed> changed_;
};

/// Appends the windows of changed overviews. An exact overview changes only in the boxes of changed cells, which
/// `boxes` has already.
void add_overviews(const std::vector<Box3i64>& windows, bool are_exact, std::vector<Box3i64>& boxes) {
  const auto cells = std::ptrdiff_t(boxes.size());
  for (const Box3i64& window : windows) {
    const bool has_changed_cell =
        std::any_of(boxes.begin(), boxes.begin() + cells, [&](const Box3i64& cell) { return cell.overlaps(window); });
    if (!are_exact || !has_changed_cell) boxes.push_back(window);
  }
}

}  // namespace

bool are_exchangeable(const PagedScene& a, const PagedScene& b) {
  const SceneHeader &h = a.header(), &g = b.header();
  return a.root().pages.empty() == b.root().pages.empty() && a.folder() == b.folder() &&
         h.voxel_size_m == g.voxel_size_m && h.lattice_origin_m == g.lattice_origin_m && h.origin == g.origin &&
         h.has_normals == g.has_normals && h.has_directional_coverage == g.has_directional_coverage &&
         h.has_classes == g.has_classes && a.totals().cell_voxels == b.totals().cell_voxels &&
         a.totals().cell_voxels != 0 && are_equal(overview_levels(a), overview_levels(b));
}

SceneChanges changes_between(const PagedScene& previous, const ShardNumbers& numbers, const PagedScene& next,
                             const EditedBoxes& edits, ShardTable& table) {
  SceneChanges changes;
  const Comparison comparison(previous, next, table);
  const ScenePage &before = previous.root(), &after = next.root();
  changes.numbers.cells = comparison.compare(before.cells, numbers.cells, after.cells, &edits, changes.boxes);
  std::vector<Box3i64> windows;
  changes.numbers.overviews =
      comparison.compare(before.overviews, numbers.overviews, after.overviews, nullptr, windows);
  add_overviews(windows, is_exact(previous.header()) && is_exact(next.header()), changes.boxes);
  return changes;
}

std::optional<SceneChanges> paged_changes_between(const PagedScene& previous, const ShardNumbers& numbers,
                                                  const PagedScene& next, const EditedBoxes& edits,
                                                  PagedShards& shards) {
  if (previous.header().parameters != next.header().parameters) return std::nullopt;
  PagedComparison comparison(previous, next);
  if (!comparison.has_equal_places()) return std::nullopt;
  SceneChanges changes{numbers, {}};
  std::vector<Box3i64> windows;
  for (const auto& [number, before, after] : comparison.changed()) {
    changes.numbers.replaced[number] = shards.add(after);
    if (number < next.totals().cells)
      append(edits.of_cell(before, after), changes.boxes);
    else
      windows.push_back(window_of(after));
  }
  add_overviews(windows, is_exact(next.header()), changes.boxes);
  return changes;
}

}  // namespace gigabake
