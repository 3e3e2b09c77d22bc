#include "query/scene_query.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "query/first_hit/query_walk.h"
#include "query/query_device.h"
#include "query/query_places.h"
#include "query/tree_store.h"

namespace gigabake {
namespace {

constexpr std::size_t rays_per_range = 256;
constexpr std::uint64_t min_page_bytes = std::uint64_t(1) << 20, page_part = 32;

/// The data for which a traversal waits.
struct QueryNeed {
  bool is_page = false;
  PageKey page;  ///< page of the scene, if is_page
  QueryTreeKey tree;
};

/// The scene that advance_walk() traverses on the host. It records the data for which the traversal pauses.
struct HostScene {
  const QueryPlaces& places;
  const TreeStore& trees;
  QueryNeed& needed;

  QueryRegion find(int lod, const std::int64_t v[3]) const {
    const QueryPlace place = places.find(lod, v);
    QueryRegion region{QueryRegion::Kind::nothing, place.shard, nullptr, place.box};
    if (place.kind == QueryPlace::Kind::unknown) {
      needed = {true, place.page, {}};
      region.kind = QueryRegion::Kind::paused;
    } else if (place.kind == QueryPlace::Kind::lost) {
      region.kind = QueryRegion::Kind::missing;
    } else if (place.kind == QueryPlace::Kind::shard) {
      needed = {false, {}, {place.shard, lod}};
      const TreeStore::Found found = trees.find(needed.tree);
      region.kind = found.unreadable        ? QueryRegion::Kind::missing
                    : found.tree == nullptr ? QueryRegion::Kind::paused
                                            : QueryRegion::Kind::shard;
      if (found.tree != nullptr) region.tree = &found.tree->view();
    }
    return region;
  }
};

/// The unfinished rays of a thread, and the data that they need.
struct Waiting {
  std::vector<std::uint32_t> rays;
  std::unordered_map<QueryTreeKey, std::uint64_t, QueryTreeKeyHash> requests;  ///< number of waiting rays per tree
  std::set<PageKey> pages;                                                     ///< pages of the scene
};

QueryLevels checked_levels(const QueryOptions& options, int lods) {
  if (options.lod < 0 || options.lod >= lods)
    throw UsageError("lod", "expected 0 to " + std::to_string(lods - 1) + ", the levels of this scene");
  if (!(options.spread >= 0 && options.spread <= 1)) throw UsageError("spread", "expected 0 to 1");
  return {options.lod, options.spread, lods};
}

std::vector<QueryTreeKey> by_request_count(const std::vector<Waiting>& waiting) {
  std::unordered_map<QueryTreeKey, std::uint64_t, QueryTreeKeyHash> sums;
  for (const Waiting& w : waiting)
    for (const auto& [key, rays] : w.requests) sums[key] += rays;
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
        trees(numbers, options.memory_bytes, policy),
        find_device(options.device),
        min_device_rays(options.min_device_rays),
        device_bytes(options.device_bytes),
        memory_bytes(options.memory_bytes) {}

  /// Traverses all unfinished rays until each ray finishes or waits. Returns the waiting rays per thread.
  std::vector<Waiting> pass(std::span<const QueryRay> rays) {
    std::vector<Waiting> waiting(std::size_t(pool.threads()));
    pool.parallel_for(active.size(), rays_per_range, [&](std::size_t begin, std::size_t end, int thread) {
      Waiting& w = waiting[std::size_t(thread)];
      std::uint32_t slots[kernels::first_hit_stack];
      for (std::size_t i = begin; i < end; ++i) {
        QueryNeed needed;
        const HostScene host{places, trees, needed};
        if (kernels::advance_walk(rays[active[i]], levels, host, kernels::FirstHitSlots<1>{slots}, walks[active[i]]))
          continue;
        w.rays.push_back(active[i]);
        if (needed.is_page)
          w.pages.insert(needed.page);
        else
          ++w.requests[needed.tree];
      }
    });
    return waiting;
  }

  void start_on_host(std::span<const QueryRay> rays) {
    active.resize(rays.size());
    pool.parallel_for(rays.size(), rays_per_range, [&](std::size_t begin, std::size_t end, int) {
      for (std::size_t i = begin; i < end; ++i) {
        active[i] = std::uint32_t(i);
        walks[i] = kernels::start_march(rays[i], levels, places.window());
      }
    });
  }

  /// Finds and prepares the device at the first long batch. Returns false if the CPU casts the batch.
  bool has_device(std::size_t rays) {
    if (!find_device || rays < min_device_rays) return device != nullptr && rays >= min_device_rays;
    const std::optional<int> ordinal = std::exchange(find_device, nullptr)();
    if (!ordinal) return false;
    device_problem = device_limit(places, *scene, levels, memory_bytes);
    if (device_problem.empty())
      on_device([&] {
        device = std::make_unique<QueryDevice>(QueryDevice::Options{*ordinal, device_bytes, levels}, places, pool);
      });
    return device != nullptr;
  }

  /// Calls step(). If the device fails, removes the device and returns false.
  template <class Step>
  bool on_device(const Step& step) {
    try {
      step();
      return true;
    } catch (const CudaFailure& failure) {
      device_problem = failure.what();
      device.reset();
      return false;
    }
  }

  /// Casts the rays as far as the device's trees reach. Returns false if the device fails.
  bool start_on_device(std::span<const QueryRay> rays) {
    if (!on_device([&] { device->cast(rays, walks); })) return false;
    active.clear();
    for (std::size_t i = 0; i < walks.size(); ++i)
      if (!walks[i].finished) active.push_back(std::uint32_t(i));
    device_rays += walks.size() - active.size();
    return true;
  }

  /// Returns the trees at which rays paused on the device; empty if the device cannot hold more trees.
  std::unordered_set<QueryTreeKey, QueryTreeKeyHash> trees_for_device() const {
    std::unordered_set<QueryTreeKey, QueryTreeKeyHash> keys;
    if (!device || device->is_full()) return keys;
    for (const std::uint32_t i : active) {
      const QueryPlace place = places.find(walks[i].lod, walks[i].v);
      if (place.kind == QueryPlace::Kind::shard) keys.insert({place.shard, walks[i].lod});
    }
    return keys;
  }

  void give_to_device(const std::unordered_set<QueryTreeKey, QueryTreeKeyHash>& keys) {
    for (const QueryTreeKey& key : keys)
      if (const QueryTree* const tree = trees.find(key).tree; tree != nullptr && device)
        on_device([&] { device->add(key.shard, *tree); });
    if (device && device->is_full()) device_problem = "the device's memory holds only some of the cells";
  }

  std::shared_ptr<const PagedScene> scene;
  const ThreadPool& pool;
  NumberedShards numbers;
  QueryPlaces places;
  QueryLevels levels;
  TreeStore trees;
  std::unordered_map<std::uint32_t, std::string> names;
  std::vector<QueryTraversal> walks;  ///< of the batch
  std::vector<std::uint32_t> active;  ///< unfinished rays of the batch

  std::function<std::optional<int>()> find_device;  ///< null after its call
  std::size_t min_device_rays;
  std::uint64_t device_bytes, memory_bytes, device_rays = 0;
  std::unique_ptr<QueryDevice> device;
  std::string device_problem;
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
  counts.device_rays = state_->device_rays;
  return counts;
}
const std::vector<std::string>& SceneQuery::problems() const { return state_->trees.problems(); }
const std::string& SceneQuery::device_problem() const { return state_->device_problem; }

void SceneQuery::first_hits(std::span<const QueryRay> rays, std::span<QueryHit> answers, const Progress& progress) {
  State& s = *state_;
  s.walks.resize(rays.size());
  if (!s.has_device(rays.size()) || !s.start_on_device(rays)) s.start_on_host(rays);
  progress.advance(rays.size() - s.active.size());
  const auto for_device = s.trees_for_device();
  while (!s.active.empty()) {
    s.trees.begin_pass();
    const std::vector<Waiting> waiting = s.pass(rays);
    const std::size_t before = s.active.size();
    s.active.clear();
    for (const Waiting& w : waiting) s.active.insert(s.active.end(), w.rays.begin(), w.rays.end());
    progress.advance(before - s.active.size());
    s.places.read(missing_pages(waiting));
    const std::vector<QueryTreeKey> trees = by_request_count(waiting);
    if (!trees.empty()) s.trees.build(trees);
  }
  s.give_to_device(for_device);
  s.pool.parallel_for(rays.size(), rays_per_range * 16, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) answers[i] = s.walks[i].nearest;
  });
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
