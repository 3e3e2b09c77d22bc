#include "worker/edit/shard_edit.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "kernels/cpu/mip/level_hash.h"
#include "worker/edit/edited_levels.h"
#include "worker/edit/edited_nodes.h"
#include "worker/edit/level_bricks.h"
#include "worker/edit/stored_bricks.h"

namespace gigabake {
namespace {

using kernels::Level;

/// Cells with fewer voxels of lod 0 are always edited in place.
constexpr std::uint64_t max_small_voxels = 4'000'000;

/// Returns the stored voxels of lod 0 in the cubes, without constant nodes.
std::uint64_t voxels_in(const BaseLevel& finest, const EditedCubes& cubes) {
  std::uint64_t voxels = 0;
  const auto at = [&](std::uint64_t key) {
    return std::size_t(std::lower_bound(finest.key.begin(), finest.key.end(), key) - finest.key.begin());
  };
  for (const EditedCubes::Range& range : cubes.ranges())
    voxels += finest.bricks.first[at(range.end)] - finest.bricks.first[at(range.first)];
  return voxels;
}

/// Assembles the levels of the new shard from the coarsest.
class LevelSplicer {
 public:
  LevelSplicer(const BaseShard& base, const StoredBricks& stored, const EditedLevels& edited, const EditedNodes& nodes)
      : base_(base), stored_(stored), edited_(edited), nodes_(nodes), levels_(base.lods()), keys_(base.lods()) {
    for (std::size_t lod = base.lods(); lod-- > 0;) add(lod);
  }

  std::vector<SplicedLevel> take() { return std::move(levels_); }

 private:
  void add(std::size_t lod) {
    const Level level = new_bricks(lod);
    SplicedLevel& out = levels_[lod];
    keys_[lod] = level.key;
    out.bricks = static_cast<const BrickLevel&>(level);
    for (const std::uint64_t key : level.key) out.parents.push_back(parent_of(lod, key));
    add_runs(lod);
  }

  bool is_edited(std::size_t lod, std::uint64_t key) const {
    const std::vector<std::uint64_t>& keys = edited_.levels[lod].keys;
    return std::binary_search(keys.begin(), keys.end(), key);
  }

  /// Returns the bricks whose rows change: edited bricks, and the children of edited bricks, whose predictions change.
  Level new_bricks(std::size_t lod) const {
    std::vector<std::uint64_t> kept;
    if (lod + 1 < edited_.levels.size())
      for (const std::uint64_t parent : edited_.levels[lod + 1].keys)
        for (std::uint64_t child = 8 * parent; child < 8 * parent + 8; ++child)
          if (!is_edited(lod, child) && is_brick(lod, child)) kept.push_back(child);
    const Level stored = stored_.read(int(lod), kept);
    const Level& edited = edited_.levels[lod].after;
    Level out;
    out.first = {0};
    for (std::size_t s = 0, e = 0; s < stored.key.size() || e < edited.key.size();) {
      const bool is_stored = e == edited.key.size() || (s < stored.key.size() && stored.key[s] < edited.key[e]);
      if (is_stored) append_bricks(stored, s, s + 1, out);
      if (!is_stored && is_brick(lod, edited.key[e])) append_bricks(edited, e, e + 1, out);
      ++(is_stored ? s : e);
    }
    return out;
  }

  bool is_brick(std::size_t lod, std::uint64_t key) const {
    const EditedNode* node = nodes_.find(lod, key);
    return node != nullptr && node->node.kind == NodeKind::brick;
  }

  BrickParent parent_of(std::size_t lod, std::uint64_t key) const {
    if (lod + 1 == levels_.size()) return {};
    const EditedNode& parent = *nodes_.find(lod + 1, key >> 3);
    const auto octant = std::uint8_t(key & 7);
    if (parent.node.kind != NodeKind::brick)
      return {parent.node.value.rgba, parent.node.value.normal, BrickParent::constant, octant};
    return {number_of(lod + 1, key >> 3), 0, BrickParent::brick, octant};
  }

  std::uint32_t number_of(std::size_t lod, std::uint64_t key) const {
    return std::uint32_t(std::lower_bound(keys_[lod].begin(), keys_[lod].end(), key) - keys_[lod].begin());
  }

