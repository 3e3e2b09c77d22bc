#include "format/scene/check/diff.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <map>
#include <optional>
#include <set>

#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "format/scene/cell_window.h"
#include "format/scene/paged_scene.h"
#include "format/scene/shard_of_scene.h"
#include "format/shard/levels/level_lookup.h"

namespace gigabake {
namespace {

/// One of the two scenes. `scene` holds the cells to compare.
struct Side {
  std::filesystem::path scene_xml;
  SceneDescription scene;
  SceneTotals totals;
};

/// A cell of one scene, read level by level.
struct OpenCell {
  OpenCell(const Side& side, const SceneCell& cell)
      : reader(open_shard_of_scene(side.scene_xml, side.scene, cell)),
        nodes(reader.nodes()),
        min(cell.lattice_min),
        lods(cell.lods),
        first_lod(int(cell.first_lod)) {}
  BrickLevel level(int lod) const { return reader.level(lod - first_lod); }

  ShardReader reader;
  NodeTable nodes;
  Vec3i64 min;
  std::uint32_t lods;
  int first_lod;
};

bool has_level(const SceneCell& cell, int lod) {
  return lod >= int(cell.own_lod()) && lod < int(cell.first_lod + cell.lods);
}
std::uint64_t voxels_of(const SceneCell& cell, int lod) { return cell.voxels[std::size_t(lod) - cell.first_lod]; }
const Hash128& content_of(const SceneCell& cell, int lod) {
  return cell.content_hash[std::size_t(lod) - cell.first_lod];
}

class DifferenceSum {
 public:
  explicit DifferenceSum(int lod) { d_.lod = lod; }
  void add_both(const VoxelValue& a, const VoxelValue& b) {
    ++d_.both;
    d_.turned += std::memcmp(a.normal, b.normal, 2) != 0;
    d_.refaced += a.directional_coverage != nullptr && b.directional_coverage != nullptr &&
                  std::memcmp(a.directional_coverage, b.directional_coverage, directional_coverage_bytes) != 0;
    d_.reclassified += a.voxel_class != b.voxel_class;
    if (std::memcmp(a.rgba, b.rgba, 4) == 0) return;
    ++d_.recoloured;
    for (std::size_t c = 0; c < 4; ++c) {
      const int difference = std::abs(int(a.rgba[c]) - int(b.rgba[c]));
      d_.maximum[c] = std::max(d_.maximum[c], difference);
      sum_[c] += std::uint64_t(difference);
    }
  }
  void add_only_in_a(std::uint64_t voxels) { d_.only_in_a += voxels; }
  void add_only_in_b(std::uint64_t voxels) { d_.only_in_b += voxels; }
  LevelDifference value() const {
    LevelDifference d = d_;
    for (std::size_t c = 0; c < 4 && d.recoloured != 0; ++c) d.mean[c] = double(sum_[c]) / double(d.recoloured);
    return d;
  }

