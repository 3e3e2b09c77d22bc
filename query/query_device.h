/// The device that casts the rays of a SceneQuery, and the trees on it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "query/first_hit/query_device.h"
#include "query/query_places.h"
#include "query/query_tree.h"

namespace gigabake {

/// A device that casts rays through the trees in its memory. Trees are added until the memory is full; no tree is
/// evicted. Rays that need other trees pause.
class QueryDevice {
 public:
  struct Options {
    int device = 0;
    std::uint64_t device_bytes = 0;
    QueryLevels levels;
  };

  /// Lays out all cells of `places`.
  /// Errors  CudaFailure; the errors of QueryPlaces::lay_out_all().
  QueryDevice(const Options& options, QueryPlaces& places, const ThreadPool& pool);

  /// Casts each ray until it is finished or pauses.
  /// Errors  CudaFailure.
  void cast(std::span<const QueryRay> rays, std::span<QueryTraversal> walks);
  /// Adds the tree of a cell's shard, unless the device has it or is full.
  /// Errors  CudaFailure.
  void add(std::uint32_t shard, const QueryTree& tree);
  bool is_full() const { return is_full_; }

 private:
  std::unordered_map<std::uint32_t, std::uint32_t> absent_;  ///< cell by shard number, for trees not on the device
  bool is_full_ = false;
  std::unique_ptr<kernels::CudaQuery> cuda_;
};

/// Returns the reason why a device cannot cast rays through these levels; empty if it can. `memory_bytes` is the
/// maximum memory of the cells' layout.
std::string device_limit(const QueryPlaces& places, const PagedScene& scene, const QueryLevels& levels,
                         std::uint64_t memory_bytes);

/// Returns the table of all cells of `places`, in which no tree is resident. The table borrows `entries`, which this
/// function fills.
/// Range   Call places.lay_out_all() first.
kernels::QueryCells query_cells(const QueryPlaces& places, std::vector<kernels::QueryCells::Entry>& entries);

}  // namespace gigabake