  void add_runs(std::size_t lod) {
    std::vector<SplicedBricks>& runs = levels_[lod].runs;
    std::size_t next_new = 0;
    for (const EditedNode& node : nodes_.levels[lod]) {
      if (node.node.kind != NodeKind::brick) continue;
      const bool is_new = next_new < keys_[lod].size() && keys_[lod][next_new] == node.key;
      const std::uint64_t number = is_new ? next_new++ : node.stored_brick;
      if (!runs.empty() && runs.back().is_new == is_new && runs.back().first + runs.back().count == number)
        ++runs.back().count;
      else
        runs.push_back({is_new, number, 1});
    }
  }

  const BaseShard& base_;
  const StoredBricks& stored_;
  const EditedLevels& edited_;
  const EditedNodes& nodes_;
  std::vector<SplicedLevel> levels_;
  std::vector<std::vector<std::uint64_t>> keys_;  ///< [lod]; of the new bricks
};

/// Adds the alphas of the bricks that are stored as bricks, times `sign`.
void add_alphas(const Level& level, const std::function<bool(std::uint64_t)>& is_brick, std::int64_t sign,
                AlphaCounts& counts) {
  for (std::size_t b = 0; b < level.key.size(); ++b)
    for (std::uint64_t v = level.first[b]; is_brick(level.key[b]) && v < level.first[b + 1]; ++v)
      counts[level.rgba[4 * v + 3]] += std::uint64_t(sign);
}

std::vector<LevelSummary> summaries_of(const BaseShard& base, const StoredBricks& stored, const EditedLevels& edited,
                                       const EditedNodes& nodes, const NodeTable& table) {
  std::vector<AlphaCounts> counts;
  for (std::size_t lod = 0; lod < base.lods(); ++lod) {
    counts.push_back(base.level(lod).alphas);
    const auto was_brick = [&](std::uint64_t key) { return stored.node(int(lod), key)->kind == NodeKind::brick; };
    const auto is_brick = [&](std::uint64_t key) {
      const EditedNode* node = nodes.find(lod, key);
      return node != nullptr && node->node.kind == NodeKind::brick;
    };
    add_alphas(edited.levels[lod].before, was_brick, -1, counts.back());
    add_alphas(edited.levels[lod].after, is_brick, 1, counts.back());
  }
  return summarize_levels(counts, table);
}

/// Returns the content hash per lod: the stored hash without the changed bricks before, and with them after the edits.
std::vector<Hash128> hashes_of(const BaseShard& base, const EditedLevels& edited,
                               const kernels::CellParameters& parameters, const ThreadPool& pool) {
  std::vector<Hash128> hashes = base.header().content_hash;
  for (std::size_t lod = 0; lod < hashes.size(); ++lod) {
    const auto hash = [&](const Level& level) {
      return kernels::level_hash(level, int(lod), parameters.window_min, pool);
    };
    hashes[lod] -= hash(edited.levels[lod].before);
    hashes[lod] += hash(edited.levels[lod].after);
  }
  return hashes;
}

}  // namespace

std::optional<EditedShard> edited_shard(const BaseShard& base, const CellEdits& edits,
                                        const kernels::CellParameters& parameters, const ThreadPool& pool) {
  const EditedCubes cubes(std::uint32_t(base.lods()), edits.first_bricks());
  const std::uint64_t all = base.level(0).bricks.first.back();
  if (voxels_in(base.level(0), cubes) > std::max(all / 4, max_small_voxels)) return std::nullopt;
  const StoredBricks stored(base);
  EditedLevels edited = edited_levels(base, stored, cubes, edits, parameters, pool);
  const EditedNodes nodes = edited_nodes(base, stored, edited.levels);
  EditedShard out;
  out.shard.header = base.header();
  out.shard.header.content_hash = hashes_of(base, edited, parameters, pool);
  out.shard.nodes = nodes.table(base.header());
  out.shard.levels = LevelSplicer(base, stored, edited, nodes).take();
  out.summaries = summaries_of(base, stored, edited, nodes, out.shard.nodes);
  for (const LevelSummary& level : out.summaries) out.voxels.push_back(level.voxels());
  out.shard.above = std::move(edited.above);
  for (const EditedLevel& level : edited.levels) out.bricks += level.after.key.size();
  return out;
}

}  // namespace gigabake