 private:
  LevelDifference d_;
  std::array<std::uint64_t, 4> sum_{};
};

/// Numbers of voxels of a level: all, and those inside the compared box.
struct Walked {
  std::uint64_t all = 0, inside = 0;
};

struct PairResult {
  LevelDifference difference;
  Walked a, b;
};

PairResult compare_level(const OpenCell& a, const BrickLevel& level_a, const OpenCell& b, const Box3i64& box, int lod) {
  const BrickLevel level_b = b.level(lod);
  LevelLookup in_b(b.nodes, level_b, b.lods, lod - b.first_lod);
  PairResult r;
  DifferenceSum sum(lod);
  const auto corner_of = [lod](const Vec3i64& min, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return min + (Vec3i64{x, y, z} << lod);
  };
  for_each_voxel_of_level(
      a.nodes, level_a, lod - a.first_lod,
      [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t* rgba, const std::int8_t* normal,
          const std::uint8_t* directional_coverage, VoxelClass voxel_class) {
        ++r.a.all;
        const Vec3i64 corner = corner_of(a.min, x, y, z);
        if (!box.contains(corner)) return;
        ++r.a.inside;
        const Vec3<std::uint32_t> at((corner - b.min) >> lod);
        VoxelValue other;
        if (in_b.find(at[0], at[1], at[2], other))
          sum.add_both({rgba, normal, directional_coverage, voxel_class}, other);
        else
          sum.add_only_in_a(1);
      });
  for_each_voxel_of_level(
      b.nodes, level_b, lod - b.first_lod,
      [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t*, const std::int8_t*) {
        ++r.b.all;
        r.b.inside += box.contains(corner_of(b.min, x, y, z));
      });
  sum.add_only_in_b(r.b.inside - sum.value().both);
  r.difference = sum.value();
  return r;
}

/// Returns whether the voxels of the two levels are the same cubes of the lattice.
bool share_a_grid(const SceneCell& a, const SceneCell& b, int lod) {
  if (!has_level(a, lod) || !has_level(b, lod)) return false;
  const Vec3i64 apart = a.lattice_min - b.lattice_min;
  return (apart >> lod << lod) == apart;
}

std::uint64_t bytes_of_scene(const SceneDescription& scene) {
  std::uint64_t bytes = 0;
  for (const auto& shards : {&scene.cells, &scene.overviews})
    for (const SceneCell& cell : *shards) bytes += cell.bytes;
  return bytes;
}

/// A finder of the shards that overlap a window on one level: cells on fine levels, overviews above.
class ShardFinder {
 public:
  explicit ShardFinder(const SceneDescription& scene) : cells_(scene.cells), overviews_(scene.overviews) {
    for (const auto& shards : {&scene.cells, &scene.overviews})
      for (const SceneCell& cell : *shards) all_.push_back(&cell);
    overviews_begin_ = scene.cells.size();
    for (const SceneCell& cell : scene.cells) cell_lods_ = std::max(cell_lods_, int(cell.lods));
  }
  /// Returns the cells, then the overviews.
  const std::vector<const SceneCell*>& all() const { return all_; }
  /// Returns indices into all().
  std::vector<std::size_t> overlapping(const Box3i64& window, int lod) const {
    std::vector<std::size_t> found;
    if (lod < cell_lods_) found = cells_.overlapping(window);
    if (found.empty())
      for (const std::size_t overview : overviews_.overlapping(window))
        if (has_level(*all_[overviews_begin_ + overview], lod)) found.push_back(overviews_begin_ + overview);
    return found;
  }

 private:
  CellFinder cells_, overviews_;
  std::vector<const SceneCell*> all_;
  std::size_t overviews_begin_ = 0;
  int cell_lods_ = 0;
};

/// A comparison that visits each of A's cells once. Cells of B should not be larger, because a cell of B is read for
/// every cell of A that it overlaps.
class SceneComparison {
 public:
  SceneComparison(const Side& a, const Side& b) : a_(a), b_(b), finder_(b.scene) {}

  SceneDifference run(const Progress& progress) {
    choose_levels();
    progress.step("comparing the cells", bytes_of_scene(a_.scene));
    for (const auto& shards : {&a_.scene.cells, &a_.scene.overviews})
      for (const SceneCell& cell : *shards) {
        compare_cell(cell);
        progress.advance(cell.bytes);
      }
    for (std::size_t i = 0; i < finder_.all().size(); ++i) add_rest_of_b(i);
    SceneDifference result;
    for (auto& [names, levels] : differences_) result.cells.push_back({names.first, names.second, std::move(levels)});
    for (const int lod : all_levels_) (skipped_.contains(lod) ? result.not_compared : result.compared).push_back(lod);
    return result;
  }

 private:
  void choose_levels() {
    const SceneTotals &a = a_.totals, &b = b_.totals;
    for (std::size_t lod = 0; lod < std::max(a.voxels.size(), b.voxels.size()); ++lod) {
      all_levels_.push_back(int(lod));
      if (a.cells == 0 || b.cells == 0)
        open_levels_.push_back(int(lod));
      else if (lod >= std::min(a.voxels.size(), b.voxels.size()))
        skipped_.insert(int(lod));
      else if (a.content_hash[lod] != b.content_hash[lod])
        open_levels_.push_back(int(lod));
    }
  }

