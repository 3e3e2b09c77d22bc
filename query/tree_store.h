/// LRU cache of the trees that rays traverse, within a memory budget.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "query/query_tree.h"
#include "query/scene_query.h"
#include "viewer/stream/numbered_shards.h"

namespace gigabake {

/// The key of a tree: one level of one shard.
struct QueryTreeKey {
  std::uint32_t shard = 0;
  std::int32_t lod = 0;
  friend bool operator==(const QueryTreeKey&, const QueryTreeKey&) = default;
};

struct QueryTreeKeyHash {
  std::size_t operator()(const QueryTreeKey& key) const {
    return (std::uint64_t(key.shard) * 32 + std::uint64_t(key.lod)) * 0x9e3779b97f4a7c15u;
  }
};

/// Cache of trees. All functions except find() must be called by one thread.
class TreeStore {
 public:
  struct Found {
    const QueryTree* tree = nullptr;  ///< null: not resident or unreadable
    bool unreadable = false;          ///< the tree can never be loaded
  };

  /// Borrows `numbers` and the pool.
  TreeStore(NumberedShards& numbers, std::uint64_t memory_bytes, const ThreadPool& pool);

  /// Returns the tree and marks it as used. Any number of threads may call find() concurrently.
  Found find(const QueryTreeKey& key) const;

  /// Starts a pass: find() marks trees as used in the new pass.
  void begin_pass() { ++pass_; }

  /// Builds trees that are not resident, in the given order, as far as the memory allows. Evicts trees that were not
  /// used in this pass. For the first tree of the list, evicts used trees too. The first tree is therefore resident or
  /// unreadable afterwards.
  /// Errors  UsageError: the memory does not suffice for one of the trees.
  void build(const std::vector<QueryTreeKey>& by_request_count);

  SceneCell shard(std::uint32_t number) { return numbers_.shard(number); }
  const QueryCounts& counts() const { return counts_; }
  const std::vector<std::string>& problems() const { return problems_; }

 private:
  struct Entry {
    std::unique_ptr<const QueryTree> tree;  ///< null: unreadable
    std::uint64_t bytes = 0;
    mutable std::atomic<std::uint64_t> used{0};
  };
  struct Building {
    QueryTreeKey key;
    SceneCell shard;
    std::unique_ptr<QueryTreeSource> source;
    std::unique_ptr<const QueryTree> tree;
    std::uint64_t bytes = 0;
    std::string problem;
  };
  void open(std::vector<Building>& all) const;
  std::size_t admit(std::vector<Building>& all, bool must);
  void finish(std::vector<Building>& all);
  enum class Evict { unused, any };  ///< unused: only trees not used in this pass
  void make_room(std::uint64_t bytes, Evict evict);
  void tell(const std::string& problem);

  NumberedShards& numbers_;
  std::uint64_t memory_bytes_;
  const ThreadPool& pool_;
  std::unordered_map<QueryTreeKey, Entry, QueryTreeKeyHash> entries_;
  std::uint64_t pass_ = 0, bytes_ = 0;
  QueryCounts counts_;
  std::vector<std::string> problems_;
};

}  // namespace gigabake
