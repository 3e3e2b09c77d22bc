#include "viewer/query/scene_query.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>
#include <utility>

#include "core/base/counted.h"
#include "core/base/error.h"
#include "viewer/query/query_places.h"
#include "viewer/query/query_walk.h"
#include "viewer/query/tree_store.h"

namespace gigabake {
namespace {

constexpr std::size_t rays_per_range = 256;
constexpr std::uint64_t min_page_bytes = std::uint64_t(1) << 20, page_part = 32;

/// The unfinished rays of a range, and the data that they need.
struct Waiting {
  std::vector<std::uint32_t> rays;
  std::unordered_map<QueryTreeKey, std::uint64_t, QueryTreeKeyHash> wants;  ///< number of waiting rays per tree
  std::set<PageKey> pages;                                                  ///< pages of the scene
};

QueryLevels checked_levels(const QueryOptions& options, int lods) {
  if (options.lod < 0 || options.lod >= lods)
    throw UsageError("lod", "expected 0 to " + std::to_string(lods - 1) + ", the levels of this scene");
  if (!(options.spread >= 0 && options.spread <= 1)) throw UsageError("spread", "expected 0 to 1");
  return {options.lod, options.spread};
}

std::vector<QueryTreeKey> by_request_count(const std::vector<Waiting>& waiting) {
  std::unordered_map<QueryTreeKey, std::uint64_t, QueryTreeKeyHash> sums;
  for (const Waiting& w : waiting)
    for (const auto& [key, rays] : w.wants) sums[key] += rays;
  std::vector<std::pair<std::uint64_t, QueryTreeKey>> ranked;
  for (const auto& [key, rays] : sums) ranked.push_back({rays, key});
  std::sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first
                              : std::pair(a.second.shard, a.second.lod) < std::pair(b.second.shard, b.second.lod);
  });
  std::vector<QueryTreeKey> keys;
  for (const auto& [rays, key] : ranked) keys.push_back(key);
  return keys;
}

std::vector<PageKey> missing_pages(const std::vector<Waiting>& waiting) {
  std::set<PageKey> all;
  for (const Waiting& w : waiting) all.insert(w.pages.begin(), w.pages.end());
  return {all.begin(), all.end()};
}

}  // namespace

struct SceneQuery::State {
  State(std::shared_ptr<const PagedScene> of, const QueryOptions& options, const ThreadPool& policy)
      : scene(std::move(of)),
        pool(policy),
        numbers(scene, {}),
        places(numbers, std::max(options.memory_bytes / page_part, min_page_bytes), policy),
        levels(checked_levels(options, places.lods())),
        trees(numbers, options.memory_bytes, policy) {}

  /// Traverses all unfinished rays once. Returns the data for which they wait.
  std::vector<Waiting> pass(std::span<const QueryRay> rays, const std::vector<std::uint32_t>& active,
                            std::vector<QueryTraversal>& walks) const {
    std::vector<Waiting> waiting(std::size_t(pool.threads()));
    pool.parallel_for(active.size(), rays_per_range, [&](std::size_t begin, std::size_t end, int thread) {
      Waiting& w = waiting[std::size_t(thread)];
      for (std::size_t i = begin; i < end; ++i) {
        QueryNeed needed;
        if (advance_walk(rays[active[i]], levels, places, trees, walks[active[i]], needed)) continue;
        w.rays.push_back(active[i]);
        if (needed.is_page)
          w.pages.insert(needed.page);
        else
          ++w.wants[needed.tree];
      }
    });
    return waiting;
  }

  std::shared_ptr<const PagedScene> scene;
  const ThreadPool& pool;
  NumberedShards numbers;
  QueryPlaces places;
  QueryLevels levels;
  TreeStore trees;
  std::unordered_map<std::uint32_t, std::string> names;
};

SceneQuery::SceneQuery(std::shared_ptr<const PagedScene> scene, const QueryOptions& options, const ThreadPool& pool)
    : state_(std::make_unique<State>(std::move(scene), options, pool)) {}

SceneQuery::~SceneQuery() = default;

const PagedScene& SceneQuery::scene() const { return *state_->scene; }
const kernels::VoxelBox& SceneQuery::window() const { return state_->places.window(); }
int SceneQuery::lods() const { return state_->places.lods(); }
QueryCounts SceneQuery::counts() const {
  QueryCounts counts = state_->trees.counts();
  counts.pages_read = state_->places.pages_read();
  return counts;
}
const std::vector<std::string>& SceneQuery::problems() const { return state_->trees.problems(); }

void SceneQuery::first_hits(std::span<const QueryRay> rays, std::span<QueryHit> answers, const Progress& progress) {
  State& s = *state_;
  std::vector<QueryTraversal> walks(rays.size());
  std::vector<std::uint32_t> active(rays.size());
  s.pool.parallel_for(rays.size(), rays_per_range, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) {
      active[i] = std::uint32_t(i);
      walks[i] = start_walk(rays[i], s.levels, s.places);
    }
  });
  while (!active.empty()) {
    s.trees.begin_pass();
    const std::vector<Waiting> waiting = s.pass(rays, active, walks);
    const std::size_t before = active.size();
    active.clear();
    for (const Waiting& w : waiting) active.insert(active.end(), w.rays.begin(), w.rays.end());
    progress.advance(before - active.size());
    s.places.read(missing_pages(waiting));
    const std::vector<QueryTreeKey> trees = by_request_count(waiting);
    if (!trees.empty()) s.trees.build(trees);
  }
  for (std::size_t i = 0; i < walks.size(); ++i) answers[i] = walks[i].nearest;
}

const std::string& SceneQuery::name_of(std::uint32_t shard) {
  State& s = *state_;
  const auto found = s.names.find(shard);
  if (found != s.names.end()) return found->second;
  return s.names[shard] = s.places.is_lost(shard) ? s.places.lost_name(shard) : s.trees.shard(shard).name;
}

bool is_valid(const QueryRay& ray) {
  double squared = 0;
  bool good = ray.begin >= 0 && ray.end >= ray.begin && std::isfinite(ray.begin);
  for (int a = 0; a < 3; ++a) {
    squared += ray.direction[a] * ray.direction[a];
    good = good && std::fabs(ray.origin[a]) <= double(kernels::far_voxel) / 4;
  }
  return good && std::fabs(squared - 1) < 1e-9;
}

}  // namespace gigabake