  void compare_cell(const SceneCell& cell) {
    std::optional<OpenCell> open;
    for (const int lod : open_levels_)
      if (has_level(cell, lod)) compare_cell_level(cell, finder_.overlapping(window_of(cell), lod), lod, open);
  }

  void compare_cell_level(const SceneCell& cell, const std::vector<std::size_t>& others, int lod,
                          std::optional<OpenCell>& open) {
    if (others.empty()) return add_rest(cell.name, "", lod, voxels_of(cell, lod), 0);
    for (const std::size_t i : others) {
      const SceneCell& other = *finder_.all()[i];
      if (!share_a_grid(cell, other, lod)) {
        skipped_.insert(lod);
        return;
      }
      if (window_of(cell) == window_of(other) && content_of(cell, lod) == content_of(other, lod)) {
        seen_of_b_[{i, lod}] = {1, 1};
        return;
      }
    }
    if (!open) open.emplace(a_, cell);
    const BrickLevel level = open->level(lod);
    Walked of_a;
    for (const std::size_t i : others) {
      const SceneCell& other = *finder_.all()[i];
      const OpenCell open_other(b_, other);
      const Box3i64 box = intersection(window_of(cell), window_of(other));
      const PairResult r = compare_level(*open, level, open_other, box, lod);
      add(cell.name, other.name, r.difference);
      of_a = {r.a.all, of_a.inside + r.a.inside};
      Walked& of_b = seen_of_b_[{i, lod}];
      of_b = {r.b.all, of_b.inside + r.b.inside};
    }
    add_rest(cell.name, "", lod, of_a.all - std::min(of_a.all, of_a.inside), 0);
  }

  /// Adds the voxels of shard `i` of B that lie in no shard of A.
  void add_rest_of_b(std::size_t i) {
    const SceneCell& cell = *finder_.all()[i];
    for (const int lod : open_levels_) {
      if (!has_level(cell, lod) || skipped_.contains(lod)) continue;
      const auto seen = seen_of_b_.find({i, lod});
      if (seen == seen_of_b_.end())
        add_rest("", cell.name, lod, 0, voxels_of(cell, lod));
      else
        add_rest("", cell.name, lod, 0, seen->second.all - std::min(seen->second.all, seen->second.inside));
    }
  }

  void add_rest(const std::string& in_a, const std::string& in_b, int lod, std::uint64_t of_a, std::uint64_t of_b) {
    DifferenceSum sum(lod);
    sum.add_only_in_a(of_a);
    sum.add_only_in_b(of_b);
    add(in_a, in_b, sum.value());
  }
  void add(const std::string& in_a, const std::string& in_b, const LevelDifference& difference) {
    if (difference.any()) differences_[{in_a, in_b}].push_back(difference);
  }

  const Side& a_;
  const Side& b_;
  ShardFinder finder_;
  std::vector<int> all_levels_, open_levels_;  ///< open_levels_: neither skipped nor equal by their hashes
  std::set<int> skipped_;
  std::map<std::pair<std::size_t, int>, Walked> seen_of_b_;  ///< key: cell of B and lod
  std::map<std::pair<std::string, std::string>, std::vector<LevelDifference>> differences_;
};

void expect_comparable(const std::filesystem::path& path, const SceneHeader& a, const SceneHeader& b) {
  if (a.voxel_size_m != b.voxel_size_m)
    throw InputError(path, "VoxelSize", "cannot be compared: the other scene has another voxel size");
  if (a.lattice_origin_m != b.lattice_origin_m || a.origin != b.origin)
    throw InputError(path, "LatticeOrigin", "cannot be compared: the other scene has another lattice");
  if (a.has_normals != b.has_normals)
    throw InputError(path, "Channels", "cannot be compared: only one of the scenes has normals");
}

std::uint32_t max_cell(const SceneDescription& scene) {
  std::uint32_t maximum = 0;
  for (const SceneCell& c : scene.cells) maximum = std::max(maximum, c.cell_voxels);
  return maximum;
}

/// The parts of two scenes that may differ, according to their pages. If two pages of the same block have equal voxels
/// on every level, their cells need no comparison.
class DifferingPages {
 public:
  DifferingPages(const PagedScene& a, const PagedScene& b) : a_(a), b_(b) {}

  /// Compares the lists of two groups of the same block, or of two whole scenes.
  void compare(const ScenePage& a, const ScenePage& b) {
    std::map<std::pair<Vec3i64, std::int64_t>, const PageReference*> of_b;
    for (const PageReference& page : b.pages) of_b[{page.block.min, page.block.edge}] = &page;
    for (const PageReference& page : a.pages) {
      const auto other = of_b.find({page.block.min, page.block.edge});
      if (other == of_b.end()) {
        take(a_, page, left, left_overviews);
        continue;
      }
      if (page.totals.content_hash != other->second->totals.content_hash)
        compare(read_page(a_.file(), a_.header(), page), read_page(b_.file(), b_.header(), *other->second));
      of_b.erase(other);
    }
    for (const PageReference& page : b.pages)
      if (of_b.contains({page.block.min, page.block.edge})) take(b_, page, right, right_overviews);
    left.insert(left.end(), a.cells.begin(), a.cells.end());
    right.insert(right.end(), b.cells.begin(), b.cells.end());
    left_overviews.insert(left_overviews.end(), a.overviews.begin(), a.overviews.end());
    right_overviews.insert(right_overviews.end(), b.overviews.begin(), b.overviews.end());
  }

  std::vector<SceneCell> left, right, left_overviews, right_overviews;

 private:
  static void take(const PagedScene& scene, const PageReference& page, std::vector<SceneCell>& cells,
                   std::vector<SceneCell>& overviews) {
    scene.for_each_cell_below(page, [&cells](const SceneCell& cell) { cells.push_back(cell); });
    scene.for_each_overview_below(page, [&overviews](const SceneCell& overview) { overviews.push_back(overview); });
  }

  const PagedScene& a_;
  const PagedScene& b_;
};

std::pair<Side, Side> sides_of(const PagedScene& a, const PagedScene& b) {
  DifferingPages pages(a, b);
  pages.compare(a.root(), b.root());
  std::sort(pages.left.begin(), pages.left.end(), is_before);
  std::sort(pages.right.begin(), pages.right.end(), is_before);
  std::sort(pages.left_overviews.begin(), pages.left_overviews.end(), is_overview_before);
  std::sort(pages.right_overviews.begin(), pages.right_overviews.end(), is_overview_before);
  return {{a.file(), {a.header(), std::move(pages.left), std::move(pages.left_overviews)}, a.totals()},
          {b.file(), {b.header(), std::move(pages.right), std::move(pages.right_overviews)}, b.totals()}};
}

void exchange(SceneDifference& d) {
  for (CellDifference& cell : d.cells) {
    std::swap(cell.cell_in_a, cell.cell_in_b);
    for (LevelDifference& level : cell.levels) std::swap(level.only_in_a, level.only_in_b);
  }
}

}  // namespace

void expect_shards(const std::filesystem::path& scene_xml) {
  const PagedScene scene(scene_xml);
  std::uint64_t shards = 0, faulty = 0;
  std::string first;
  const auto look_up = [&](const SceneCell& shard) {
    std::error_code error;
    const bool is_there = std::filesystem::file_size(scene.folder() / shard.file, error) == shard.bytes && !error;
    if (!is_there && faulty++ == 0) first = shard.file;
    ++shards;
  };
  scene.for_each_cell(look_up);
  scene.for_each_overview(look_up);
  if (faulty != 0)
    throw InputError(
        scene.file(), first,
        fmt::format("{} of {} missing or cut short; gigabake verify lists them, bake again to restore them", faulty,
                    pluralize(shards, "shard is", "shards are")));
}

SceneDifference diff_scenes(const std::filesystem::path& a, const std::filesystem::path& b, const Progress& progress) {
  progress.step("reading the scenes");
  const PagedScene scene_a(a), scene_b(b);
  expect_comparable(b, scene_a.header(), scene_b.header());
  const auto [left, right] = sides_of(scene_a, scene_b);
  if (max_cell(left.scene) >= max_cell(right.scene)) return SceneComparison(left, right).run(progress);
  SceneDifference difference = SceneComparison(right, left).run(progress);
  exchange(difference);
  return difference;
}

}  // namespace gigabake
